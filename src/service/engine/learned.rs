//! What was learned of a joint, as the engine knows it.

use std::sync::Arc;

use crate::service::contract::{JointMap, LearningView};
use crate::service::tick::Train;

/// What stands in the place of a rule's name where a plan was made within a tolerance.
pub const WITHIN: &str = "tolerance";

/// What was learned of a joint.
#[derive(Default)]
pub struct Learning {
    /// Modes that the learner knows.
    pub modes: usize,
    /// What is told of them.
    pub view: LearningView,
    /// Their map.
    pub map: Arc<JointMap>,
    /// The train that was solved last; none where another one is to stand.
    pub solved: Option<Train>,
    /// Until when the order of this ticket waits for its train, s.
    pub waits: Option<(u64, f64)>,
    /// The plan in motion whose train is being solved.
    pub turn: Option<Turn>,
    /// When the plan in motion was looked at last along its way, s.
    pub looked: f64,
    /// The last plan that was given the train that was solved for it.
    pub prescribed: Option<u64>,
}

/// A plan that began in motion, and whose train is being solved meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Number of the question.
    pub asked: u64,
    /// Number of the plan.
    pub plan: u64,
}
