//! Progress of the command at a tick after missed ticks.
//!
//! The robot's time went on during the missed ticks. A command that waited for the tick would be late by the
//! missed time from then on: a step of the command by the distance of the joint in that time, which causes
//! vibration.
//!
//! **Up to [`BRIDGED`] the time is made up for**: the setpoint is that of its own instant, as if no tick had
//! been missed. There is then more time between two setpoints, and the command changes by what the plan changes
//! in that time. The plan keeps the limits at every instant, so that this is no jump, but the next point of the
//! same motion. A robot that follows the stamps, or predicts the motion for a missing setpoint, sees none. A
//! robot that holds the last setpoint for a time h at a velocity v sees an error of area v h^2 / 2. It causes a
//! vibration of w v h^2 / 2, where a delay causes v h: less, as long as h is below a third of the mode's
//! period.
//!
//! **Where setpoints carry no time** the robot takes each one as the next, whenever it arrives, and nothing is
//! made up for. The command waits for the tick and continues from where it was, so that it never changes by
//! more than the plan does in a control period. Making up for a time h would be a step of v h at once, which a
//! position controller follows, or refuses as a violation of its velocity limit. Waiting is two steps of the
//! velocity, to a stop and back, h apart: together they excite 2 sin(w h / 2) of what one of them does. A slow
//! start would be the first step alone. Up to h of a sixth of the mode's period waiting causes less vibration;
//! at 8 Hz that is [`BRIDGED`], too.
//!
//! **After a longer time** the robot no longer predicts: it has stopped, or been stopped, and the next point of
//! the motion would be a jump. The command then continues from where it was and starts slowly, at a rate `r(t)
//! = tanh^2(k t)` that rises from 0 to 1. Let `x` be the command at its full rate, within V, A and J in
//! velocity, acceleration and jerk. Then
//!
//! ```text
//! velocity      x' r                         <= V
//! acceleration  x'' r^2 + x' r'              <= A  for  k <= A / V
//! jerk          x''' r^3 + 3 x'' r r' + x' r''  <= J  for  2 A k + 2 V k^2 <= J
//! ```
//!
//! by `r' = 2 k sqrt(r) (1 - r)` and `r'' = 2 k^2 (1 - 3 r) (1 - r)`. For the acceleration the sum relative to
//! its bound is largest at r = 1. For the jerk `r^1.5 <= (1 + r + r^2) / 3` and `|1 - 3 r| <= 1 + r + r^2` make
//! the two terms beside `J r^3` less than `(2 A k + 2 V k^2) (1 - r^3)`. Between two setpoints `x'` and `x''`
//! are linear, so that the bounds hold for the sent command, too. The command falls back by 1 / k in all, which
//! is rounded up to a whole number of periods, so that it ends on its own samples.
//!
//! [`BRIDGED`]: crate::service::bridged::BRIDGED

use quell_trajectories::Limits;

use crate::service::bridged::bridged;

/// The progress of the command at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stride {
    /// Control periods by which every joint advances.
    pub periods: u64,
    /// Distance of the setpoint behind the last of them, control periods, 0 to 1.
    pub behind: f64,
    /// Rate of the command, 0 to 1.
    pub rate: f64,
    /// Its derivative, 1/s.
    pub slope: f64,
}

impl Stride {
    /// A tick at full rate after others that were missed.
    fn whole(missed: u64) -> Self {
        Self {
            periods: missed.saturating_add(1),
            behind: 0.0,
            rate: 1.0,
            slope: 0.0,
        }
    }
}

/// A slow start in progress.
#[derive(Clone, Copy, Debug)]
struct SlowStart {
    /// Initial distance behind the last sample, control periods.
    behind: f64,
    /// Total lag of the command, ticks.
    lag: f64,
    /// Ticks since.
    ticks: f64,
    /// Control periods gone by since.
    periods: u64,
}

/// The progress of the command from tick to tick. No allocation.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    period: f64,
    /// Whether setpoints tell the robot the elapsed time.
    timed: bool,
    /// Least lag of a slow start, ticks.
    lag: f64,
    slow: Option<SlowStart>,
}

impl Pace {
    /// For joints with these limits and a control period, s. `timed` tells whether setpoints carry time.
    pub fn new(limits: impl Iterator<Item = Limits>, period: f64, timed: bool) -> Self {
        let lags = limits.map(|limits| 1.0 / (steepness(limits) * period));
        Self {
            period,
            timed,
            lag: lags.fold(1.0, f64::max),
            slow: None,
        }
    }

    /// The stride of a tick after `missed` ones, while a joint `moves` or none does.
    pub fn stride(&mut self, missed: u64, moves: bool) -> Stride {
        if !moves {
            self.slow = None;
            return Stride::whole(0);
        }
        if missed > bridged(self.period) {
            let behind = self.slow.map_or(0.0, |slow| slow.behind());
            let start = SlowStart {
                behind,
                lag: (self.lag + behind).ceil() - behind,
                ticks: 0.0,
                periods: 0,
            };
            return self.go_on(start, 1);
        }
        let made_up = if self.timed { missed } else { 0 };
        match self.slow {
            Some(slow) => self.go_on(slow, made_up + 1),
            None => Stride::whole(made_up),
        }
    }

    fn go_on(&mut self, before: SlowStart, ticks: u64) -> Stride {
        let mut slow = before;
        slow.ticks += ticks as f64;
        let root = (slow.ticks / slow.lag).tanh();
        let over = root >= 1.0;
        // At full rate it is on its own samples, up to rounding.
        let periods = match over {
            true => slow.progress().round(),
            false => slow.progress().ceil(),
        };
        slow.periods = periods.max(0.0) as u64;
        let steepness = 1.0 / (slow.lag * self.period);
        self.slow = (!over).then_some(slow);
        Stride {
            periods: slow.periods.saturating_sub(before.periods),
            behind: if over { 0.0 } else { slow.behind() },
            rate: root * root,
            slope: 2.0 * steepness * root * (1.0 - root * root),
        }
    }
}

impl SlowStart {
    /// Integral of the rate, from the last sample before it, control periods.
    fn progress(&self) -> f64 {
        self.ticks - self.lag * (self.ticks / self.lag).tanh() - self.behind
    }

    fn behind(&self) -> f64 {
        self.periods as f64 - self.progress()
    }
}

/// The largest k that keeps the limits, 1/s.
fn steepness(limits: Limits) -> f64 {
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = limits;
    let root = (acceleration * acceleration + 2.0 * velocity * jerk).sqrt();
    let by_jerk = (root - acceleration) / (2.0 * velocity);
    by_jerk.min(acceleration / velocity)
}
