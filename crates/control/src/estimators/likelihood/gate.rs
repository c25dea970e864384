//! Samples that are no measurement of the vibration.

use super::Likelihood;
use crate::estimators::modal_response::{RESIDUAL, WIDTH};

/// Evidence above which a sample is a spike: noise is five standard deviations away once in two million
/// samples.
const SPIKE: f64 = 25.0;
/// Spikes in a row: where one sample in a hundred is one, a third comes once in a million. What goes on
/// for longer is a change of the joint, and is believed.
const LONGEST: u32 = 2;

impl Likelihood {
    /// Whether a row is refused as a spike, which counts those in a row: it lies where neither the noise nor
    /// the doubt about the mode can have put it.
    fn refuses(&mut self, row: &[f64; WIDTH]) -> bool {
        let Some(fit) = self.fit.as_ref().filter(|_| self.knows_noise()) else {
            return false;
        };
        let innovation: f64 = fit.residual.iter().zip(row).map(|(w, x)| w * x).sum();
        let square = innovation * innovation;
        // The doubt only widens: most samples need no more than this.
        let outside = self.is_evident(square, SPIKE)
            && self.is_evident(square / (1.0 + fit.doubt(row)), SPIKE);
        self.outside = if outside { self.outside + 1 } else { 0 };
        outside && self.outside <= LONGEST
    }

    /// Takes the youngest sample into the active track; of a spike only the input is kept.
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
            // Nor does it say anything of the noise's colour.
            self.active.row[RESIDUAL] = f64::NAN;
        }
    }
}
