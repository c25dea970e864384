//! Velocities of a sampled command, for a cubic from sample to sample that never overshoots.

/// The velocity (rad/s) at each sample: between two increments of the same direction their weighted
/// harmonic mean, 0 at an extremum and at both ends.
///
/// With `d`, `e` the slopes before and after, over intervals `g`, `h`:
/// `v = 3 (g + h) / ((2 h + g) / d + (h + 2 g) / e)`. A step stays a step, a smooth command is
/// followed to second order. Needs increasing times and as many positions.
///
/// Source: Fritsch and Butland, "A method for constructing local monotone piecewise cubic
/// interpolants", SIAM J. Sci. Stat. Comput. 5 (1984).
pub fn slopes(time: &[f64], position: &[f64]) -> Vec<f64> {
    let mut slopes = vec![0.0; time.len()];
    for k in 1..time.len().saturating_sub(1) {
        let (g, h) = (time[k] - time[k - 1], time[k + 1] - time[k]);
        let d = (position[k] - position[k - 1]) / g;
        let e = (position[k + 1] - position[k]) / h;
        if d * e > 0.0 {
            slopes[k] = 3.0 * (g + h) / ((2.0 * h + g) / d + (h + 2.0 * g) / e);
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::slopes;

    #[test]
    fn lines_are_kept_and_extrema_are_flat() {
        assert_eq!(slopes(&[0.0, 1.0, 3.0], &[0.0, 2.0, 6.0]), [0.0, 2.0, 0.0]);
        assert_eq!(slopes(&[0.0, 1.0, 2.0], &[0.0, 2.0, 1.0]), [0.0; 3]);
    }
}
