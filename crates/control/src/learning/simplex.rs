//! Least squares with positive weights that add up to 1.

use nalgebra::{DMatrix, DVector};

/// Most exchanges for each unknown.
const ROUNDS: usize = 4;
/// Share of the largest diagonal entry that is added to each, so that amplitudes within 1e-4 count as equal.
const RIDGE: f64 = 1e-8;

/// The `x >= 0`, `sum x = 1` that minimises `x' H x`, for `H` symmetric and positive semidefinite.
///
/// `x' H x + m (sum x - 1)^2` over `x >= 0` has its minimum at a multiple of it for any `m`, because the first
/// term is quadratic in the multiple. So it is the problem of Lawson and Hanson, whose active-set method is
/// used here.
///
/// Source: C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, ch. 23.
pub fn least_on_simplex(gram: &DMatrix<f64>) -> DVector<f64> {
    let n = gram.ncols();
    let weight = (0..n)
        .map(|k| gram[(k, k)])
        .fold(f64::MIN_POSITIVE, f64::max);
    let full = gram.map(|x| x + weight) + DMatrix::from_diagonal_element(n, n, RIDGE * weight);
    let mut x = DVector::zeros(n);
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..ROUNDS * n {
        let gradient = DVector::from_element(n, weight) - &full * &x;
        let next = (0..n)
            .filter(|k| !passive.contains(k))
            .max_by(|&a, &b| gradient[a].total_cmp(&gradient[b]));
        match next {
            Some(k) if gradient[k] > 1e-10 * weight => passive.push(k),
            _ => break,
        }
        while let Some(inner) = solve_on(&full, &passive, weight) {
            if inner.iter().all(|value| *value > 0.0) {
                x.fill(0.0);
                passive
                    .iter()
                    .zip(inner.iter())
                    .for_each(|(&k, v)| x[k] = *v);
                break;
            }
            // The step ends where a variable reaches 0; such variables leave the passive set.
            let reach = passive.iter().zip(inner.iter()).filter(|(_, v)| **v <= 0.0);
            let reach = reach
                .map(|(&k, v)| x[k] / (x[k] - v).max(f64::MIN_POSITIVE))
                .fold(1.0, f64::min);
            for (&k, v) in passive.iter().zip(inner.iter()) {
                x[k] += reach * (v - x[k]);
            }
            passive.retain(|&k| x[k] > 1e-12);
            (0..n)
                .filter(|k| !passive.contains(k))
                .for_each(|k| x[k] = 0.0);
        }
    }
    let sum = x.sum();
    if sum > 0.0 {
        x / sum
    } else {
        DVector::from_element(n, 1.0 / n as f64)
    }
}

fn solve_on(full: &DMatrix<f64>, passive: &[usize], weight: f64) -> Option<DVector<f64>> {
    let n = passive.len();
    if n == 0 {
        return None;
    }
    let part = DMatrix::from_fn(n, n, |i, j| full[(passive[i], passive[j])]);
    Some(part.cholesky()?.solve(&DVector::from_element(n, weight)))
}

#[cfg(test)]
mod tests {
    use super::least_on_simplex;
    use nalgebra::{DMatrix, DVector};

    /// Of `sum d_k x_k^2` the minimum is at `x_k = (1 / d_k) / sum 1 / d`; a column that only harms is left out.
    #[test]
    fn val_weights_of_independent_columns() {
        let x = least_on_simplex(&DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 3.0])));
        assert!(
            (x[0] - 0.75).abs() < 1e-7 && (x[1] - 0.25).abs() < 1e-7,
            "{x}"
        );
        let columns = DMatrix::from_row_slice(2, 3, &[1.0, -1.0, 5.0, 0.0, 0.0, 5.0]);
        let x = least_on_simplex(&columns.tr_mul(&columns));
        assert!((x[0] - 0.5).abs() < 1e-6 && x[2] < 1e-6, "{x}");
    }
}
