//! Simpler laws in place of those that contain them as limits. An example: the weight of a load on an axis that
//! hardly turns is a constant force.

use super::point::Point;
use super::problem::Problem;
use super::search::Search;
use quell_model::Term;
use quell_model::effects::{Effect, Place};

impl Search<'_> {
    /// Points in which a simpler law replaces a term that contains it, each at the best size of its grid.
    pub fn limits_of(&self, point: &Point, term: usize) -> Vec<Point> {
        let own = &point.terms[term];
        let there = own.effect.limits().filter_map(|simpler| {
            let place = place_of(self.problem, simpler, own.place)?;
            self.best_of_grid(point, term, (simpler, place))
        });
        there.collect()
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
