//! Small dense linear systems without allocation.

/// Solves `matrix x = right` in place for the leading `size` rows and columns.
///
/// Gaussian elimination with partial pivoting, `size^3 / 3` multiplications. `None` where a pivot
/// vanishes or is not finite.
pub(crate) fn solve<const N: usize>(
    size: usize,
    matrix: &mut [[f64; N]; N],
    right: &mut [f64; N],
) -> Option<[f64; N]> {
    for column in 0..size {
        let pivot = (column..size)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        if !(matrix[pivot][column].abs() > 0.0 && matrix[pivot][column].is_finite()) {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let leading = matrix[column];
        for row in column + 1..size {
            let factor = matrix[row][column] / leading[column];
            for (entry, above) in matrix[row].iter_mut().zip(&leading).take(size).skip(column) {
                *entry -= factor * above;
            }
            right[row] -= factor * right[column];
        }
    }
    let mut solution = [0.0; N];
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|k| matrix[row][k] * solution[k]).sum();
        solution[row] = (right[row] - known) / matrix[row][row];
    }
    Some(solution)
}
