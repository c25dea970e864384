//! Candidates of a search: effects at places, and where their fits may start.

use super::point::{EffectAt, Point};
use super::stop::Stop;

/// Explanations that were looked at elsewhere.
#[derive(Clone, Default)]
pub struct Known {
    /// Where they ended.
    pub points: Vec<Point>,
    /// Whether nothing else is to be looked at.
    pub alone: bool,
    /// Ends the search, not the diagnosis.
    pub enough: Stop,
}

/// An effect at a place, and where its fit may start.
pub struct Candidate {
    /// Which, and where.
    pub effect: EffectAt,
    /// Starts at the explanation that it extends, or near it.
    pub near: Vec<Point>,
    /// Starts elsewhere.
    pub far: Vec<Point>,
}
