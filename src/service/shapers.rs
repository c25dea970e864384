//! The shapers of the service: those of positive impulses.
//!
//! A joint must be able to stop or turn at any instant. A train of positive amplitudes sends a mean of what was
//! planned: whatever is planned next, the command keeps the plan's limits and stays where the plan goes. A train
//! with negative impulses does so only on the plan that it was checked with.

use quell_shapers::{SHAPERS, Shaper};

/// What a shaper of the service is, for those that are refused.
pub const POSITIVE: &str = "a shaper of positive impulses: with negative ones a command that stops or turns exceeds its limits";

/// All of them.
pub fn shapers() -> impl Iterator<Item = &'static dyn Shaper> {
    SHAPERS.iter().copied().filter(|shaper| shaper.is_convex())
}

/// Their names.
pub fn names() -> Vec<&'static str> {
    shapers().map(|shaper| shaper.name()).collect()
}
