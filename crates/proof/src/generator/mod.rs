//! A generator of concealed cases: recordings of machines in which something is hidden.
//!
//! Its dynamics are its own, down to the friction: bodies, springs and surfaces, integrated in fine
//! steps that end where something sticks, slips or touches. It shares no equation of motion with the
//! models that are fitted to its recordings.
//!
//! Effects that no fit can see are not hidden: an offset of the clocks and a delay of sensor or drive (each fit
//! has a free clock offset), and faults of the drive if the motor side is measured.
//!
//! The same seed and index give the same case, to the bit.

mod axis;
mod axis_case;
mod axis_effects;
mod axis_laws;
mod axis_refit;
mod gauss_newton;
mod hidden;
mod integrate;
mod joint;
mod joint_case;
mod laws;
mod moving;
mod plan;
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

use super::kind::Kind;
use super::truth::Truth;
use quell_recording::Recording;
use quell_trajectories::PlanError;
use random::Draw;

/// What is recorded beside the motor side.
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
    /// What was hidden.
    pub truth: Truth,
    oracle: Oracle,
}

/// What the true machine shows on the test's clock without noise.
#[derive(Clone, Debug)]
enum Oracle {
    Joint(Box<recorded::TrueTest>),
    Axis { predicted: Vec<f64> },
}

/// The share of driven axes (force in, position out).
const AXES: f64 = 0.15;

/// The case of this seed and index, of a kind that is drawn: a fifth hides nothing, half one effect, one in seven
/// two, one in seven something outside the catalogue.
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
    drawn_again(seed, index, None, ATTEMPTS)
}

/// The case of this kind, seed and index: machines are drawn until one can show all effects that it is to hide.
///
/// # Errors
/// [`PlanError`] where a move cannot be planned.
///
/// # Example
/// ```
/// use quell_proof::{Kind, generate_kind};
///
/// let case = generate_kind(Kind::Pair, 1, 0)?;
/// assert_eq!(Kind::of(&case.truth), Kind::Pair);
/// # Ok::<(), quell_trajectories::PlanError>(())
/// ```
pub fn generate_kind(kind: Kind, seed: u64, index: u64) -> Result<Case, PlanError> {
    drawn_again(seed, index, Some(kind), SEARCH)
}

/// Draws after which a machine that runs away is no longer drawn again.
const ATTEMPTS: u64 = 8;
/// Number of draws after which a machine may show fewer effects: one draw in three shows six.
const SEARCH: u64 = 64;

fn drawn_again(
    seed: u64,
    index: u64,
    kind: Option<Kind>,
    attempts: u64,
) -> Result<Case, PlanError> {
    let mut attempt = 0;
    loop {
        let mut draw = Draw::new(seed, index + (attempt << 32));
        let case = if draw.chance(AXES) {
            axis_case::generate(&mut draw, kind)?
        } else {
            joint_case::generate(&mut draw, kind)?
        };
        attempt += 1;
        match case {
            Some(case) if case.is_finite() || attempt == attempts => return Ok(case),
            Some(_) => {}
            None if attempt == attempts => return drawn_again(seed, index, None, ATTEMPTS),
            None => {}
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
