//! Polynomials by their coefficients, the lowest power first.

use std::ops::{AddAssign, Mul};

/// Product of two polynomials of at least one coefficient each, real or complex: `c_k = sum_i a_i b_(k-i)`.
///
/// # Example
/// ```
/// use quell_signal::polynomial::product;
/// // (1 + 2 x) (3 - x) = 3 + 5 x - 2 x^2
/// assert_eq!(product(&[1.0, 2.0], &[3.0, -1.0]), [3.0, 5.0, -2.0]);
/// ```
pub fn product<T>(a: &[T], b: &[T]) -> Vec<T>
where
    T: Copy + Default + AddAssign + Mul<Output = T>,
{
    let mut product = vec![T::default(); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += *x * *y;
        }
    }
    product
}
