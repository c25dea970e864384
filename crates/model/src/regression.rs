//! Least squares of a reading on several causes and an offset.

use nalgebra::{DMatrix, DVector};
use quell_signal::SingularValues;

/// Ratio of singular values below which causes vary together.
const TOGETHER: f64 = 1e-9;

/// The causes of readings.
pub(super) struct Regression {
    /// Without their means, of equal length, so that the units do not matter.
    causes: DMatrix<f64>,
    factors: SingularValues,
    /// Length of the first cause without its mean.
    length: f64,
}

/// The slope of a reading over the first cause.
pub(super) struct Slope {
    /// Reading for a unit of the cause.
    pub value: f64,
    /// Its variance by what the causes leave of the reading.
    pub variance: f64,
}

impl Regression {
    /// On causes of equal length in time; `None` without any, or where one is not finite: a prediction that diverged.
    pub fn on(causes: &[&[f64]]) -> Option<Self> {
        let columns: Vec<DVector<f64>> = causes.iter().map(|own| centred(own)).collect();
        let length = columns.first()?.norm();
        if columns.iter().any(|own| !own.norm().is_finite()) {
            return None;
        }
        let scaled = columns
            .iter()
            .map(|own| own / own.norm().max(f64::MIN_POSITIVE));
        let causes = DMatrix::from_columns(&scaled.collect::<Vec<_>>());
        Some(Self {
            factors: SingularValues::of(&causes)?,
            causes,
            length,
        })
    }

    /// The slope of a reading; `None` where the first cause does not vary.
    pub fn slope(&self, reading: &[f64]) -> Option<Slope> {
        let reading = centred(reading);
        let solved = self.factors.solve(&reading, TOGETHER);
        let value = solved[0] / self.length;
        let left = (&reading - &self.causes * &solved).norm_squared() / reading.len() as f64;
        let unit = self.factors.inverted(TOGETHER).row(0).norm_squared();
        value.is_finite().then_some(Slope {
            value,
            variance: left * unit / self.length.powi(2),
        })
    }
}

fn centred(values: &[f64]) -> DVector<f64> {
    let values = DVector::from_column_slice(values);
    values.add_scalar(-values.mean())
}
