//! The phases of an axis in closed form.
//!
//! Ruckig's binding gives the duration and states at given times, but no phases. Nearly every profile is
//! determined by one number, its cruise velocity. It comes from a state in the cruise, from the limit, or from
//! the duration if there is no cruise. Duration, target and the observed state are more than needed, and so
//! verify the guess.
//!
//! Source: L. Berscheid, T. Kroeger, "Jerk-limited Real-time Trajectory Generation with Arbitrary
//! Target States", Robotics: Science and Systems, 2021, for the profiles.

use crate::dip::dip;
use crate::path::Path;
use crate::read_back::Scale;
use crate::stop::stop;
use crate::{AxisProfile, AxisState, Limits};

/// The error of a profile that Ruckig itself accepts (`profile.hpp`): rad, rad/s, rad/s^2.
const PRECISION: AxisState = AxisState {
    position: 1e-8,
    velocity: 1e-8,
    acceleration: 1e-10,
};

/// The known move of one axis.
pub(crate) struct Known {
    pub(crate) from: AxisState,
    pub(crate) to: AxisState,
    pub(crate) limits: Limits,
    pub(crate) scale: Scale,
    /// A time within the move, s, and Ruckig's state there.
    pub(crate) seen: (f64, AxisState),
}

impl Known {
    /// The stop, wherever it ends, if a closed form explains all else that is known of it.
    pub(crate) fn stop(&self) -> Option<AxisProfile> {
        let steps = stop(self.from, self.limits, self.scale.duration);
        let path = Path::new(self.from, steps, &self.scale)?;
        let end = AxisState::at_rest(path.end().position);
        (self.near(path.end(), end) && self.seen_on(&path)).then(|| path.profile(end, &self.scale))
    }

    /// The move, if a closed form explains all that is known of it.
    pub(crate) fn profile(&self) -> Option<AxisProfile> {
        let (limit, seen) = (self.limits.velocity, self.seen.1);
        let path = if seen.acceleration.abs() <= self.scale.acceleration_rounding() {
            self.cruise_near(seen.velocity)
        } else {
            let turnings = [1.0, -1.0].into_iter().map(|side| self.turning(side));
            let mut guesses = turnings.chain([limit, -limit, seen.velocity]);
            guesses
                .find_map(|guess| self.cruise_near(guess))
                .or_else(|| self.dip())
        };
        path.map(|path| path.profile(self.to, &self.scale))
    }

    /// The short move without a cruise whose acceleration dips, if it is the one.
    fn dip(&self) -> Option<Path> {
        [1.0, -1.0].into_iter().find_map(|side| {
            let steps = dip(self.from, self.to, self.limits, self.scale.duration, side);
            let path = Path::new(self.from, steps, &self.scale)?;
            (self.near(path.end(), self.to) && self.seen_on(&path)).then_some(path)
        })
    }

    pub(crate) fn seen_on(&self, path: &Path) -> bool {
        let (time, seen) = self.seen;
        self.near(path.state_at(time), seen)
    }

    /// Whether two states are the same to Ruckig's own precision and to rounding.
    fn near(&self, found: AxisState, expected: AxisState) -> bool {
        let near = |error: f64, precision: f64, rounding: f64| error.abs() <= precision + rounding;
        near(
            found.position - expected.position,
            PRECISION.position,
            self.scale.position_rounding(),
        ) && near(
            found.velocity - expected.velocity,
            PRECISION.velocity,
            self.scale.velocity_rounding(),
        ) && near(
            found.acceleration - expected.acceleration,
            PRECISION.acceleration,
            self.scale.acceleration_rounding(),
        )
    }
}
