//! One linearisation of the likelihood: a mode, its response and the moments of its rows.

use quell_shapers::Mode;

use super::fit::{Moments, Past, Priors, fold};
use super::walk::{Step, Walk};
use crate::estimators::Sample;
use crate::estimators::modal_response::{INPUT, ModalResponse, WIDTH};

/// One linearisation of the likelihood, run along the samples from the first one on.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    /// Where it is linearised.
    pub mode: Mode,
    /// The mode's response to the input so far.
    pub response: ModalResponse,
    /// Sums over the rows of the present stretch.
    pub moments: Moments,
    /// What past stretches say, when the vibration was set free again after them.
    pub past: Past,
    /// Whether there is any.
    pub has_past: bool,
    /// The last row.
    pub row: [f64; WIDTH],
    /// Its place in the window.
    pub walk: Walk,
    /// Sums of products of 1, the input and the deformation, of which an offset and a gain are
    /// fitted without any vibration.
    still: [[f64; 3]; 3],
}

/// When a stretch ends, and what its elimination needs.
#[derive(Clone, Copy, Debug)]
pub struct Folding {
    /// Length of a stretch, s.
    pub memory: f64,
    /// Priors at the time.
    pub priors: Priors,
    /// The noise's variance.
    pub variance: f64,
}

impl Track {
    /// A linearisation that has seen no sample.
    pub fn new(mode: Mode, sample_time: f64) -> Self {
        Self {
            mode,
            response: ModalResponse::new(mode, sample_time),
            moments: [[0.0; WIDTH]; WIDTH],
            past: Past::zeros(),
            has_past: false,
            row: [0.0; WIDTH],
            walk: Walk::default(),
            still: [[0.0; 3]; 3],
        }
    }

    /// Takes the next sample of the window, if there is one.
    pub fn absorb(&mut self, samples: &[Sample], folding: &Folding) {
        if let Some(sample) = self.approach(samples, folding) {
            self.take(sample);
        }
    }

    /// Moves to the next sample of the window: its row is then the last one, but not yet in the sums.
    pub fn approach<'a>(&mut self, samples: &'a [Sample], folding: &Folding) -> Option<&'a Sample> {
        let (sample, step) = self.walk.next(samples, folding.memory)?;
        match step {
            Step::First => {}
            Step::Interval(interval) => self.response.advance(&interval),
            Step::Free => self.set_free(folding),
        }
        let input = self.walk.input(sample);
        self.row = self.response.row(input, sample.deformation);
        // The gain is on the input since the first sample, whatever the stretch.
        self.row[INPUT] = self.walk.total_input(sample);
        Some(sample)
    }

    /// Adds the last row to the sums, unless its deformation was left out.
    pub fn take(&mut self, sample: &Sample) {
        if !sample.deformation.is_finite() {
            return;
        }
        let row = self.row;
        for (sums, x) in self.moments.iter_mut().zip(row) {
            for (sum, y) in sums.iter_mut().zip(row) {
                *sum += x * y;
            }
        }
        let measured = [1.0, row[INPUT], sample.deformation];
        for (sums, x) in self.still.iter_mut().zip(measured) {
            for (sum, y) in sums.iter_mut().zip(measured) {
                *sum += x * y;
            }
        }
    }

    /// Samples in the sums.
    pub fn taken(&self) -> f64 {
        self.still[0][0]
    }

    /// Ends a stretch: what it says is kept, the vibration from here on is free.
    fn set_free(&mut self, folding: &Folding) {
        if let Some(past) = fold(self, &folding.priors, folding.variance) {
            self.past = past;
            self.has_past = true;
        }
        self.moments = [[0.0; WIDTH]; WIDTH];
        self.response.restart();
    }

    /// Sum of squares that an offset and a gain alone leave of the deformation.
    pub fn without_vibration(&self) -> f64 {
        let [
            [one, input, sum],
            [_, input_square, product],
            [_, _, square],
        ] = self.still;
        if one <= 0.0 {
            return 0.0;
        }
        let spread = input_square - input * input / one;
        let centred = square - sum * sum / one;
        let slope = product - input * sum / one;
        // An input that stands still is no column.
        if spread > 1e-12 * input_square {
            centred - slope * slope / spread
        } else {
            centred
        }
    }
}
