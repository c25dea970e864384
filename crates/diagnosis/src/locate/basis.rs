//! Orthogonal directions that are taken out of series.

/// Directions, orthogonal to one another.
#[derive(Clone, Default)]
pub(super) struct Basis {
    directions: Vec<Vec<f64>>,
}

impl Basis {
    /// Adds a direction, less what is already there; not if rounding is all that is left of it.
    pub fn add(&mut self, column: &[f64]) -> bool {
        let mut rest = column.to_vec();
        // Twice: what rounding leaves at the first go.
        self.remove(&mut rest);
        self.remove(&mut rest);
        let size = dot(&rest, &rest).sqrt();
        let new = size > 1e-6 * dot(column, column).sqrt() && size.is_finite();
        if new {
            rest.iter_mut().for_each(|x| *x /= size);
            self.directions.push(rest);
        }
        new
    }

    /// Takes from a series all that lies along the directions.
    pub fn remove(&self, series: &mut [f64]) {
        for direction in &self.directions {
            let factor = dot(series, direction);
            series
                .iter_mut()
                .zip(direction)
                .for_each(|(s, d)| *s -= factor * d);
        }
    }

    /// A series without all that lies along the directions.
    pub fn without(&self, series: &[f64]) -> Vec<f64> {
        let mut rest = series.to_vec();
        self.remove(&mut rest);
        rest
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
