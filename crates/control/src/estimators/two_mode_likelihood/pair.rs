//! One linearisation of the two-mode likelihood: two modes, their responses and the moments of their rows.

use quell_shapers::Mode;

use crate::estimators::Sample;
use crate::estimators::correlation::Correlation;
use crate::estimators::likelihood::Window;
use crate::estimators::likelihood::region::log_point;
use crate::estimators::likelihood::walk::{Step, Walk};
use crate::estimators::modal_response::{
    DEFORMATION, INPUT, ModalResponse, OFFSET, RESIDUAL, VELOCITY,
};

/// Columns of a pair's row.
pub const WIDTH: usize = 23;
/// Columns that belong to one mode: eight sensitivities and free terms as in
/// [`modal_response`](crate::estimators::modal_response), then `q'`, then a deformation.
pub const OF_A_MODE: usize = 10;
/// Index of `q'` among a mode's columns.
pub const RATE_COLUMN: usize = 8;
/// Index of `q_1 - u` among the first mode's columns, of `q_2 - q_1` among the second's.
pub const SHAPE_COLUMN: usize = 9;
/// Index of the constant 1.
pub const CONSTANT: usize = 20;
/// Index of the input since the first sample.
pub const TOTAL_INPUT: usize = 21;
/// Index of the measured deformation minus `q_1 - u`.
pub const MISS: usize = 22;

/// `ln w` and `xi` of both modes.
pub fn points(modes: [Mode; 2]) -> [f64; 4] {
    let [[a, b], [c, d]] = modes.map(log_point);
    [a, b, c, d]
}

/// A row of a pair.
pub type Row = [f64; WIDTH];

/// One linearisation, run along the samples from the first one on.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The modes at the linearisation.
    pub modes: [Mode; 2],
    responses: [ModalResponse; 2],
    /// Sums of products of the columns, below and on the diagonal.
    moments: [Row; WIDTH],
    /// The last row.
    row: Row,
    /// Its place in the window.
    pub walk: Walk,
    /// Samples in the sums.
    pub taken: f64,
    /// Weights of a row's columns that give the residual, once there is a solution.
    pub weights: Option<Row>,
    /// The correlation of the residual's neighbours.
    pub correlation: Correlation,
}

impl Pair {
    /// A linearisation without samples.
    pub fn new(modes: [Mode; 2], sample_time: f64) -> Self {
        Self {
            modes,
            responses: modes.map(|mode| ModalResponse::new(mode, sample_time)),
            moments: [[0.0; WIDTH]; WIDTH],
            row: [0.0; WIDTH],
            walk: Walk::default(),
            taken: 0.0,
            weights: None,
            correlation: Correlation::default(),
        }
    }

    /// Takes the next sample of the window, if there is one.
    pub fn absorb(&mut self, window: &Window) {
        let Some((sample, step)) = self.walk.next(window, f64::INFINITY) else {
            return;
        };
        if let Step::Interval(length, input) = step {
            for response in &mut self.responses {
                response.advance(length, &input);
            }
        }
        // Of a spike only the input is used.
        if sample.deformation.is_finite() {
            self.fill(sample);
            self.take();
        }
    }

    fn fill(&mut self, sample: &Sample) {
        let input = self.walk.input(sample);
        let [first, second] = &self.responses;
        let rows = [first, second].map(|response| response.row(input, sample.deformation));
        for (m, row) in rows.iter().enumerate() {
            let own = &mut self.row[m * OF_A_MODE..(m + 1) * OF_A_MODE];
            own[..OFFSET].copy_from_slice(&row[..OFFSET]);
            own[RATE_COLUMN] = row[VELOCITY];
            own[SHAPE_COLUMN] = row[DEFORMATION];
        }
        self.row[OF_A_MODE + SHAPE_COLUMN] -= rows[0][DEFORMATION];
        self.row[CONSTANT] = 1.0;
        self.row[TOTAL_INPUT] = rows[0][INPUT];
        self.row[MISS] = rows[0][RESIDUAL];
    }

    fn take(&mut self) {
        for (i, &x) in self.row.iter().enumerate() {
            // In a free decay all driven columns are 0.
            if x != 0.0 {
                for (sum, y) in self.moments[i].iter_mut().zip(&self.row[..=i]) {
                    *sum += x * y;
                }
            }
        }
        self.taken += 1.0;
        if let Some(weights) = &self.weights {
            let residual = self.weighed(weights);
            self.correlation.observe(residual);
        }
    }

    /// All samples; `each` sees it after each of them.
    pub fn along(
        samples: &[Sample],
        modes: [Mode; 2],
        sample_time: f64,
        mut each: impl FnMut(&Self),
    ) -> Self {
        let mut pair = Self::new(modes, sample_time);
        let mut window = Window::with_capacity(samples.len());
        for &sample in samples {
            window.push(sample);
            pair.absorb(&window);
            each(&pair);
        }
        pair
    }

    /// A weighted sum of the last row's columns.
    pub fn weighed(&self, weights: &Row) -> f64 {
        weights.iter().zip(&self.row).map(|(w, x)| w * x).sum()
    }

    /// `d lambda / d ln w` and `d lambda / d xi` of a mode.
    pub fn turns(&self, mode: usize) -> [nalgebra::Complex<f64>; 2] {
        self.responses[mode].lambda_slopes()
    }

    /// Sum of products of two columns.
    pub fn moment(&self, i: usize, j: usize) -> f64 {
        self.moments[i.max(j)][i.min(j)]
    }

    /// Sum of squares of a weighted sum of the rows' columns.
    pub fn square(&self, weights: &[(usize, f64)]) -> f64 {
        let products = |&(i, x): &(usize, f64)| -> f64 {
            let sum: f64 = weights.iter().map(|&(j, y)| y * self.moment(i, j)).sum();
            x * sum
        };
        weights.iter().map(products).sum()
    }
}
