//! Controller and simulated arm in a loop: commissioning, moves, and the comparison of moves.

mod cell;
mod commissioning;
mod comparison;
mod error;
mod trace;

pub use cell::{Cell, CellSettings};
pub use commissioning::commission;
pub use comparison::{Comparison, MoveKind, Scenario};
pub use error::ClosedLoopError;
pub use trace::{MoveTrace, Tick};
