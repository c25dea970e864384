//! One law of the catalogue in the place of two. A search that adds laws one by one finds Coulomb friction and a constant force
//! where the friction of the two directions differs.

use super::point::Point;
use super::pool::Pool;
use super::search::Search;

impl Search<'_> {
    /// If only noise is left, extends the best explanation without each two of its effects that act at the same place, while
    /// the search is not over. Returns whether there is a better explanation.
    pub fn join(&self, pool: &mut Pool) -> bool {
        let best = pool.best(self.judge).clone();
        if !self.leaves_noise(&best) {
            return false;
        }
        for kept in without_two(&best.fitted.point) {
            self.extend_part(pool, &kept);
        }
        !pool.best(self.judge).is_like(&best)
    }
}

/// A point without each two of its added terms that are at the same place.
fn without_two(point: &Point) -> Vec<Point> {
    let added = point.given_terms..point.terms.len();
    let pairs = added.flat_map(|two| (point.given_terms..two).map(move |one| (one, two)));
    let same = pairs.filter(|&(one, two)| point.terms[one].place == point.terms[two].place);
    same.map(|(one, two)| point.without(two).without(one))
        .collect()
}
