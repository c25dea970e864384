//! Check of the jerks: their end, and the limits.

use nalgebra::{Matrix3, Vector3};
use quell_trajectories::{AxisState, Limits};

/// Rounding of the sums over the steps.
const ROUNDING: f64 = 1e-9;

/// Changes jerks in steps of `h` s as little as possible so that they end exactly at rest after `distance`. The
/// change compensates for the solver's limited precision.
pub fn exact_end(jerks: &mut [f64], h: f64, distance: f64) -> Option<()> {
    let steps = jerks.len();
    // Acceleration, velocity and position at the end by a jerk of 1 in a step, in units of h, h^2, h^3.
    let answer = |k: usize| {
        let after = (steps - 1 - k) as f64;
        Vector3::new(1.0, after + 0.5, 0.5 * after * (after + 1.0) + 1.0 / 6.0)
    };
    let mut gram = Matrix3::zeros();
    (0..steps).for_each(|k| gram += answer(k) * answer(k).transpose());
    let inverse = gram.lu();
    // Twice: the second pass removes the rounding of the first.
    for _ in 0..2 {
        let mut lacks = Vector3::new(0.0, 0.0, distance / h.powi(3));
        for (k, jerk) in jerks.iter().enumerate() {
            lacks -= answer(k) * *jerk;
        }
        let weights = inverse.solve(&lacks)?;
        for (k, jerk) in jerks.iter_mut().enumerate() {
            *jerk += answer(k).dot(&weights);
        }
    }
    Some(())
}

/// Whether a motion from rest keeps the limits, also between the steps.
pub fn keeps_limits(jerks: &[f64], h: f64, limits: Limits) -> bool {
    let within = |value: f64, limit: f64| value.abs() <= limit * (1.0 + ROUNDING);
    let mut state = AxisState::default();
    jerks.iter().all(|&jerk| {
        let before = state;
        state = before.after(h, jerk);
        // The velocity is highest where the acceleration changes its sign.
        let turn = -before.acceleration / jerk;
        let peak = (0.0 < turn && turn < h).then(|| before.after(turn, jerk).velocity);
        within(jerk, limits.jerk)
            && within(state.acceleration, limits.acceleration)
            && within(state.velocity, limits.velocity)
            && peak.is_none_or(|peak| within(peak, limits.velocity))
    })
}
