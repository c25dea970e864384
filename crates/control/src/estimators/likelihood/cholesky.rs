//! A small Cholesky factor that grows row by row.

/// Relative pivot that rounding of the sums may leave for linearly dependent columns.
const RIDGE: f64 = 1e-13;

/// `A + 1e-13 diag(A) = L D L^T` with 1 on the diagonal of `L`. It needs no square roots and, but for rounding,
/// does not depend on the scale of the unknowns.
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

// Sizes are constants for the compiler, since loops this short would cost more than their content.
impl<const N: usize> Cholesky<N> {
    /// Adds row `n` of the matrix, of which only the numbers up to the diagonal are used; `None` where the
    /// matrix is not positive definite.
    #[inline(always)]
    pub fn append(&mut self, n: usize, row: &[f64; N]) -> Option<()> {
        if !(row[n].is_finite() && row[n] > 0.0) {
            return None;
        }
        let scaled = self.forward_to(n, row);
        let mut left = row[n] * (1.0 + RIDGE);
        let line = self.lower[n].iter_mut().zip(&self.pivot);
        for ((entry, pivot), part) in line.zip(scaled).take(n) {
            *entry = part * pivot;
            left -= part * *entry;
        }
        if left.is_nan() || left <= 0.0 {
            return None;
        }
        self.pivot[n] = left.recip();
        self.diagonal[n] = row[n];
        Some(())
    }

    /// The first `SIZE` of `L^-1 rhs`, the rest 0.
    #[inline(always)]
    pub fn forward<const SIZE: usize>(&self, rhs: &[f64; N]) -> [f64; N] {
        self.forward_to(SIZE, rhs)
    }

    #[inline(always)]
    fn forward_to(&self, size: usize, rhs: &[f64; N]) -> [f64; N] {
        let mut result = [0.0; N];
        for n in 0..size {
            result[n] = self.next_forward(&result, n, rhs[n]);
        }
        result
    }

    /// Component `n` of `L^-1 rhs`, from those before it.
    #[inline(always)]
    pub fn next_forward(&self, known: &[f64; N], n: usize, rhs: f64) -> f64 {
        without(rhs, &self.lower[n][..n], known)
    }

    /// The first `SIZE` of `L^-T D^-1 forward`: the solution, where `forward` is that of its right-hand side.
    #[inline(always)]
    pub fn backward<const SIZE: usize>(&self, forward: &[f64; N]) -> [f64; N] {
        let mut result = [0.0; N];
        for n in (0..SIZE).rev() {
            let mut part = forward[n] * self.pivot[n];
            for (line, known) in self.lower[n + 1..SIZE].iter().zip(&result[n + 1..]) {
                part -= line[n] * known;
            }
            result[n] = part;
        }
        result
    }

    /// `y^2 / d` of component `n` of a forward solution: the part of the sum of squares that it explains.
    #[inline(always)]
    pub fn explained(&self, forward: &[f64; N], n: usize) -> f64 {
        forward[n] * forward[n] * self.pivot[n]
    }

    /// Element `(n, n)` of the inverse of `A`; later elements cost less.
    #[inline(always)]
    pub fn inverse(&self, n: usize) -> f64 {
        let column = self.column(n);
        (n..N).map(|m| self.explained(&column, m)).sum()
    }

    /// Element `(i, j)` of the inverse of `A`.
    pub fn inverse_of(&self, i: usize, j: usize) -> f64 {
        let (left, right) = (self.column(i), self.column(j));
        let products = (i.max(j)..N).map(|n| left[n] * right[n] * self.pivot[n]);
        products.sum()
    }

    /// Column `i` of `L^-1`.
    #[inline(always)]
    fn column(&self, i: usize) -> [f64; N] {
        let mut column = [0.0; N];
        column[i] = 1.0;
        for n in i + 1..N {
            column[n] = without(0.0, &self.lower[n][i..n], &column[i..]);
        }
        column
    }

    /// Element `(n, n)` of `A`.
    #[inline(always)]
    pub fn diagonal(&self, n: usize) -> f64 {
        self.diagonal[n]
    }
}

/// `whole - sum a_k b_k`, over the shorter of the two.
#[inline(always)]
fn without(whole: f64, a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(whole, |rest, (a, b)| rest - a * b)
}
