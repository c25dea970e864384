//! One linearisation of the likelihood: a mode, its response and the moments of its rows.

use quell_shapers::Mode;

use super::fit::Moments;
use crate::estimators::Sample;
use crate::estimators::modal_response::{Interval, ModalResponse, WIDTH};

/// One linearisation of the likelihood, run along the samples from the first one on.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    /// Where it is linearised.
    pub mode: Mode,
    /// The mode's response to the input so far.
    pub response: ModalResponse,
    /// Sums over the rows so far.
    pub moments: Moments,
    /// The last row.
    pub row: [f64; WIDTH],
    /// Samples of the window taken so far.
    pub count: usize,
    /// Input at the first sample: the response is to what the input moved since.
    origin: f64,
}

impl Track {
    /// A linearisation that has seen no sample.
    pub fn new(mode: Mode, sample_time: f64) -> Self {
        Self {
            mode,
            response: ModalResponse::new(mode, sample_time),
            moments: [[0.0; WIDTH]; WIDTH],
            row: [0.0; WIDTH],
            count: 0,
            origin: 0.0,
        }
    }

    /// Takes the next sample of the window, if there is one.
    pub fn absorb(&mut self, samples: &[Sample]) {
        let Some(sample) = samples.get(self.count) else {
            return;
        };
        if self.count == 0 {
            self.origin = sample.motor_position;
        }
        let origin = self.origin;
        if self.count > 0 {
            let last = samples[self.count - 1];
            let mut interval = Interval {
                start: last.motor_position - origin,
                end: sample.motor_position - origin,
                step: sample.time - last.time,
                ..Interval::default()
            };
            if self.count > 1 {
                let before = samples[self.count - 2];
                interval.before = before.motor_position - origin;
                interval.step_before = last.time - before.time;
            }
            self.response.advance(&interval);
        }
        self.row = self
            .response
            .row(sample.motor_position - origin, sample.deformation);
        for i in 0..WIDTH {
            for j in i..WIDTH {
                self.moments[i][j] += self.row[i] * self.row[j];
            }
        }
        self.count += 1;
    }
}
