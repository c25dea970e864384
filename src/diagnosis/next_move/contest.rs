//! The best explanation against its equals, over all experiments that may be proposed.

use super::SEPARATES;
use super::distance::{Rival, predicted};
use super::ideas::Idea;
use super::payload::Payload;
use crate::diagnosis::problem::{Point, Problem};
use crate::model::Experiment;
use rayon::prelude::*;

/// Ideas that are fitted after the linear estimate.
const REFINED: usize = 4;

/// The best explanation, its equals, and the ideas.
pub struct Contest<'a> {
    /// The recordings as the best explanation would have them.
    pub problem: &'a Problem<'a>,
    /// Where its fit ended.
    pub best: &'a Point,
    /// Its equals, the nearest first.
    pub rivals: Vec<Rival<'a>>,
    /// What may be proposed.
    pub ideas: &'a [Idea],
    /// Chi-squared per row that the best explanation leaves: the unit of evidence.
    pub unit: f64,
}

impl Contest<'_> {
    /// The idea whose least distance is the largest, among those of the first `count` rivals that any
    /// idea separates; of the nearest rival where none does. And its distance from each of them.
    pub fn winner(&self, payload: Payload, count: usize) -> Option<(&Idea, Vec<f64>)> {
        let rivals = &self.rivals[..count];
        let told = |idea: &Idea, measure: &(dyn Fn(&Rival, &Experiment) -> f64 + Sync)| {
            let experiment = predicted(&idea.experiment, self.problem, self.best, payload);
            let distances = rivals
                .iter()
                .map(|rival| measure(rival, &experiment) / self.unit);
            distances.collect::<Vec<f64>>()
        };
        let estimate = |rival: &Rival, e: &Experiment| rival.estimate(e, self.best, payload);
        let mut rows: Vec<(&Idea, Vec<f64>)> = self
            .ideas
            .par_iter()
            .map(|idea| (idea, told(idea, &estimate)))
            .collect();
        let separable = |k: &usize| rows.iter().any(|row| row.1[*k] >= SEPARATES);
        let mut active: Vec<usize> = (0..count).filter(separable).collect();
        if active.is_empty() {
            active.push(0);
        }
        let least = |row: &[f64]| active.iter().map(|&k| row[k]).fold(f64::INFINITY, f64::min);
        rows.sort_by(|a, b| least(&b.1).total_cmp(&least(&a.1)));
        rows.truncate(REFINED);
        let apart = |rival: &Rival, e: &Experiment| rival.apart(e, self.best, payload);
        let refined = rows.into_par_iter();
        let refined: Vec<_> = refined.map(|row| (row.0, told(row.0, &apart))).collect();
        let order =
            |a: &(&Idea, Vec<f64>), b: &(&Idea, Vec<f64>)| least(&a.1).total_cmp(&least(&b.1));
        refined.into_iter().max_by(order)
    }

    /// The distance of an idea from each rival, recordings and experiment fitted together.
    pub fn together(&self, idea: &Idea) -> Vec<f64> {
        let experiment = predicted(&idea.experiment, self.problem, self.best, Payload::NONE);
        let rivals = self.rivals.par_iter();
        let apart = rivals.map(|rival| rival.together(&experiment, self.best) / self.unit);
        apart.collect()
    }
}
