//! Orthogonal directions for projections of series.

/// An orthonormal set of directions.
#[derive(Clone, Default)]
pub(super) struct Basis {
    directions: Vec<Vec<f64>>,
}

impl Basis {
    /// Adds a direction, less its part along the present ones; not if only rounding is left of it.
    pub fn add(&mut self, column: &[f64]) -> bool {
        let mut rest = column.to_vec();
        // Twice, against the rounding of the first pass.
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

    /// Removes the part along the directions from a series.
    pub fn remove(&self, series: &mut [f64]) {
        for direction in &self.directions {
            let factor = dot(series, direction);
            series
                .iter_mut()
                .zip(direction)
                .for_each(|(s, d)| *s -= factor * d);
        }
    }

    /// A series without its part along the directions.
    pub fn without(&self, series: &[f64]) -> Vec<f64> {
        let mut rest = series.to_vec();
        self.remove(&mut rest);
        rest
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
