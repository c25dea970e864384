//! Models of an axis: what an engineer believes, as a file, and its simulation.
//!
//! A model is a [`Kind`] with values for its keys, and any number of effects of the catalogue.

pub mod chain;
mod file;
mod flexible_joint;
mod integrate;
mod kind;
mod oscillator;
mod piecewise;
mod rigid_axis;
mod trace;
mod two_mass;

pub use file::ModelError;
pub use integrate::{Kick, Timed, integrate};
pub use kind::{KINDS, Key, Kind};
pub use piecewise::{Cubic, Grid, Hold};
pub use trace::{Kinematics, Trace, hermite};

use crate::effects::{Effect, Place};

/// One number of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The number, in the key's unit.
    pub value: f64,
    /// Standard deviation that the file gives.
    pub std: Option<f64>,
    /// Bounds that the file gives.
    pub bounds: Option<(f64, f64)>,
    /// Not to be fitted.
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
    /// What it is.
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
    /// What the input does between samples, if the file says it.
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
}
