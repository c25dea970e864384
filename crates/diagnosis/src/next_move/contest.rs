//! The best explanation against its equals, over all experiments that may be proposed.

use super::SEPARATES;
use super::distance::Rival;
use super::ideas::{Idea, Ideas};
use super::information::Information;
use super::payload::Payload;
use rayon::prelude::*;

/// The rivals and the parts of experiments.
pub struct Contest<'a> {
    /// The best explanation's equals, the nearest first.
    pub rivals: Vec<Rival<'a>>,
    /// Parts of an experiment.
    pub ideas: &'a Ideas<'a>,
    /// Temperature of the evidence: the chi-squared that counts as one.
    pub unit: f64,
}

/// A sequence of ideas.
pub struct Plan {
    /// Indices of the ideas.
    pub ideas: Vec<usize>,
    /// `T` of each rival, linear in the unknowns.
    pub apart: Vec<f64>,
    /// Their information about each rival's unknowns.
    said: Vec<Information>,
}

/// Factor that a part must add to the distance of those before it, to be worth its time.
const WORTH: f64 = 1.1;

impl Contest<'_> {
    /// A greedy choice of parts. Each part maximises the least distance over those of the first `count` rivals
    /// that one more part can separate. If none can be separated, it maximises the distance of the farthest
    /// rival.
    ///
    /// The information of the parts adds, since each starts at rest where the one before has ended.
    pub fn plan(&self, payload: Payload, count: usize) -> Option<Plan> {
        let rivals = &self.rivals[..count];
        let said = |idea: &Idea| -> Vec<Information> {
            let said = |rival: &Rival| rival.information(&idea.experiment, payload);
            rivals.iter().map(said).collect()
        };
        let said: Vec<_> = self.ideas.all.par_iter().map(said).collect();
        let mut plan: Option<Plan> = None;
        loop {
            let longer =
                (0..said.len()).filter_map(|part| self.longer(plan.as_ref(), part, &said[part]));
            let longer: Vec<Plan> = longer.collect();
            let separable = |k: &usize| longer.iter().any(|plan| plan.apart[*k] >= SEPARATES);
            let mut active: Vec<usize> = (0..count).filter(separable).collect();
            if active.is_empty() {
                let farthest = |k: usize| {
                    let apart = longer.iter().map(|plan| plan.apart[k]);
                    apart.fold(0.0, f64::max)
                };
                let all = (0..count).rev();
                active.extend(all.max_by(|a, b| farthest(*a).total_cmp(&farthest(*b))));
            }
            let least = |plan: &Plan| {
                let apart = active.iter().map(|&k| plan.apart[k]);
                apart.fold(f64::INFINITY, f64::min)
            };
            let best = longer
                .into_iter()
                .max_by(|a, b| least(a).total_cmp(&least(b)));
            match (best, plan) {
                (Some(best), Some(plan)) if least(&best) < WORTH * least(&plan) => {
                    return Some(plan);
                }
                (Some(best), _) => plan = Some(best),
                (None, plan) => return plan,
            }
        }
    }

    /// A plan with one more part; `None` if it gets too long.
    fn longer(&self, plan: Option<&Plan>, part: usize, said: &[Information]) -> Option<Plan> {
        let (ideas, said) = match plan {
            None => (vec![part], said.to_vec()),
            Some(plan) => (
                [plan.ideas.as_slice(), &[part]].concat(),
                plan.said.iter().zip(said).map(|(a, b)| a + b).collect(),
            ),
        };
        let parts = || ideas.iter().map(|&idea| &self.ideas.all[idea]);
        let most = self.ideas.most_moves;
        let moves: usize = parts().map(|idea| idea.moves(most)).sum();
        let duration: f64 = parts().map(Idea::duration).sum();
        let fits = moves <= most && duration <= self.ideas.longest;
        let apart = self.rivals.iter().zip(&said);
        let apart = apart.map(|(rival, said)| rival.estimate(said) / self.unit);
        let apart = apart.collect();
        fits.then_some(Plan { ideas, apart, said })
    }

    /// The distance of an experiment from each rival, recordings and experiment fitted together.
    pub fn together(&self, idea: &Idea) -> Vec<f64> {
        let rivals = self.rivals.par_iter();
        let apart = rivals.map(|rival| rival.together(&idea.experiment) / self.unit);
        apart.collect()
    }
}
