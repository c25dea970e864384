//! Whether a residual grows with the motion. Missing physics does, noise does not.

use super::detrended::detrended;
use super::noise::most_at_rest;
use super::point::Point;
use super::problem::Problem;
use super::thresholds::FLOOR;

/// Fewest windows from which the scatter of their powers is known.
const FEWEST: usize = 3;
/// One-sided 95 % of the normal distribution.
const CHANCE: f64 = 1.64;

/// The powers in one window of a recording.
struct Powers {
    /// Power of the motion, relative to that of the whole recording.
    motion: f64,
    /// Power of the residual of each output, relative to that of its noise.
    left: Vec<f64>,
}

impl Problem<'_> {
    /// Whether the residual at a point grows with the motion. `None` where too few periods were recorded, or
    /// where a force drives the motor side: free errors add up, and what is missing acts at rest, too, where
    /// friction holds the motor side against the force.
    ///
    /// The windows have the length of a period. By the power of their motion, `a` is the third that moves least
    /// and `b` the third that moves most. Let `e` be the residual's power beyond the noise. If it were a
    /// mismatch proportional to the motion's power `m`, the logarithm of the residual's power would rise by `ln
    /// (1 + e m_b) - ln (1 + e m_a)`; for noise it does not rise. If the rise is less than half of that, and not
    /// above 0, both with 95 % confidence, the residual is noise: at half of it both likelihoods are equal. A
    /// mismatch of another shape rises less than the motion's power, and what rings after a hit does not rise: where the
    /// noise was seen at rest for a period or longer, a residual that is larger than it is no noise either.
    pub fn follows_motion(&self, point: &Point) -> Option<bool> {
        let coupled = self.experiments.iter().any(|own| own.coupling.is_some());
        if self.scales.forced || coupled {
            return None;
        }
        let all = 0..self.experiments.len();
        let mut exceeds_rest = false;
        let mut windows: Vec<Powers> = Vec::new();
        for e in all {
            let residuals = self.explained(point, e);
            let own = self.powers(point, e, &residuals);
            exceeds_rest |= self.exceeds_rest(e, &residuals, &own);
            windows.extend(own);
        }
        windows.sort_by(|a, b| a.motion.total_cmp(&b.motion));
        let third = windows.len() / 3;
        if third < FEWEST {
            return None;
        }
        let parts = [&windows[..third], &windows[windows.len() - third..]];
        let moves = parts.map(|part| mean(part.iter().map(|own| own.motion)));
        let outputs = windows.iter().map(|own| own.left.len()).min()?;
        let grows = |k: usize| {
            let beyond = mean(windows.iter().map(|own| own.left[k])) - 1.0;
            let [still, moved] = moves.map(|motion| (1.0 + beyond * motion).ln());
            let [(a, var_a), (b, var_b)] = parts.map(|part| of_logarithms(part, k));
            let (rise, error) = (b - a, CHANCE * (var_a + var_b).sqrt());
            beyond > FLOOR - 1.0 && (rise + error > 0.5 * (moved - still) || rise > error)
        };
        Some(exceeds_rest || (0..outputs).any(grows))
    }

    /// Whether an output whose noise was measured at rest has a residual that is no such noise.
    fn exceeds_rest(&self, e: usize, residuals: &[Vec<f64>], windows: &[Powers]) -> bool {
        let (experiment, scales) = (&self.experiments[e], &self.scales);
        let rates = (
            scales.natural_frequency * scales.damping_ratio,
            scales.period(),
        );
        (0..experiment.outputs.len()).any(|k| {
            let most = most_at_rest(experiment, &experiment.outputs[k], &residuals[k], rates);
            let most = most.map(|most| most / self.noise[e][k].deviation.powi(2));
            let left = mean(windows.iter().map(|own| own.left[k]));
            most.is_some_and(|most| (1.0..left).contains(&most))
        })
    }

    /// The powers of the windows of an experiment. A constant or linear residual is taken out: friction holds a
    /// deformation at rest.
    fn powers(&self, point: &Point, e: usize, residuals: &[Vec<f64>]) -> Vec<Powers> {
        let experiment = &self.experiments[e];
        let [motor, link] = self.kinematics(point, e);
        let time = &experiment.outputs[0].time;
        let bodies = motor.iter().zip(&link);
        let speeds = bodies.map(|(m, l)| [m[1], l[1] - m[1]]);
        let speeds: Vec<[f64; 2]> = speeds.collect();
        let power = |speeds: &[[f64; 2]], k: usize| mean(speeds.iter().map(|own| own[k] * own[k]));
        let whole = [0, 1].map(|k| power(&speeds, k));
        let period = self.scales.period();
        let count = ((time[time.len() - 1] - time[0]) / period) as usize;
        let window = |index: usize| {
            let from = time[0] + index as f64 * period;
            let within = |time: &[f64]| {
                let at = |t: f64| time.partition_point(|own| *own < t);
                at(from)..at(from + period)
            };
            let own = &speeds[within(time)];
            let moving = (0..2).filter(|&k| whole[k] > 0.0);
            let motion = mean(moving.map(|k| power(own, k) / whole[k]));
            let outputs = experiment.outputs.iter().zip(residuals);
            let left = outputs.zip(&self.noise[e]);
            let left = left.map(|((output, residual), noise)| {
                let rest = detrended(&residual[within(&output.time)]);
                mean(rest.iter().map(|r| r * r)) / noise.deviation.powi(2)
            });
            Powers {
                motion,
                left: left.collect(),
            }
        };
        let told = |own: &Powers| own.left.iter().chain([&own.motion]).all(|p| p.is_finite());
        (0..count).map(window).filter(told).collect()
    }
}

/// Mean of the values; NaN where there are none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), own| (sum + own, count + 1.0));
    sum / count
}

/// Mean of the logarithms of the powers of an output, and its variance.
fn of_logarithms(windows: &[Powers], k: usize) -> (f64, f64) {
    let logarithm = |own: &Powers| own.left[k].max(f64::MIN_POSITIVE).ln();
    let middle = mean(windows.iter().map(logarithm));
    let square = mean(windows.iter().map(|own| (logarithm(own) - middle).powi(2)));
    (middle, square / (windows.len() as f64 - 1.0))
}
