//! A look several effects ahead, if no single effect raises the evidence. Effects may mask one another: each
//! one alone leaves the mismatch of the others and gains little, but all together leave only noise.
//!
//! The evidence of a mismatch of unknown cause is not known before its cause is. So structures are ranked ahead
//! as if only noise were left in the end. They are kept if one of them indeed leaves only noise, or if noise is most of what
//! one leaves and what was told before is no longer credible; they are forgotten otherwise.

use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::pool::Pool;
use super::screen::Table;
use super::search::{Search, next_to_learn};
use super::thresholds::{MOST_EFFECTS, MOSTLY_NOISE, least_credible};

impl Search<'_> {
    /// Adds structures of more effects than the best explanation to a pool if they tell more; at most once for a pool.
    /// Returns whether they do.
    pub fn look_ahead(&self, pool: &mut Pool) -> bool {
        if self.known.alone
            || self.leaves_noise(pool.best(self.judge))
            || std::mem::replace(&mut pool.looked_ahead, true)
        {
            return false;
        }
        let mut ahead = pool.clone();
        self.search_ahead(pool, &mut ahead);
        let tells_more =
            self.leaves_noise(ahead.best(self.judge)) || self.tells_more(pool, &mut ahead);
        if tells_more {
            ahead.is_unfinished = pool.is_unfinished;
            *pool = ahead;
        }
        tells_more
    }

    /// Adds structures to a pool ahead of another one, until one leaves only noise, or no further effect gains.
    fn search_ahead(&self, pool: &mut Pool, ahead: &mut Pool) {
        let best = Some(pool.best(self.judge)).filter(|own| own.terms() > 0 && !own.is_learned());
        for own in std::iter::once(pool.baseline()).chain(best) {
            self.pairs(own).into_iter().for_each(|pair| ahead.add(pair));
        }
        for count in 1..MOST_EFFECTS {
            let own = ahead.most_likely(count);
            for own in &own {
                if self.is_over() {
                    pool.is_unfinished = true;
                    return;
                }
                while let Some(part) = next_to_learn(ahead, own) {
                    self.add_extended(ahead, &part, Table::Learned);
                }
                if !ahead.is_extended(own, Table::Named) {
                    self.add_extended(ahead, own, Table::Named);
                }
            }
            let named = ahead.most_likely(count + 1);
            let mut next = named.iter().cloned().chain(ahead.most_likely_learned());
            if next.any(|own| self.judge.fits_to_noise(&own)) {
                // Nothing of the fitted rows is left in which a further effect could show.
                return self.refit_contradicted(ahead, |_| CALIBRATED);
            }
            if named.first().map(score) <= own.first().map(score) {
                return;
            }
        }
    }

    /// Whether noise is most of what a pool leaves, and what another one tells is not credible beside what it tells. Where a
    /// model's error is most of what is left, it decides between structures, and no evidence is decisive.
    fn tells_more(&self, pool: &mut Pool, ahead: &mut Pool) -> bool {
        if ahead.unit(self.judge) > MOSTLY_NOISE {
            return false;
        }
        let [less, more] = [self.told(pool).best, self.told(ahead).best];
        let temperature = ahead.temperature(self.judge);
        less.log_evidence(temperature) < least_credible(more.log_evidence(temperature))
    }
}

/// Log evidence of an explanation as if only noise were left in the end.
fn score(own: &Explanation) -> f64 {
    own.log_evidence(CALIBRATED)
}
