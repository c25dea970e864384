//! Deviations of a simulation from the robot's description, checked.

use arrayvec::ArrayVec;
use quell_shapers::Mode;

use super::axis::{MAX_MODES, Oscillator};
use super::error::SimulationError;
use super::robot::{Damping, ModeOfJoint, Robot};

/// Deviations of a simulation from the robot's description.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulationOptions {
    /// Seed of the tracker's noise and phase.
    pub seed: u64,
    /// Point mass at the tip, kg.
    pub payload: f64,
    /// Pose to start from, rad; home if absent.
    pub pose: Option<Vec<f64>>,
    /// Standard deviation of each tracker coordinate, m.
    pub tracker_noise: Option<f64>,
    /// Instant of the tracker's first sample, s, from 0 to its period; drawn by the seed if absent.
    pub tracker_phase: Option<f64>,
    /// Damping convention of all modes.
    pub damping: Option<Damping>,
    /// First mode in the reference condition (home pose, no payload).
    pub mode: Option<Mode>,
    /// All modes in the reference condition; `mode` and `damping` apply to them too.
    pub modes: Option<Vec<ModeOfJoint>>,
}

/// The modes of `joint` as the options change them.
pub(super) fn oscillators(
    robot: &Robot,
    joint: usize,
    options: &SimulationOptions,
) -> Result<ArrayVec<Oscillator, MAX_MODES>, SimulationError> {
    let described = robot
        .joints
        .get(joint)
        .map_or(&[][..], |entry| &entry.modes);
    let modes = options.modes.as_deref().unwrap_or(described);
    let mut oscillators = ArrayVec::new();
    for (index, entry) in modes.iter().enumerate() {
        let overridden = options.mode.filter(|_| index == 0);
        let oscillator = Oscillator {
            mode: overridden.unwrap_or(entry.mode),
            damping: options.damping.unwrap_or(entry.damping),
            participation: entry.participation,
        };
        oscillators
            .try_push(oscillator)
            .map_err(|_| SimulationError::Option {
                name: "modes",
                value: modes.len() as f64,
                expected: "at most 4",
            })?;
    }
    Ok(oscillators)
}

/// An option that is a finite number, 0 or more.
pub(super) fn not_negative(name: &'static str, value: f64) -> Result<f64, SimulationError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(SimulationError::Option {
        name,
        value,
        expected: "a finite number, 0 or more",
    })
}
