//! A look several effects ahead, if no single effect raises the evidence. Effects may mask one another: each
//! one alone leaves the mismatch of the others and gains little, but all together leave only noise.
//!
//! The evidence of a mismatch of unknown cause is not known before its cause is. So structures are ranked ahead
//! as if only noise were left in the end. They are kept if one of them indeed leaves only noise, and forgotten
//! otherwise.

use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::pool::Pool;
use super::screen::Table;
use super::search::Search;
use super::thresholds::MOST_EFFECTS;

impl Search<'_> {
    /// Adds structures of more effects than the best explanation to a pool if one of them leaves only noise; at
    /// most once for a pool. Returns whether there is one.
    pub fn look_ahead(&self, pool: &mut Pool) -> bool {
        if self.leaves_noise(pool.best(self.judge))
            || std::mem::replace(&mut pool.looked_ahead, true)
        {
            return false;
        }
        let mut ahead = pool.clone();
        let best = Some(pool.best(self.judge)).filter(|own| own.terms() > 0 && !own.is_learned());
        for own in std::iter::once(pool.baseline()).chain(best) {
            self.pairs(own).into_iter().for_each(|pair| ahead.add(pair));
        }
        for count in 1..MOST_EFFECTS {
            let own = ahead.most_likely(count);
            for own in &own {
                if self.is_over() {
                    pool.is_unfinished = true;
                    return false;
                }
                if !ahead.is_extended(own, Table::Named) {
                    self.add_extended(&mut ahead, own, Table::Named);
                }
            }
            let mut next = ahead.most_likely(count + 1);
            if next.iter().any(|own| self.judge.fits_to_noise(own)) {
                self.refit_doubtful(&mut ahead, |_| CALIBRATED);
                next = ahead.most_likely(count + 1);
            }
            if next.iter().any(|own| self.leaves_noise(own)) {
                *pool = ahead;
                return true;
            }
            let best = own.first().map(score);
            if next.first().map(score) <= best {
                return false;
            }
        }
        false
    }
}

/// Log evidence of an explanation as if only noise were left in the end.
fn score(own: &Explanation) -> f64 {
    own.log_evidence(CALIBRATED)
}
