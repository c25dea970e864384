//! Check of the jerks: their end, and the limits.

use nalgebra::{Matrix3, Vector3};
use quell_trajectories::{AxisProfile, Limits};

use super::steps::Step;

/// Rounding of the sums over the steps.
const ROUNDING: f64 = 1e-9;

/// Changes the jerks of steps as little as possible so that they end exactly at rest after `distance`. The
/// change compensates for the solver's limited precision.
pub fn exact_end(jerks: &mut [f64], steps: &[Step], distance: f64) -> Option<()> {
    let duration: f64 = steps.iter().map(|step| step.duration).sum();
    // Acceleration, velocity and position at the end by a jerk of 1 in each step, in units of the duration.
    let mut after = 1.0;
    let answers = steps.iter().map(|step| {
        let h = step.duration / duration;
        after -= h;
        let position = 0.5 * after * (after + h) + h * h / 6.0;
        Vector3::new(1.0, after + 0.5 * h, position) * h
    });
    let answers: Vec<Vector3<f64>> = answers.collect();
    let changed = |k: usize| !steps[k].without_jerk;
    let mut gram = Matrix3::zeros();
    for (_, answer) in answers.iter().enumerate().filter(|(k, _)| changed(*k)) {
        gram += answer * answer.transpose();
    }
    let inverse = gram.lu();
    // Twice: the second pass removes the rounding of the first.
    for _ in 0..2 {
        let mut lacks = Vector3::new(0.0, 0.0, distance / duration.powi(3));
        for (answer, jerk) in answers.iter().zip(jerks.iter()) {
            lacks -= answer * *jerk;
        }
        let weights = inverse.solve(&lacks)?;
        for (k, answer) in answers.iter().enumerate().filter(|(k, _)| changed(*k)) {
            jerks[k] += answer.dot(&weights);
        }
    }
    Some(())
}

/// Whether a motion from rest keeps the limits, also between the ends of its phases.
pub fn keeps_limits(motion: &AxisProfile, limits: Limits) -> bool {
    let within = |value: f64, limit: f64| value.abs() <= limit * (1.0 + ROUNDING);
    motion.phases().iter().all(|phase| {
        let (before, jerk) = (phase.state, phase.jerk);
        let after = before.after(phase.duration, jerk);
        // The velocity is highest where the acceleration changes its sign.
        let turn = -before.acceleration / jerk;
        let peak = (0.0 < turn && turn < phase.duration).then(|| before.after(turn, jerk).velocity);
        within(jerk, limits.jerk)
            && within(after.acceleration, limits.acceleration)
            && within(after.velocity, limits.velocity)
            && peak.is_none_or(|peak| within(peak, limits.velocity))
    })
}
