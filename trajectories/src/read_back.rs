//! The phases of an axis, recovered from its states alone.

use crate::{AxisProfile, AxisState, Phase};

/// The scale of a move, from which the rounding of its states follows.
///
/// Ruckig adds up the times of up to ten phases and evaluates cubic polynomials there. An error of
/// time, some `eps T`, moves each state by its derivative.
#[derive(Clone, Copy)]
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
        let rounding = Self::ROUNDING * (self.acceleration + jerk * self.duration);
        (seen.acceleration - expected.acceleration).abs() <= rounding
            && (seen.velocity - expected.velocity).abs() <= self.velocity_rounding()
            && (seen.position - expected.position).abs() <= self.position_rounding()
    }

    /// The rounding of a position, rad.
    pub(crate) fn position_rounding(&self) -> f64 {
        Self::ROUNDING * (self.position + self.velocity_scale() * self.duration)
    }

    /// The rounding of an acceleration, rad/s^2.
    pub(crate) fn acceleration_rounding(&self) -> f64 {
        Self::ROUNDING * (self.acceleration + self.jerk * self.duration)
    }

    /// The rounding of a velocity, rad/s.
    pub(crate) fn velocity_rounding(&self) -> f64 {
        Self::ROUNDING * self.velocity_scale()
    }

    fn velocity_scale(&self) -> f64 {
        self.velocity + self.acceleration * self.duration
    }

    /// A phase that lasts no longer (s) is none: Ruckig separates phases by steps of 2.2e-14 s, which join the
    /// phase before them.
    pub(crate) fn instant(&self) -> f64 {
        (256.0 * f64::EPSILON * self.duration).max(1e-13)
    }
}

/// Reads the phases back from states of the axis at any time, as Ruckig's binding tells them.
///
/// The acceleration is continuous and piecewise linear, so that the only kink of a stretch follows
/// in closed form from four of its points. Where the states within disagree, the stretch is split.
/// The rest agrees with Ruckig to rounding.
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
    AxisProfile::new(phases, (start, end), duration)
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
            if after - time > self.scale.instant() && !self.has_constant_jerk(before, after) {
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
