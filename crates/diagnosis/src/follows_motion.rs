//! Whether what an explanation leaves grows with the motion, as what a model lacks does, and noise does not.

use super::detrended::detrended;
use super::point::Point;
use super::problem::Problem;

/// Length of a window in periods of the mode.
const WINDOW: f64 = 3.0;
/// Fewest windows whose powers are compared with as many others.
const FEWEST: usize = 6;
/// Ratio of the motion's power, of the windows that move most over those that move least, in which a mismatch shows that
/// is as large as the noise: it is then eleven times as large in power there.
const CONTRAST: f64 = 10.0;
/// Standard deviations by which the logarithms of the powers differ with a chance of one in twenty.
const CHANCE: f64 = 1.64;

impl Problem<'_> {
    /// Whether an output's residual has more power in the third of the windows that move most than in the third that
    /// move least. `None` where the windows are too few, or move too much alike, to tell; or where a force drives the
    /// motor side freely, and errors add up.
    pub fn follows_motion(&self, point: &Point) -> Option<bool> {
        if self.scales.forced {
            return None;
        }
        let mut windows: Vec<(f64, Vec<f64>)> = Vec::new();
        for e in 0..self.experiments.len() {
            windows.extend(self.powers(point, e));
        }
        windows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let third = windows.len() / 3;
        let (least, most) = (windows.get(..third)?, &windows[windows.len() - third..]);
        let motion = |part: &[(f64, Vec<f64>)]| part.iter().map(|own| own.0).sum::<f64>();
        if third < FEWEST || motion(most) < CONTRAST * motion(least) {
            return None;
        }
        let outputs = windows.iter().map(|own| own.1.len()).min()?;
        let grows = |k: usize| {
            let [(still, a), (moved, b)] = [least, most].map(|part| mean_of_logarithms(part, k));
            moved - still > CHANCE * (a + b).sqrt()
        };
        Some((0..outputs).any(grows))
    }

    /// Of each window of an experiment the motion's power, in that of the whole, and the residual's of each output. What
    /// stands still, or creeps, does not count: friction holds a deformation at rest.
    fn powers(&self, point: &Point, e: usize) -> Vec<(f64, Vec<f64>)> {
        let experiment = &self.experiments[e];
        let residuals = self.explained(point, e);
        let [motor, link] = self.kinematics(point, e);
        let time = &experiment.outputs[0].time;
        let speeds = motor.iter().zip(&link).map(|(m, l)| [m[1], l[1] - m[1]]);
        let speeds: Vec<[f64; 2]> = speeds.collect();
        let whole = [0, 1].map(|k| power(&speeds, k).max(f64::MIN_POSITIVE));
        let length = WINDOW * self.scales.period();
        let count = ((time[time.len() - 1] - time[0]) / length) as usize;
        let window = |index: usize| {
            let from = time[0] + index as f64 * length;
            let within = |time: &[f64]| {
                let at = |t: f64| time.partition_point(|own| *own < t);
                at(from)..at(from + length)
            };
            let speeds = &speeds[within(time)];
            let motion = power(speeds, 0) / whole[0] + power(speeds, 1) / whole[1];
            let outputs = experiment.outputs.iter().zip(&residuals);
            let left = outputs.map(|(output, residual)| {
                let own = detrended(&residual[within(&output.time)]);
                own.iter().map(|r| r * r).sum::<f64>() / own.len().max(1) as f64
            });
            (motion, left.collect())
        };
        (0..count).map(window).collect()
    }
}

fn power(speeds: &[[f64; 2]], k: usize) -> f64 {
    speeds.iter().map(|own| own[k] * own[k]).sum::<f64>() / speeds.len().max(1) as f64
}

/// Mean of the logarithms of the powers of an output, and its variance.
fn mean_of_logarithms(windows: &[(f64, Vec<f64>)], k: usize) -> (f64, f64) {
    let count = windows.len() as f64;
    let logarithms = windows
        .iter()
        .map(|own| own.1[k].max(f64::MIN_POSITIVE).ln());
    let all: Vec<f64> = logarithms.collect();
    let mean = all.iter().sum::<f64>() / count;
    let square: f64 = all.iter().map(|own| (own - mean).powi(2)).sum();
    (mean, square / (count - 1.0) / count)
}
