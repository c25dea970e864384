//! Simpler laws in place of those that contain them as limits. Two examples: the weight of a load on an axis that
//! hardly turns is a constant force, and a mode far above the motion is a gain of the deformation.

use super::explanation::Explanation;
use super::point::Point;
use super::problem::Problem;
use super::search::Search;
use super::thresholds::least_credible;
use quell_model::Term;
use quell_model::effects::{Effect, ParameterRole, Place};

impl Search<'_> {
    /// Points in which a simpler law replaces a term that contains it, each at the best size of its grid.
    pub fn limits_of(&self, point: &Point, term: usize) -> Vec<Point> {
        let own = &point.terms[term];
        let limits = own.effect.limits().filter_map(|simpler| {
            let place = place_of(self.problem, simpler, own.place)?;
            Some((simpler, place))
        });
        let (places, _) = self.problem.places();
        let far = own.effect.far_limits().filter_map(|simpler| {
            let place = simpler.places.iter().find(|own| places.contains(own))?;
            Some((simpler, *place))
        });
        let simpler = limits.chain(far);
        let new = simpler.filter(|own| point.without(term).has_room_for(*own));
        new.filter_map(|own| self.best_of_grid(point, term, own))
            .collect()
    }

    /// Ranked explanations in the order in which they may be told. Where the data say nothing of the shape of a law, the simpler law
    /// that it contains says as much, and comes first if it is in the credible set.
    pub fn simpler_first(
        &self,
        ranked: &[(&Explanation, f64)],
        temperature: f64,
    ) -> Vec<Explanation> {
        let mut order = Vec::new();
        for &(own, log) in ranked {
            let limits = self.limits_of_unknown_shape(own, temperature);
            let simpler = ranked.iter().filter(|other| {
                let is_limit = limits.iter().any(|limit| other.0.has_structure_of(limit));
                is_limit && other.1 > least_credible(log)
            });
            order.extend(simpler.map(|other| other.0.clone()));
            order.push(own.clone());
        }
        order
    }

    /// Points with a simpler law in the place of one of unknown shape that contains it; its values are still those of the latter.
    fn limits_of_unknown_shape(&self, own: &Explanation, temperature: f64) -> Vec<Point> {
        let unknown = self.problem.unknown(own, temperature).into_iter();
        let shapeless = unknown.filter(|(_, role)| *role == ParameterRole::Shape);
        let with_limits = shapeless.flat_map(|(term, _)| {
            let (effect, place) = own.fitted.point.terms[term].identity();
            effect.limits().filter_map(move |limit| {
                let mut point = own.fitted.point.clone();
                point.terms[term].place = place_of(self.problem, limit, place)?;
                point.terms[term].effect = limit;
                Some(point)
            })
        });
        with_limits.collect()
    }

    fn best_of_grid(
        &self,
        point: &Point,
        term: usize,
        (effect, place): (&'static Effect, Place),
    ) -> Option<Point> {
        let with = |values| {
            let mut next = point.clone();
            let recording = point.terms[term].recording;
            next.terms[term] = Term::new(effect, place, values).in_recording(recording);
            let cost = self.problem.evaluate(&next, self.projector).cost;
            (cost, next)
        };
        let grid = (effect.starts)(&self.problem.scales);
        let best = grid.into_iter().map(with);
        let best = best.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, next)| next)
    }
}

/// The place of an effect at which it acts between the same bodies as another effect; `None` if there is none.
fn place_of(problem: &Problem, effect: &Effect, place: Place) -> Option<Place> {
    let (places, linear) = problem.places();
    let same = |own: &Place| {
        *own == place || places.contains(own) && linear.attachment(*own) == linear.attachment(place)
    };
    effect.places.iter().copied().find(same)
}
