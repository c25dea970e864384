//! A move at another rate: `x(s(t))`, on the same path, to the same end.
//!
//! With `x` the move and `r = s'` the rate the motion is
//!
//! ```text
//! velocity      x' r
//! acceleration  x'' r^2 + x' r'
//! jerk          x''' r^3 + 3 x'' r r' + x' r''
//! ```
//!
//! The rate goes from one value to another as a cubic, `r(0)`, `r'(0)` given and `r'(D) = 0`, so that the acceleration does not jump.
//! Whether that keeps the limits depends on where in the move it begins: a move that brakes at its limit cannot be slowed. Source:
//! Dahl and Nielsen, Torque-limited path following by online trajectory time scaling, IEEE Transactions on Robotics and Automation 6
//! (1990), 554 to 561.

use crate::{AxisState, Limits, SampledTrajectory};

/// The shortest ramp that is tried, samples: the cubic needs some to be one.
const SHORTEST: f64 = 4.0;
/// Ratio of the durations of ramps that are tried, one after the other: the shortest that keeps the limits is met within a tenth.
const FINER: f64 = 1.1;
/// Rounding of velocities and accelerations by the planner, and of differences over one period.
const ROUNDING: f64 = 1e-9;

/// Position and rate within a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// `s`: time in the move, s.
    pub time: f64,
    /// `s'`, 1 for the move as it is.
    pub rate: f64,
    /// `s''`, 1/s.
    pub slope: f64,
}

/// A change of the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateRamp {
    /// Where it begins.
    pub from: Progress,
    /// The rate from its end on.
    pub to: f64,
    /// Its duration, s.
    pub duration: f64,
}

impl RateRamp {
    /// A move from its start on at a rate that does not change.
    pub fn steady(rate: f64) -> Self {
        Self {
            from: Progress {
                time: 0.0,
                rate,
                slope: 0.0,
            },
            to: rate,
            duration: 0.0,
        }
    }

    /// The same ramp to the rate at which the move, of `end` (s) at rate 1, arrives there `left` (s) after the beginning of the ramp:
    /// `s(D)` is linear in that rate. `None` where there is none that is above 0.
    pub fn arriving(&self, end: f64, left: f64) -> Option<Self> {
        let Self { from, duration, .. } = *self;
        let gone = duration * (0.5 * from.rate + from.slope * duration / 12.0);
        let to = (end - from.time - gone) / (left - 0.5 * duration);
        (to > 0.0 && to.is_finite()).then_some(Self { to, ..*self })
    }

    /// The progress `elapsed` (s, 0 or more) after its beginning.
    pub fn after(&self, elapsed: f64) -> Progress {
        let Self { from, to, duration } = *self;
        let within = elapsed.min(duration);
        let u = match duration > 0.0 {
            true => within / duration,
            false => 1.0,
        };
        let (rise, bend) = (to - from.rate, from.slope * duration);
        let gone = from.rate * u
            + rise * u.powi(3) * (1.0 - 0.5 * u)
            + bend * u * u * (0.5 + u * (0.25 * u - 2.0 / 3.0));
        let over = elapsed - within;
        Progress {
            time: from.time + duration * gone + over * to,
            rate: from.rate + rise * u * u * (3.0 - 2.0 * u) + bend * u * (1.0 - u).powi(2),
            slope: match u < 1.0 {
                true => {
                    6.0 * rise * u * (1.0 - u) / duration + from.slope * (1.0 - u) * (1.0 - 3.0 * u)
                }
                false => 0.0,
            },
        }
    }
}

impl SampledTrajectory {
    /// Time from the first sample to the last, s.
    pub fn duration(&self) -> f64 {
        (self.samples() - 1) as f64 * self.period()
    }

    /// The motion of one axis at a progress; at rest at the end from the last sample on. `None` if there is no such axis.
    ///
    /// Between samples velocity and acceleration are linear, so that they and the mean jerk stay within what the samples keep.
    pub fn run_through(&self, axis: usize, at: Progress) -> Option<AxisState> {
        let place = (at.time / self.period()).max(0.0);
        let before = place as usize;
        let (from, to) = (self.state(axis, before)?, self.state(axis, before + 1)?);
        let x = from.between_within_limits(to, place - before as f64, self.period());
        Some(AxisState {
            position: x.position,
            velocity: x.velocity * at.rate,
            acceleration: x.acceleration * at.rate.powi(2) + x.velocity * at.slope,
        })
    }

    /// The rest of the move along a ramp, from its beginning to the first sample that is not before the end.
    /// `None` if it would stop on the way, last longer than [`crate::MAX_SAMPLES`], or exceed `limits`, one for
    /// each axis, in velocity, acceleration, or means of both and of the jerk from sample to sample: at a higher
    /// rate the move may brake between two of them. Allocates.
    pub fn at_rate(&self, ramp: &RateRamp, limits: &[Limits]) -> Option<Self> {
        let (period, end) = (self.period(), self.duration());
        // After the ramp alone: not known only once so many samples are made.
        let steady = (end - ramp.after(ramp.duration).time) / ramp.to;
        if steady > crate::MAX_SAMPLES as f64 * period {
            return None;
        }
        let mut axes = vec![Vec::new(); self.degrees_of_freedom()];
        let mut place = ramp.from;
        for index in 0.. {
            // The last sample is the end to the bit.
            let is_last = place.time >= end * (1.0 - ROUNDING);
            for (axis, states) in axes.iter_mut().enumerate() {
                let now = match is_last {
                    true => self.state(axis, self.samples() - 1)?,
                    false => self.run_through(axis, place)?,
                };
                if let Some(before) = states.last() {
                    keeps(before, &now, limits.get(axis)?, period).then_some(())?;
                }
                states.push(now);
            }
            if is_last {
                break;
            }
            place = ramp.after((index + 1) as f64 * period);
            if !(place.rate > 0.0 && index + 1 < crate::MAX_SAMPLES) {
                return None;
            }
        }
        let states = axes.concat();
        Some(Self::of_states(period, self.degrees_of_freedom(), &states))
    }

    /// The ramps that are worth trying from a progress to a rate, the shortest first; the longest lasts as long as the rest of the
    /// move at the lower rate.
    pub fn rate_ramps(&self, from: Progress, to: f64) -> impl Iterator<Item = RateRamp> {
        let rest = (self.duration() - from.time) / from.rate.min(to);
        let first = SHORTEST * self.period();
        let durations = core::iter::successors(Some(first), |duration| Some(FINER * duration));
        durations
            .take_while(move |duration| *duration < rest.max(2.0 * first))
            .map(move |duration| RateRamp { from, to, duration })
    }
}

fn keeps(before: &AxisState, now: &AxisState, limits: &Limits, period: f64) -> bool {
    let slope = |from: f64, to: f64| (to - from) / period;
    let jerk = slope(before.acceleration, now.acceleration);
    let within = |value: f64, most: f64| value.abs() <= most * (1.0 + ROUNDING);
    within(now.velocity, limits.velocity)
        && within(now.acceleration, limits.acceleration)
        && within(slope(before.position, now.position), limits.velocity)
        && within(slope(before.velocity, now.velocity), limits.acceleration)
        && within(jerk, limits.jerk)
}
