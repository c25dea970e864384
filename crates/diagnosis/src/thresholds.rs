//! Thresholds that several steps of the search share, each with where it comes from.

/// Bayesian information criterion by which an effect must be better to be named: 10 is "very strong"
/// (Kass and Raftery, J. American Statistical Association 90 (1995)).
pub const STRONG: f64 = 10.0;
/// Held-out chi-squared of an effect over that without it, above which it is not believed.
pub const GATE: f64 = 0.98;
/// Explanations within this of the best cannot be told from it.
pub const EQUAL: f64 = 15.0;
/// Chi-squared per row up to which a residual is noise: its level is known within a tenth.
pub const FLOOR: f64 = 1.21;
/// Most steps of the fit that is carried through.
pub const LONG: usize = 100;
/// Most effects in one explanation: with three the structure is no longer determined by a recording.
pub const MOST_EFFECTS: usize = 2;
/// Share of the mismatch that may be left: no law of a catalogue has nature's shape to better than a
/// tenth in amplitude (friction is regular, contact compliant), a hundredth in energy.
pub const SHAPE: f64 = 0.01;
/// Cost over that of the start of a continuation, or of the fit ahead, from which a fit has gone too far: twice the
/// residual.
pub const LOST: f64 = 4.0;
/// How many of a candidate's starts go on after a few steps.
pub const SECOND: usize = 2;
/// Steps after which the best of these is chosen.
pub const SHORT: usize = 6;
