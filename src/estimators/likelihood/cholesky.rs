//! A small Cholesky factor that grows row by row.

/// What rounding of the sums may leave on an exactly dependent pair of columns.
const RIDGE: f64 = 1e-13;

/// `S A S + 1e-13 I = L L^T` with `S` such that the diagonal of `S A S` is 1.
///
/// Source: G. Golub, C. Van Loan, Matrix Computations, 4th ed., ch. 4.2.
#[derive(Clone, Copy, Debug)]
pub struct Cholesky<const N: usize> {
    factor: [[f64; N]; N],
    /// Inverse of the factor's diagonal.
    pivot: [f64; N],
    scale: [f64; N],
}

impl<const N: usize> Default for Cholesky<N> {
    fn default() -> Self {
        Self {
            factor: [[0.0; N]; N],
            pivot: [0.0; N],
            scale: [0.0; N],
        }
    }
}

impl<const N: usize> Cholesky<N> {
    /// Adds row `n` of the matrix, of which the first `n + 1` numbers count; `None` where the matrix is not
    /// positive definite.
    pub fn append(&mut self, n: usize, row: &[f64; N]) -> Option<()> {
        if !(row[n].is_finite() && row[n] > 0.0) {
            return None;
        }
        self.scale[n] = row[n].sqrt().recip();
        let mut square = 1.0 + RIDGE;
        for (j, &value) in row.iter().enumerate().take(n) {
            let mut sum = value * self.scale[n] * self.scale[j];
            for k in 0..j {
                sum -= self.factor[n][k] * self.factor[j][k];
            }
            let entry = sum * self.pivot[j];
            self.factor[n][j] = entry;
            square -= entry * entry;
        }
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        self.factor[n][n] = square.sqrt();
        self.pivot[n] = self.factor[n][n].recip();
        Some(())
    }

    /// The first `size` of `L^-1 S rhs`, the rest 0.
    pub fn forward(&self, rhs: &[f64; N], size: usize) -> [f64; N] {
        let mut result = [0.0; N];
        for (n, &value) in rhs.iter().enumerate().take(size) {
            result[n] = self.next_forward(&result, n, value);
        }
        result
    }

    /// Number `n` of `L^-1 S rhs`, those before it known.
    pub fn next_forward(&self, known: &[f64; N], n: usize, rhs: f64) -> f64 {
        let mut sum = rhs * self.scale[n];
        for (entry, value) in self.factor[n].iter().zip(known).take(n) {
            sum -= entry * value;
        }
        sum * self.pivot[n]
    }

    /// The first `size` of `S L^-T forward`: the solution, where `forward` is that of its right-hand side.
    pub fn backward(&self, forward: &[f64; N], size: usize) -> [f64; N] {
        let mut result = [0.0; N];
        for n in (0..size).rev() {
            let mut sum = forward[n];
            for (row, value) in self.factor.iter().zip(result).take(size).skip(n + 1) {
                sum -= row[n] * value;
            }
            result[n] = sum * self.pivot[n];
        }
        for (value, scale) in result.iter_mut().zip(&self.scale) {
            *value *= scale;
        }
        result
    }

    /// Element `(i, j)` of the inverse of `A`; the later they stand, the less work.
    pub fn inverse(&self, i: usize, j: usize) -> f64 {
        let (left, right) = (self.column(i), self.column(j));
        (i.max(j)..N).map(|n| left[n] * right[n]).sum()
    }

    /// Column `i` of `L^-1 S`.
    fn column(&self, i: usize) -> [f64; N] {
        let mut result = [0.0; N];
        result[i] = self.scale[i] * self.pivot[i];
        for n in i + 1..N {
            let mut sum = 0.0;
            for (entry, value) in self.factor[n].iter().zip(result).take(n).skip(i) {
                sum -= entry * value;
            }
            result[n] = sum * self.pivot[n];
        }
        result
    }

    /// Element `(n, n)` of `A`.
    pub fn diagonal(&self, n: usize) -> f64 {
        (self.scale[n] * self.scale[n]).recip()
    }
}
