//! Scatter between estimates of separate stretches.

/// Standard deviations beyond which there is more than chance: 0.1 % on one side.
const BEYOND: f64 = 3.0;

/// The standard deviation between values `x_i`, beside their own `s_i`: the `t >= 0` for which
/// `sum (x_i - m)^2 / (s_i^2 + t^2) = n - 1` about their weighted mean `m` (Paule and Mandel, J. Research of the National
/// Bureau of Standards 87 (1982) 377). 0 where they agree as they are: the sum for `t = 0` is chi squared with `n - 1`
/// degrees of freedom, which is above their number in every third case by chance alone.
pub fn between(values: &[(f64, f64)]) -> f64 {
    let values: Vec<_> = values
        .iter()
        .filter(|(x, s)| x.is_finite() && s.is_finite() && *s > 0.0)
        .collect();
    if values.len() < 2 {
        return 0.0;
    }
    let excess = |between: f64| {
        let weight = |s: f64| 1.0 / (s * s + between * between);
        let sum: f64 = values.iter().map(|(_, s)| weight(*s)).sum();
        let mean = values.iter().map(|(x, s)| weight(*s) * x).sum::<f64>() / sum;
        let chi: f64 = values
            .iter()
            .map(|(x, s)| weight(*s) * (x - mean).powi(2))
            .sum();
        chi - (values.len() - 1) as f64
    };
    let freedom = (values.len() - 1) as f64;
    if excess(0.0) + freedom <= by_chance(freedom) {
        return 0.0;
    }
    // It falls as `t` grows, and at the range of the values it is below 0: their variance is smaller than its square.
    let ends = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (x, _)| {
            [low.min(*x), high.max(*x)]
        });
    let (mut low, mut high) = (0.0, ends[1] - ends[0]);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match excess(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// What chi squared exceeds once in a thousand cases: three standard deviations of the cube root (Wilson and Hilferty,
/// PNAS 17 (1931) 684).
fn by_chance(freedom: f64) -> f64 {
    let width = 2.0 / (9.0 * freedom);
    freedom * (1.0 - width + BEYOND * width.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::{between, by_chance};

    #[test]
    fn values_that_agree_have_nothing_between_them() {
        assert_eq!(between(&[(1.0, 0.1), (1.05, 0.1), (0.98, 0.2)]), 0.0);
        assert_eq!(between(&[(1.0, 0.1)]), 0.0);
    }

    /// Of two values with the same `s` the equation has a closed form: `t^2 = (x_1 - x_2)^2 / 2 - s^2`.
    #[test]
    fn val_two_values_that_contradict_each_other() {
        let scatter = between(&[(1.0, 0.1), (2.0, 0.1)]);
        assert!(
            (scatter - (0.5_f64 - 0.01).sqrt()).abs() < 1e-9,
            "{scatter}"
        );
    }

    /// The quantiles by integration of the density; the cube is 2.5 % off for one degree of freedom, and less for more.
    #[test]
    fn val_chi_squared_by_chance() {
        for (freedom, quantile) in [(1.0, 10.273), (2.0, 13.215), (5.0, 19.821), (20.0, 44.352)] {
            assert!(
                (by_chance(freedom) / quantile - 1.0_f64).abs() < 0.03,
                "{freedom}"
            );
        }
    }
}
