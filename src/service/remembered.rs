//! How much of a command is remembered, and what that bounds: moves, trains, and the periods of modes.

/// Longest move with a correction, s; sizes the memory of the sent command.
pub const LONGEST_MOVE: f64 = 20.0;
/// Longest train, in periods of the believed mode: as in the simulation.
pub const LONGEST_TRAIN: f64 = 4.0;
/// Longest period of a believed mode, s: its longest train is as long as what is remembered.
pub const LONGEST_PERIOD: f64 = LONGEST_MOVE / LONGEST_TRAIN;
