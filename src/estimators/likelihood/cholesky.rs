//! A small Cholesky factor that grows row by row.

/// What rounding of the sums may leave on an exactly dependent pair of columns.
const RIDGE: f64 = 1e-13;

/// `A + 1e-13 diag(A) = L D L^T`, the diagonal of `L` 1: no square roots, and no scale of the unknowns, of
/// which it depends by rounding only.
///
/// Source: G. Golub, C. Van Loan, Matrix Computations, 4th ed., ch. 4.1.
#[derive(Clone, Copy, Debug)]
pub struct Cholesky<const N: usize> {
    /// `L` below the diagonal.
    lower: [[f64; N]; N],
    /// `D^-1`.
    pivot: [f64; N],
    /// Diagonal of `A`.
    diagonal: [f64; N],
}

impl<const N: usize> Default for Cholesky<N> {
    fn default() -> Self {
        Self {
            lower: [[0.0; N]; N],
            pivot: [0.0; N],
            diagonal: [0.0; N],
        }
    }
}

impl<const N: usize> Cholesky<N> {
    /// Adds row `n` of the matrix, of which the first `n + 1` numbers count; `None` where the matrix is not
    /// positive definite.
    #[inline]
    pub fn append(&mut self, n: usize, row: &[f64; N]) -> Option<()> {
        if !(row[n].is_finite() && row[n] > 0.0) {
            return None;
        }
        // The row of L D.
        let mut scaled = [0.0; N];
        let mut left = row[n] * (1.0 + RIDGE);
        for j in 0..n {
            let part = without(row[j], &self.lower[j][..j], &scaled);
            scaled[j] = part;
            self.lower[n][j] = part * self.pivot[j];
            left -= part * self.lower[n][j];
        }
        if left.is_nan() || left <= 0.0 {
            return None;
        }
        self.pivot[n] = left.recip();
        self.diagonal[n] = row[n];
        Some(())
    }

    /// The first `size` of `L^-1 rhs`, the rest 0.
    #[inline]
    pub fn forward(&self, rhs: &[f64; N], size: usize) -> [f64; N] {
        let mut result = [0.0; N];
        for (n, &value) in rhs[..size].iter().enumerate() {
            result[n] = self.next_forward(&result, n, value);
        }
        result
    }

    /// Number `n` of `L^-1 rhs`, those before it known.
    #[inline]
    pub fn next_forward(&self, known: &[f64; N], n: usize, rhs: f64) -> f64 {
        without(rhs, &self.lower[n][..n], known)
    }

    /// The first `size` of `L^-T D^-1 forward`: the solution, where `forward` is that of its right-hand side.
    #[inline]
    pub fn backward(&self, forward: &[f64; N], size: usize) -> [f64; N] {
        let mut result = [0.0; N];
        for n in (0..size).rev() {
            let mut part = forward[n] * self.pivot[n];
            for (line, known) in self.lower[..size].iter().zip(&result).skip(n + 1) {
                part -= line[n] * known;
            }
            result[n] = part;
        }
        result
    }

    /// `y^2 / d` of number `n` of a forward solution: what it explains of the sum of squares.
    #[inline]
    pub fn explained(&self, forward: &[f64; N], n: usize) -> f64 {
        forward[n] * forward[n] * self.pivot[n]
    }

    /// Element `(i, j)` of the inverse of `A`; the later they stand, the less work.
    #[inline]
    pub fn inverse(&self, i: usize, j: usize) -> f64 {
        let (left, right) = (self.column(i), self.column(j));
        let parts = left.iter().zip(&right).zip(&self.pivot).skip(i.max(j));
        parts
            .map(|((left, right), pivot)| left * right * pivot)
            .sum()
    }

    /// Column `i` of `L^-1`.
    #[inline]
    fn column(&self, i: usize) -> [f64; N] {
        let mut result = [0.0; N];
        result[i] = 1.0;
        for n in i + 1..N {
            result[n] = without(0.0, &self.lower[n][i..n], &result[i..]);
        }
        result
    }

    /// Element `(n, n)` of `A`.
    #[inline]
    pub fn diagonal(&self, n: usize) -> f64 {
        self.diagonal[n]
    }
}

/// `whole - sum a_k b_k`, over the shorter of the two.
#[inline(always)]
fn without(whole: f64, a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(whole, |rest, (a, b)| rest - a * b)
}
