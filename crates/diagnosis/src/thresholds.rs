//! Numbers that several steps of the search share, each with its source.

/// Cost of two unknowns more for the start of a recording: "very strong" evidence (Kass and Raftery, J.
/// American Statistical Association 90 (1995)).
pub const STRONG: f64 = 10.0;
/// Fall of the log predictive density of held-out rows that chance may cause: such odds are "not worth more
/// than a bare mention" (Kass and Raftery 1995).
pub const BARE_MENTION: f64 = 1.0;
/// Chi-squared per row up to which a residual is noise: the noise level is known within a tenth.
pub const FLOOR: f64 = 1.21;
/// Chi-squared per row up to which noise is the larger part of what is left.
pub const MOSTLY_NOISE: f64 = 2.0;
/// Most steps of a fit to convergence.
pub const LONG: usize = 100;
/// Most terms in one explanation: as many as a search of minutes can separate.
pub const MOST_EFFECTS: usize = 6;
/// Structures of each number of effects that are extended. If two effects mask each other, the first of them
/// may not be the best single one.
pub const BEAM: usize = 2;
/// Ratio of costs beyond which a fit is given up, relative to the start of a continuation, the fit ahead, or a
/// simpler model: twice the residual.
pub const LOST: f64 = 4.0;
/// Number of a candidate's starts that continue after a few steps.
pub const SECOND: usize = 2;
/// Steps after which the best of these is chosen.
pub const SHORT: usize = 6;
/// Share of the probability that the credible set holds. The widths of priors are known only within a factor of
/// a few.
pub const CREDIBLE: f64 = 0.99;

/// Least log evidence of an explanation of the credible set, by that of the most probable one.
pub fn least_credible(highest: f64) -> f64 {
    highest + (1.0 - CREDIBLE).ln()
}
