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

/// Hops of each width.
const EACH: usize = 4;
/// Steps of the descent after a hop: as many as a candidate makes before its best start is chosen.
const STEPS: usize = 6;
/// Widths of the hops in turn, in standard deviations of the unknowns: from the scatter that noise causes to a
/// scale at which a single local minimum is small.
const WIDTHS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

impl Descent<'_> {
    /// Hops around the present point, from a fixed seed, and stays where the cost is least.
    pub fn hop(&mut self) {
        let mut random = ChaCha12Rng::seed_from_u64(1);
        for width in WIDTHS.repeat(EACH) {
            if self.is_cut() {
                return;
            }
            let Some(step) = self.drawn(width, &mut random) else {
                return;
            };
            let mut next = self.stepped(&step);
            next.run_against(STEPS, self.cost());
            if next.cost() < self.cost() {
                *self = next;
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
