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

impl Known {
    /// Whether one of them is this structure and an effect more.
    pub fn extends(&self, from: &Point, effect: EffectAt) -> bool {
        let with = self.points.iter();
        let mut with = with.filter(|own| own.effects().contains(&effect));
        with.any(|own| own.without_effect(effect).structure() == from.structure())
    }
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
