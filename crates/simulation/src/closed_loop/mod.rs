//! Controller and simulated arm in a loop: commissioning, moves of one joint and of several on a path, and the
//! comparison of moves.

mod cell;
mod commissioning;
mod comparison;
mod error;
mod path;
mod path_trace;
mod side_by_side;
mod trace;

pub use cell::{Cell, CellSettings};
pub use commissioning::commission;
pub use comparison::{Comparison, MoveKind, Scenario};
pub use error::ClosedLoopError;
pub use path::{PathComparison, PathJoint, PathKind, PathScenario};
pub use path_trace::PathTrace;
pub use trace::{MoveTrace, Tick};
