//! A grid of starts beside the active track, until no other start can explain the data.

use super::fit::profile;
use super::{Likelihood, RULED_OUT, USABLE};

impl Likelihood {
    /// Moves to the start of the grid that explains the data best.
    pub(super) fn search_grid(&mut self) {
        let folding = self.folding();
        for track in &mut self.grid {
            track.absorb(&self.window, &folding);
        }
        let Some(active) = &self.fit else { return };
        let mut best = None;
        let mut best_cost = active.cost;
        let mut second = f64::INFINITY;
        for (index, track) in self.grid.iter().enumerate() {
            let Some(cost) = profile(track, &folding.priors, self.noise.variance) else {
                continue;
            };
            second = second.min(cost);
            if cost < best_cost {
                best_cost = cost;
                best = Some(index);
            }
        }
        if let Some(index) = best {
            self.active = self.grid[index];
            self.candidate = None;
            self.shrink = 1.0;
            self.refit();
        } else if self.is_evident(second - active.cost_after, RULED_OUT) {
            self.locked = self.spread(active)[0] < 0.25 * USABLE;
        }
    }
}
