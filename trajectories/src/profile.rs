//! The move of one axis: phases of constant jerk.

use crate::AxisState;

/// A stretch of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// When it begins, s after the start of the move.
    pub start: f64,
    /// How long it lasts, s.
    pub duration: f64,
    /// State at its beginning.
    pub state: AxisState,
    /// Jerk during the phase, rad/s^3.
    pub jerk: f64,
}

/// The move of one axis as phases of constant jerk: up to seven, and up to two more in front where
/// the axis starts beyond a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisProfile {
    phases: Vec<Phase>,
    start: AxisState,
    end: AxisState,
    duration: f64,
}

impl AxisProfile {
    /// The state at `time` (s): exactly the start up to 0, exactly the end from the duration on.
    ///
    /// Runs at the tick: a look-up over at most nine phases, no allocation.
    pub fn state_at(&self, time: f64) -> AxisState {
        if time >= self.duration {
            return self.end;
        }
        if time <= 0.0 {
            return self.start;
        }
        let phase = self.phases.iter().rev().find(|phase| phase.start <= time);
        phase.map_or(self.start, |phase| {
            phase.state.after(time - phase.start, phase.jerk)
        })
    }

    /// The phases of constant jerk, in order, without gaps; empty if the move lasts 0 s.
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// The state in which the axis ends: the target, to the bit.
    pub fn end(&self) -> AxisState {
        self.end
    }
}

/// The scale of a move, from which the rounding of its states follows.
///
/// Ruckig adds up the times of up to ten phases and evaluates cubic polynomials there. An error of
/// time, some `eps T`, moves each state by its derivative.
pub(crate) struct Scale {
    pub(crate) duration: f64,
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

impl Scale {
    /// Ten roundings, one for each phase.
    const ROUNDING: f64 = 10.0 * f64::EPSILON;

    fn agree(&self, seen: AxisState, expected: AxisState, jerk: f64) -> bool {
        let Self {
            duration,
            position,
            velocity,
            acceleration,
            ..
        } = *self;
        let acceleration_change = acceleration * duration;
        let within = |error: f64, scale: f64| error.abs() <= Self::ROUNDING * scale;
        within(
            seen.acceleration - expected.acceleration,
            acceleration + jerk * duration,
        ) && within(
            seen.velocity - expected.velocity,
            velocity + acceleration_change,
        ) && within(
            seen.position - expected.position,
            position + (velocity + acceleration_change) * duration,
        )
    }
}

/// Reads the phases back from states of the axis at any time, as Ruckig's binding tells them.
///
/// The acceleration is continuous and piecewise linear, so that the only kink of a stretch follows
/// in closed form from four of its points. Where the states within disagree, the stretch is split.
/// What is left agrees with Ruckig to rounding.
pub(crate) fn read_back(
    state_at: impl Fn(f64) -> AxisState,
    scale: Scale,
    (start, end): (AxisState, AxisState),
) -> AxisProfile {
    let duration = scale.duration;
    let mut reader = Reader {
        state_at,
        scale,
        kinks: vec![],
    };
    let mut phases = Vec::new();
    if duration > 0.0 {
        reader.find_kinks(0.0, duration);
        let times = reader.true_kinks(duration);
        phases.extend(times.windows(2).map(|pair| reader.phase(pair[0], pair[1])));
    }
    AxisProfile {
        phases,
        start,
        end,
        duration,
    }
}

/// Finds the times at which the jerk of an axis steps.
struct Reader<F> {
    state_at: F,
    scale: Scale,
    kinks: Vec<f64>,
}

impl<F: Fn(f64) -> AxisState> Reader<F> {
    /// Lists times between which the jerk is constant; some of them are no kinks.
    fn find_kinks(&mut self, start: f64, stop: f64) {
        // Not halved: no symmetry of the move shall make the points agree by chance.
        let middle = start + 0.4567 * (stop - start);
        let shortest = 16.0 * f64::EPSILON * self.scale.duration;
        if stop - start <= shortest || self.has_constant_jerk(start, stop) {
            return;
        }
        let kink = self.kink_between(start, stop);
        let alone =
            |&kink: &f64| self.has_constant_jerk(start, kink) && self.has_constant_jerk(kink, stop);
        if let Some(kink) = kink.filter(alone) {
            self.kinks.push(kink);
            return;
        }
        self.find_kinks(start, middle);
        self.kinks.push(middle);
        self.find_kinks(middle, stop);
    }

    /// Where the lines through the first and through the last tenth of the acceleration meet.
    fn kink_between(&self, start: f64, stop: f64) -> Option<f64> {
        let tenth = 0.1 * (stop - start);
        let (first, last) = (self.acceleration(start), self.acceleration(stop));
        let first_jerk = (self.acceleration(start + tenth) - first) / tenth;
        let last_jerk = (last - self.acceleration(stop - tenth)) / tenth;
        let kink = start + (last - first - last_jerk * (stop - start)) / (first_jerk - last_jerk);
        (start < kink && kink < stop).then_some(kink)
    }

    /// Velocity and position are compared too: they remember a pulse between the points. At the
    /// ends the time of the kink is rounded, which counts with the largest jerk.
    fn has_constant_jerk(&self, start: f64, stop: f64) -> bool {
        let (phase, length) = (self.phase(start, stop), stop - start);
        let agrees = |share: f64, jerk: f64| {
            let seen = (self.state_at)(start + share * length);
            self.scale
                .agree(seen, phase.state.after(share * length, phase.jerk), jerk)
        };
        [0.031, 0.077, 0.231, 0.389, 0.617, 0.773, 0.941, 0.973]
            .iter()
            .all(|&share| agrees(share, phase.jerk.abs().min(self.scale.jerk)))
            && agrees(0.0, self.scale.jerk)
            && agrees(1.0, self.scale.jerk)
    }

    /// The kinks, from 0 to the duration, without those at which the acceleration does not bend.
    fn true_kinks(&self, duration: f64) -> Vec<f64> {
        let mut times = vec![0.0];
        for (index, &time) in self.kinks.iter().enumerate() {
            let before = times.last().copied().unwrap_or(0.0);
            let after = self.kinks.get(index + 1).copied().unwrap_or(duration);
            // Ruckig separates phases by steps of 2.2e-14 s: they join the phase before them.
            let instant = (256.0 * f64::EPSILON * duration).max(1e-13);
            if after - time > instant && !self.has_constant_jerk(before, after) {
                times.push(time);
            }
        }
        times.push(duration);
        times
    }

    /// The phase through the states well within the stretch, which the rounding of the kinks'
    /// times does not touch.
    fn phase(&self, start: f64, stop: f64) -> Phase {
        let duration = stop - start;
        let (early, late) = (start + 0.1 * duration, start + 0.9 * duration);
        let jerk = (self.acceleration(late) - self.acceleration(early)) / (late - early);
        let middle = start + 0.5 * duration;
        let state = (self.state_at)(middle).after(start - middle, jerk);
        Phase {
            start,
            duration,
            state,
            jerk,
        }
    }

    fn acceleration(&self, time: f64) -> f64 {
        (self.state_at)(time).acceleration
    }
}
