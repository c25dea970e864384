//! Candidates of a search: effects at places, and where their fits may start.

use super::point::{EffectAt, Point};

/// Explanations from another look at the same recordings.
#[derive(Clone, Default)]
pub struct Known {
    /// Where they ended.
    pub points: Vec<Point>,
    /// Whether only these are to be looked at.
    pub alone: bool,
}

/// An effect at a place, and where its fit may start.
pub struct Candidate {
    /// The effect and its place.
    pub effect: EffectAt,
    /// Starts at or near the explanation that it extends.
    pub near: Vec<Point>,
    /// Starts elsewhere.
    pub far: Vec<Point>,
}
