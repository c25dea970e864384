//! Learned modes of a joint, as the engine knows them.

use std::sync::Arc;

use crate::service::contract::{JointMap, LearningView};
use crate::service::tick::Train;

/// Replaces the shaper's name for a plan within a tolerance.
pub const WITHIN: &str = "tolerance";

/// What was learned of a joint.
#[derive(Default)]
pub struct Learning {
    /// Number of modes that the learner knows.
    pub modes: usize,
    /// Their view for clients.
    pub view: LearningView,
    /// Their map.
    pub map: Arc<JointMap>,
    /// The train that was solved last; `None` if another one is to be used.
    pub solved: Option<Train>,
    /// Ticket of an order that waits for its train, and the end of the wait, s.
    pub waits: Option<(u64, f64)>,
    /// The plan in motion whose train is being solved.
    pub turn: Option<Turn>,
    /// Time of the last evaluation of the plan in motion, s.
    pub looked: f64,
    /// The last plan that got the train solved for it.
    pub prescribed: Option<u64>,
}

/// A plan that began in motion while its train is being solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Number of the question.
    pub asked: u64,
    /// Number of the plan.
    pub plan: u64,
}
