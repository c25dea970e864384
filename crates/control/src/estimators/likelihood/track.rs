//! One linearisation of the likelihood: a mode, its response and the moments of its rows.

use quell_shapers::Mode;

use super::moments::Moments;
use super::region::log_point;
use super::walk::Walk;
use crate::estimators::Sample;
use crate::estimators::modal_response::{INPUT, ModalResponse, WIDTH};
use nalgebra::SMatrix;

/// Normal equations of past stretches, their free decays eliminated: `ln w`, `xi`, offset, rate,
/// scale, gain, and the residual as last row.
pub type Past = SMatrix<f64, 7, 7>;

/// One linearisation of the likelihood, run along the samples from the first one on.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    /// The mode at the linearisation.
    pub mode: Mode,
    /// `ln w` and `xi` there.
    pub point: [f64; 2],
    /// The mode's response to the input so far.
    pub response: ModalResponse,
    /// Sums over the rows of the present stretch.
    pub moments: Moments,
    /// The information of past stretches, after each of which the vibration was set free again.
    pub past: Past,
    /// Whether there are past stretches.
    pub has_past: bool,
    /// The last row.
    pub row: [f64; WIDTH],
    /// Its place in the window.
    pub walk: Walk,
    still: Still,
}

/// Sums of products of 1, the input and the deformation, for a fit of an offset and a gain without any
/// vibration.
#[derive(Clone, Copy, Debug, Default)]
struct Still {
    count: f64,
    input: f64,
    deformation: f64,
    input_square: f64,
    product: f64,
    deformation_square: f64,
}

impl Track {
    /// A linearisation without samples.
    pub fn new(mode: Mode, sample_time: f64) -> Self {
        Self {
            mode,
            point: log_point(mode),
            response: ModalResponse::new(mode, sample_time),
            moments: Moments::ZERO,
            past: Past::zeros(),
            has_past: false,
            row: [0.0; WIDTH],
            walk: Walk::default(),
            still: Still::default(),
        }
    }

    /// Adds the last row to the sums, unless it is a spike.
    pub fn take(&mut self, sample: &Sample) {
        if !sample.deformation.is_finite() {
            return;
        }
        self.moments.add(&self.row);
        let (still, input, deformation) = (&mut self.still, self.row[INPUT], sample.deformation);
        still.count += 1.0;
        still.input += input;
        still.deformation += deformation;
        still.input_square += input * input;
        still.product += input * deformation;
        still.deformation_square += deformation * deformation;
    }

    /// Samples in the sums.
    pub fn taken(&self) -> f64 {
        self.still.count
    }

    /// Sum of squares of the deformation after a fit of offset and gain alone.
    pub fn without_vibration(&self) -> f64 {
        let still = &self.still;
        if still.count <= 0.0 {
            return 0.0;
        }
        let mean = 1.0 / still.count;
        let spread = still.input_square - still.input * still.input * mean;
        let centred = still.deformation_square - still.deformation * still.deformation * mean;
        let slope = still.product - still.input * still.deformation * mean;
        // A constant input is no column.
        if spread > 1e-12 * still.input_square {
            centred - slope * slope / spread
        } else {
            centred
        }
    }
}
