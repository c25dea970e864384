//! A generator of concealed cases: recordings of machines in which something is hidden.
//!
//! Its dynamics are its own, down to the friction: bodies, springs and surfaces, integrated in fine
//! steps that end where something sticks, slips or touches. It shares no equation of motion with the
//! models that are fitted to its recordings.
//!
//! An effect that no fit can see is not hidden: an offset of the clocks and a delay of sensor or drive (each fit
//! takes an offset of the clocks for granted), faults of the drive where the motor side is measured.
//!
//! The same seed and index give the same case, to the bit.

mod axis;
mod axis_case;
mod axis_effects;
mod hidden;
mod integrate;
mod joint;
mod joint_case;
mod moving;
mod programme;
mod random;
mod recorded;
mod refit;
mod sensors;
mod size;
mod surfaces;
#[cfg(test)]
mod tests;

pub use size::SHARES;

use super::truth::Truth;
use quell_recording::Recording;
use quell_trajectories::PlanError;
use random::Draw;

/// The channel beside the motor side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// A tip sensor in a frame and on a clock of its own.
    Tip,
    /// An encoder on the link.
    Link,
    /// A strain gauge: link less motor side.
    Deformation,
}

/// One case: what the engineer believes, what was recorded, and what was hidden.
#[derive(Clone, Debug)]
pub struct Case {
    /// Text of the nominal `model.toml`.
    pub model: String,
    /// The recording to be diagnosed.
    pub train: Recording,
    /// Other moves of the same machine.
    pub test: Recording,
    /// The truth.
    pub truth: Truth,
    oracle: Oracle,
}

/// The readings of the true machine on the test's clock without noise.
#[derive(Clone, Debug)]
enum Oracle {
    Joint(Box<recorded::TrueTest>),
    Axis { predicted: Vec<f64> },
}

/// The share of driven axes (force in, position out).
const AXES: f64 = 0.15;

/// The case of this seed and index.
///
/// # Errors
/// [`PlanError`] where a move cannot be planned.
///
/// # Example
/// ```
/// let case = quell_proof::generate(1, 0)?;
/// assert_eq!(case.train, quell_proof::generate(1, 0)?.train);
/// # Ok::<(), quell_trajectories::PlanError>(())
/// ```
pub fn generate(seed: u64, index: u64) -> Result<Case, PlanError> {
    let mut case = attempt(seed, index)?;
    for again in 1..ATTEMPTS {
        if case.is_finite() {
            break;
        }
        case = attempt(seed, index + (again << 32))?;
    }
    Ok(case)
}

/// Draws after which a machine that runs away is no longer drawn again.
const ATTEMPTS: u64 = 8;

fn attempt(seed: u64, stream: u64) -> Result<Case, PlanError> {
    let mut draw = Draw::new(seed, stream);
    if draw.chance(AXES) {
        axis_case::generate(&mut draw)
    } else {
        joint_case::generate(&mut draw)
    }
}

/// The plan of a case, in numbers of hidden effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plan {
    Nothing,
    One,
    Two,
    Outside,
}

impl Plan {
    fn draw(draw: &mut Draw) -> Self {
        match draw.uniform(0.0, 1.0) {
            x if x < 0.20 => Self::Nothing,
            x if x < 0.72 => Self::One,
            x if x < 0.86 => Self::Two,
            _ => Self::Outside,
        }
    }

    /// How many effects, and whether a catalogue holds them.
    fn effects(self) -> (usize, bool) {
        match self {
            Self::Nothing => (0, true),
            Self::One => (1, true),
            Self::Two => (2, true),
            Self::Outside => (1, false),
        }
    }
}

impl Case {
    /// Whether all that was recorded is a number.
    fn is_finite(&self) -> bool {
        let channels = self.train.channels.iter().chain(&self.test.channels);
        let mut values = channels.flat_map(|channel| channel.columns.iter().flatten());
        values.all(|value| value.is_finite())
    }

    /// Rms over the noise on the test with the true machine, of which only the sensor's clock and frame
    /// are fitted: the floor that a diagnosis can reach.
    pub fn oracle(&self) -> f64 {
        match &self.oracle {
            Oracle::Joint(test) => test.rms_over_noise(&self.test),
            Oracle::Axis { predicted } => {
                let channel = self.test.channel(quell_recording::Role::MotorPosition);
                let seen = channel.map_or(&[][..], |channel| &channel.columns[0]);
                let squares = seen.iter().zip(predicted).map(|(a, b)| (a - b).powi(2));
                let mean = squares.sum::<f64>() / seen.len().max(1) as f64;
                mean.sqrt() / self.truth.noise
            }
        }
    }
}
