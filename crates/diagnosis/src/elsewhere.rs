//! Evidence in the data for physics outside of this joint.

use super::autocorrelation::correlation;
use super::detrended::detrended;
use super::found::Found;
use super::problem::Problem;
use super::search::Search;
use super::thresholds::FLOOR;
use nalgebra::DVector;
use quell_model::Experiment;
use quell_signal::noise_floor;

/// Standard deviations beyond which the difference from an expected number is not chance.
const CHANCE: f64 = 5.0;

impl Search<'_> {
    /// A sentence on physics outside of this joint, where the best explanation leaves more than noise.
    pub fn elsewhere(&self, found: &Found) -> Option<String> {
        let point = &found.best.fitted.point;
        let left = |e| self.problem.explained(point, e).swap_remove(0);
        (!self.explains(found)).then(|| at_rest(self.problem, left))?
    }
}

/// The residual while the input rests, after the joint's own vibration has decayed: it is not the joint's.
fn at_rest(problem: &Problem, left: impl Fn(usize) -> Vec<f64>) -> Option<String> {
    let (mut chi, mut rows, mut dependent) = (0.0, 0, 0.0);
    for (e, experiment) in problem.experiments.iter().enumerate() {
        let (output, noise) = (&experiment.outputs[0], problem.noise[e][0].deviation);
        let left = left(e);
        for (from, to) in resting(problem, experiment, noise) {
            let first = output.time.partition_point(|time| *time < from);
            let last = output.time.partition_point(|time| *time <= to);
            // A constant or a linear change is the joint's own: friction holds a deformation, and a load
            // creeps.
            let own = DVector::from_vec(detrended(&left[first..last]));
            chi += own.norm_squared() / noise.powi(2);
            dependent += own.len() as f64 * correlation(&own);
            rows += own.len();
        }
    }
    let (chi, count) = (chi / rows as f64, rows as f64);
    let independent = count * count / dependent;
    // Relative scatter of the mean square of so many values.
    let chance = CHANCE * (2.0 / independent).sqrt();
    (rows > 0 && chi > FLOOR * (1.0 + chance)).then(|| {
        format!(
            "While the input rests, and its vibration has decayed, {:.1} times the noise is left. That motion comes from \
             elsewhere: from other joints, or from what the machine stands on.",
            chi.sqrt()
        )
    })
}

/// Stretches, s, in which the input rests and its vibration has decayed: a mode of the largest deformation has
/// fallen to the noise.
fn resting(problem: &Problem, experiment: &Experiment, noise: f64) -> Vec<(f64, f64)> {
    let scales = &problem.scales;
    if scales.forced || scales.rigid {
        return Vec::new();
    }
    let rate = scales.damping_ratio * scales.natural_frequency;
    let settles = (scales.deformation / noise).ln().max(0.0) / rate;
    let (time, values) = (&experiment.input_time, &experiment.input_values);
    let floor = noise_floor(values);
    let still = CHANCE * floor.standard_deviation + floor.quantisation.unwrap_or(0.0);
    let (mut stretches, mut first) = (Vec::new(), 0);
    for k in 1..=values.len() {
        if k < values.len() && (values[k] - values[first]).abs() <= still {
            continue;
        }
        let (from, to) = (time[first] + settles, time[k - 1]);
        if from < to {
            stretches.push((from, to));
        }
        first = k;
    }
    stretches
}
