#![doc = include_str!("../README.md")]

mod attachment;
pub mod believed;
mod bodies;
pub mod chain;
mod circle;
mod coupling;
pub mod curves;
mod departure;
mod differentiated;
pub mod effects;
mod experiment;
mod file;
mod flexible_joint;
mod further_modes;
mod gain;
mod input_error;
mod integrate;
mod inverse_dynamics;
mod kind;
mod kinds;
mod known;
mod linear;
mod observation;
mod oscillator;
mod output;
mod piecewise;
mod predict;
mod reading;
mod regression;
mod rigid_axis;
mod roots;
mod runge_kutta;
mod smoothing;
mod start;
mod stepper;
mod tally;
mod tangent;
mod trace;
mod two_mass;
mod windows;

pub use attachment::Attachment;
pub use circle::Radius;
pub use coupling::Coupling;
pub use departure::{Departure, StartComponent};
pub use experiment::{Experiment, Output, Window};
pub use file::ModelError;
pub use further_modes::{FurtherModes, RESONANCES, Seen};
pub use gain::{Gain, unify as unify_gain};
pub use input_error::InputError;
pub use integrate::{Restart, Timed, integrate};
pub use kind::{Key, Kind, NO_RESONANCE};
pub use kinds::KINDS;
pub use known::Known;
pub use piecewise::{Cubic, Grid, Hold};
pub use predict::{Simulated, Term, predict_windows, see_motion, simulate, simulate_windows};
pub use reading::Prediction;
pub use tally::simulations;
pub use trace::{Kinematics, Trace, hermite};

use crate::effects::{Effect, Motion, Place};
use quell_recording::Role;
use quell_signal::SignalError;

/// Why a recording does not suit a model.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// No channel can drive the model.
    #[error("recording \"{recording}\" has no channel that drives a {kind}: one of {inputs}")]
    NoInput {
        /// Name of the recording.
        recording: String,
        /// Kind of the model.
        kind: &'static str,
        /// Roles that can drive it.
        inputs: String,
    },
    /// No channel is one that the model predicts.
    #[error("recording \"{recording}\" has no channel that a {kind} predicts: one of {outputs}")]
    NothingPredicted {
        /// Name of the recording.
        recording: String,
        /// Kind of the model.
        kind: &'static str,
        /// Roles that it predicts.
        outputs: String,
    },
    /// A known force or inertia in another unit than the model's equation.
    #[error(
        "{role} of \"{recording}\" is in {unit}; the model's equation takes {wanted}: convert it, or give the model the \
         constant between them (force_gain, torque_constant)"
    )]
    OtherUnit {
        /// Name of the recording.
        recording: String,
        /// The channel.
        role: Role,
        /// Its unit.
        unit: String,
        /// The unit that it should have.
        wanted: String,
    },
    /// A known force or inertia without the inertia at which the believed frequency holds.
    #[error(
        "\"{recording}\" has {role}, but the model does not say at which inertia its natural frequency holds: give it \
         link_inertia"
    )]
    NoLinkInertia {
        /// Name of the recording.
        recording: String,
        /// The channel.
        role: Role,
    },
    /// A known inertia for a model that has none.
    #[error(
        "\"{recording}\" has inertia, but a {kind} that is held in a motion has none: leave it out"
    )]
    NoInertia {
        /// Name of the recording.
        recording: String,
        /// Kind of the model.
        kind: &'static str,
    },
    /// An inertia of 0 or less.
    #[error("inertia of \"{recording}\" is {value} {unit} at {time} s; it must be above 0")]
    InertiaNotPositive {
        /// Name of the recording.
        recording: String,
        /// The stamp, s.
        time: f64,
        /// The value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Several columns of an accelerometer, in a motion that does not show how it is mounted.
    #[error(
        "{role} of \"{recording}\" has {columns} columns, and the motion does not show which direction in them is that of the tip: record more \
         motion, or give the one column along the tip's motion"
    )]
    NoTangent {
        /// Name of the recording.
        recording: String,
        /// The channel.
        role: Role,
        /// Number of its columns.
        columns: usize,
    },
    /// A channel is invalid, or a sensor's frame cannot be determined.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

/// One number of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The number, in the key's unit.
    pub value: f64,
    /// Standard deviation that the file gives.
    pub std: Option<f64>,
    /// Bounds that the file gives.
    pub bounds: Option<(f64, f64)>,
    /// Whether it is excluded from the fit.
    pub fixed: bool,
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self {
            value,
            std: None,
            bounds: None,
            fixed: false,
        }
    }
}

/// An effect in a model.
#[derive(Clone)]
pub struct ModelEffect {
    /// Its kind.
    pub effect: &'static Effect,
    /// Where it sits.
    pub place: Place,
    /// Its parameters, in the order of the catalogue.
    pub parameters: Vec<Value>,
}

/// A model of an axis.
#[derive(Clone)]
pub struct Model {
    /// Its structure.
    pub kind: &'static Kind,
    /// Values of the kind's keys, in their order.
    pub values: Vec<Value>,
    /// Which of the keys the file gives.
    pub given: Vec<bool>,
    /// The course of the input between samples, if the file says it.
    pub hold: Option<Hold>,
    /// Physics besides the linear chain.
    pub effects: Vec<ModelEffect>,
}

impl Model {
    /// Value of a key.
    pub fn value(&self, name: &str) -> Option<f64> {
        let index = self.kind.keys.iter().position(|key| key.name == name)?;
        Some(self.values[index].value)
    }

    /// Natural frequency, Hz, and damping ratio of the mode, where the kind has one.
    pub fn mode(&self) -> Option<(f64, f64)> {
        let (frequency, damping) = self.kind.mode?;
        Some((self.values[frequency].value, self.values[damping].value))
    }

    /// Fastest angular frequency of the linear chain, rad/s; the smallest number above 0 where it has
    /// no spring.
    pub fn fastest(&self) -> f64 {
        let linear = (self.kind.linear)(&self.keys(), self.kind.inputs[0]);
        let mut mobility = linear.link.map_or(0.0, |link| 1.0 / link.0);
        if let chain::MotorSide::Free { inertia, .. } = linear.motor {
            mobility += 1.0 / inertia;
        }
        (linear.stiffness * mobility).sqrt().max(f64::MIN_POSITIVE)
    }

    /// The model at rest, as the laws of its effects see it.
    pub fn still(&self) -> Motion {
        (self.kind.linear)(&self.keys(), self.kind.inputs[0]).at_rest()
    }

    /// Whether a channel of this role can drive the model with its present values.
    pub fn takes(&self, role: Role) -> bool {
        self.kind.inputs.contains(&role) && (self.kind.takes)(&self.keys(), role)
    }
}
