//! Numbers that several steps of the search share, each with where it comes from.

/// Price of two needless unknowns of how a recording starts: "very strong" evidence (Kass and Raftery, J. American
/// Statistical Association 90 (1995)).
pub const STRONG: f64 = 10.0;
/// Chi-squared per row up to which a residual is noise: its level is known within a tenth.
pub const FLOOR: f64 = 1.21;
/// Most steps of the fit that is carried through.
pub const LONG: usize = 100;
/// Most terms in one explanation: what a search of minutes can tell apart.
pub const MOST_EFFECTS: usize = 6;
/// Structures of as many effects that are extended: the first effect of two that mask each other may not be the best
/// single one.
pub const BEAM: usize = 2;
/// Cost over that of the start of a continuation, of the fit ahead, or of a simpler model, from which one has gone too
/// far: twice the residual.
pub const LOST: f64 = 4.0;
/// How many of a candidate's starts go on after a few steps.
pub const SECOND: usize = 2;
/// Steps after which the best of these is chosen.
pub const SHORT: usize = 6;
