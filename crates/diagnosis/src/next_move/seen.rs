//! Limits of a proposed move, from the recordings.

use quell_model::Experiment;
use quell_signal::{CubicSpline, End, noise_floor};
use quell_trajectories::Limits;

/// Extremes of the recorded motion of the motor side, in the input's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Where the first recording starts, and where a proposed move does.
    pub start: f64,
    /// Least and greatest position.
    pub range: (f64, f64),
    /// Greatest speed, acceleration and jerk.
    pub limits: Limits,
}

/// Binomial coefficients of the first, second and third difference, their signs left out.
const DIFFERENCES: [&[f64]; 3] = [&[1.0, 1.0], &[1.0, 2.0, 1.0], &[1.0, 3.0, 3.0, 1.0]];
/// Greatest of some thousand normal numbers, in standard deviations.
const GREATEST: f64 = 4.0;
/// Share of a difference that may be noise.
const NOISY: f64 = 0.1;

impl Seen {
    /// Extremes over all experiments; `None` where nothing moves. `period` is that of the model's mode, s.
    ///
    /// A difference of order n over steps of `h`, divided by `h^n`, is a local mean of the n-th derivative: it
    /// never exceeds the greatest one. `h` starts at a radian of the mode and grows until the noise is small;
    /// the possible part of the noise is subtracted.
    pub fn new(experiments: &[Experiment], period: f64) -> Option<Self> {
        let mut seen: Option<Self> = None;
        for experiment in experiments {
            let own = Self::of(&experiment.input_time, &experiment.input_values, period)?;
            seen = Some(seen.map_or(own, |all| all.and(own)));
        }
        seen
    }

    fn of(time: &[f64], values: &[f64], period: f64) -> Option<Self> {
        let spline = CubicSpline::new(time, values, End::NotAKnot).ok()?;
        let noise = noise_floor(values).standard_deviation;
        let fold = |f: fn(f64, f64) -> f64, first: f64| values.iter().fold(first, |m, v| f(m, *v));
        let sampling = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        let steps = (sampling.max(period / std::f64::consts::TAU), period);
        let [velocity, acceleration, jerk] =
            DIFFERENCES.map(|weights| greatest(&spline, time, weights, steps, noise));
        let moves = [velocity, acceleration, jerk]
            .iter()
            .all(|limit| *limit > 0.0);
        moves.then_some(Self {
            start: values[0],
            range: (
                fold(f64::min, f64::INFINITY),
                fold(f64::max, f64::NEG_INFINITY),
            ),
            limits: Limits {
                velocity,
                acceleration,
                jerk,
            },
        })
    }

    fn and(self, other: Self) -> Self {
        let (own, theirs) = (self.limits, other.limits);
        Self {
            start: self.start,
            range: (
                self.range.0.min(other.range.0),
                self.range.1.max(other.range.1),
            ),
            limits: Limits {
                velocity: own.velocity.max(theirs.velocity),
                acceleration: own.acceleration.max(theirs.acceleration),
                jerk: own.jerk.max(theirs.jerk),
            },
        }
    }
}

/// Greatest derivative over steps of the least length at which it exceeds the noise.
fn greatest(
    spline: &CubicSpline,
    time: &[f64],
    weights: &[f64],
    (shortest, longest): (f64, f64),
    noise: f64,
) -> f64 {
    let order = weights.len() as i32 - 1;
    let power = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
    let mut step = shortest;
    loop {
        let most = time
            .iter()
            .map(|&t| difference(spline, t, weights, step))
            .fold(0.0, f64::max);
        let added = GREATEST * power * noise;
        if added < NOISY * most || 2.0 * step > longest {
            return (most - added) / step.powi(order);
        }
        step *= 2.0;
    }
}

/// Size of the difference about an instant; 0 where it would reach beyond the record.
fn difference(spline: &CubicSpline, time: f64, weights: &[f64], step: f64) -> f64 {
    let half = 0.5 * step * (weights.len() - 1) as f64;
    let (first, last) = spline.span();
    if time - half < first || time + half > last {
        return 0.0;
    }
    let mut sign = 1.0;
    let mut sum = 0.0;
    for (k, weight) in weights.iter().enumerate() {
        sum += sign * weight * spline.value(time - half + k as f64 * step);
        sign = -sign;
    }
    sum.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_trajectories::{AxisState, Planner};

    /// What is seen in a recorded motion is never beyond its limits, and close to them, whatever the
    /// encoder rounds to.
    #[test]
    fn limits_are_those_of_the_motion() {
        let limits = Limits {
            velocity: 0.8,
            acceleration: 4.0,
            jerk: 90.0,
        };
        let ends = [0.2, 1.4].map(AxisState::at_rest);
        let planned = Planner::new(1).unwrap();
        let planned = planned.plan(&ends[..1], &ends[1..], &[limits]).unwrap();
        for step in [1e-9, 1e-6, 1e-5] {
            let mut values = vec![0.2; 100];
            values.extend(planned.sample(0.004).unwrap().positions(0));
            values.extend(vec![1.4; 100]);
            let time: Vec<f64> = (0..values.len()).map(|k| 0.004 * k as f64).collect();
            for value in &mut values {
                *value = (*value / step).round() * step;
            }
            let seen = Seen::of(&time, &values, 0.125).unwrap();
            let found = [
                seen.limits.velocity,
                seen.limits.acceleration,
                seen.limits.jerk,
            ];
            let true_ones = [limits.velocity, limits.acceleration, limits.jerk];
            println!("{step}: {found:?}");
            for (found, limit) in found.into_iter().zip(true_ones) {
                // The spline's own error at the kinks of the acceleration is a thousandth.
                assert!(
                    found < 1.001 * limit && found > 0.5 * limit,
                    "{found} of {limit}"
                );
            }
            assert!((seen.range.0 - 0.2).abs() <= step && (seen.range.1 - 1.4).abs() <= step);
        }
        assert!(Seen::of(&[0.0, 1.0, 2.0, 3.0], &[0.5; 4], 0.125).is_none());
    }
}
