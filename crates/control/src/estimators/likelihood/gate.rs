//! Rejection of spikes: samples that are no measurement of the vibration.

use super::Likelihood;
use crate::estimators::modal_response::{RESIDUAL, WIDTH};

/// Evidence above which a sample is a spike: noise is five standard deviations away once in two million
/// samples.
const SPIKE: f64 = 25.0;
/// Longest run of spikes. If one sample in a hundred is a spike, a third in a row comes once in a million. A
/// longer run is a change of the joint, and is accepted.
const LONGEST: u32 = 2;

impl Likelihood {
    /// Whether a row is rejected as a spike, which also counts runs: neither the noise nor the uncertainty of
    /// the mode explains its distance.
    fn refuses(&mut self, row: &[f64; WIDTH]) -> bool {
        let Some(fit) = self.fit.as_ref().filter(|_| self.knows_noise()) else {
            return false;
        };
        let innovation: f64 = fit.residual.iter().zip(row).map(|(w, x)| w * x).sum();
        let square = innovation * innovation;
        // The uncertainty of the mode only widens the limit: most samples pass this test already.
        let outside = self.is_evident(square, SPIKE)
            && self.is_evident(square / (1.0 + fit.doubt(row)), SPIKE);
        self.outside = if outside { self.outside + 1 } else { 0 };
        outside && self.outside <= LONGEST
    }

    /// Adds the youngest sample to the active track; of a spike only the input is used.
    pub(super) fn take_youngest(&mut self) {
        let folding = self.folding();
        let Some(&sample) = self.active.approach(&self.window, &folding) else {
            return;
        };
        let row = self.active.row;
        if !self.refuses(&row) {
            self.active.take(&sample);
            self.largest = self.largest.max(sample.deformation.abs());
        } else {
            self.window.refuse_youngest();
            // It does not count for the noise's colour either.
            self.active.row[RESIDUAL] = f64::NAN;
        }
    }
}
