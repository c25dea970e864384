//! Basin hopping: further descents from points around the end of a descent, for laws whose misfit has many
//! minima.
//!
//! As an effect's size changes, contacts come and go. Each makes a local minimum in the misfit, so that a
//! descent may end beside the global one. These minima lie within the bowl that the normal matrix describes. So
//! starts are drawn from a normal distribution of its shape, near and far in turn, around the best end so far.
//!
//! Source: Wales and Doye, J. Physical Chemistry A 101 (1997); Leary, J. Global Optimization 18 (2000), for
//! hops that only go down.

use super::descent::Descent;
use super::normal::{covariance, scales};
use nalgebra::{Cholesky, DVector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha12Rng;
use rand_distr::StandardNormal;

/// Rounds of hops.
const ROUNDS: usize = 4;
/// Steps of the descent after a hop: as many as a candidate makes before its best start is chosen.
const STEPS: usize = 6;
/// Widths of the hops in turn, in standard deviations of the unknowns: from the scatter that noise causes to a
/// scale at which a single local minimum is small.
const WIDTHS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

impl Descent<'_> {
    /// Hops around the present point, from a fixed seed, and stays where the cost is least. A round has a hop of each width.
    /// Where a rival is ahead, no further round follows one that gained so little that all the rest would not reach it.
    pub fn hop(&mut self, rival: f64) {
        let mut random = ChaCha12Rng::seed_from_u64(1);
        for left in (0..ROUNDS).rev() {
            let before = self.cost();
            for width in WIDTHS {
                let step = self.drawn(width, &mut random);
                let Some(step) = step.filter(|_| !self.is_cut()) else {
                    return;
                };
                let mut next = self.stepped(&step);
                next.run_against(STEPS, self.cost());
                if next.cost() < self.cost() {
                    *self = next;
                }
            }
            let fall = before - self.cost();
            if fall * (left as f64) < self.cost() - rival {
                return;
            }
        }
    }

    /// A step in the shape of the bowl.
    fn drawn(&self, width: f64, random: &mut impl Rng) -> Option<DVector<f64>> {
        let normal = self.normal();
        let scale = scales(&normal);
        let root = Cholesky::new(covariance(&normal, &scale)?)?.l();
        let count = normal.nrows();
        let draw = DVector::from_fn(count, |_, _| random.sample::<f64, _>(StandardNormal));
        let step = (root * draw).component_div(&scale) * width;
        // An unknown without any effect is not moved.
        let stays = |step, own| if own > 0.0 { step } else { 0.0 };
        Some(step.zip_map(&normal.diagonal(), stays))
    }
}
