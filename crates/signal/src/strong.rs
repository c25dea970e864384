//! Where evidence is very strong.

/// Difference of the Bayesian information criterion that is very strong evidence: odds of `e^5`, 150 to 1.
///
/// Source: R. E. Kass and A. E. Raftery, Bayes factors, J. American Statistical Association 90 (1995), section 3.2.
pub const STRONG: f64 = 10.0;
