//! The stored samples, with the input between them.

use crate::estimators::Sample;
use crate::estimators::modal_response::{Interval, parabola};

/// The stored samples, oldest first, with the parabolas of the input that all linearisations share.
#[derive(Clone, Debug)]
pub struct Window {
    samples: Vec<Sample>,
    /// Slope and curvature of the input on the interval that ends with a sample.
    bends: Vec<[f64; 2]>,
}

impl Window {
    /// An empty window; allocates all its memory.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            samples: Vec::with_capacity(capacity),
            bends: Vec::with_capacity(capacity),
        }
    }

    /// The samples.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Whether there is no place for a further sample.
    pub fn is_full(&self) -> bool {
        self.samples.len() == self.samples.capacity().min(self.bends.capacity())
    }

    /// Adds a sample that is later than those before.
    pub fn push(&mut self, sample: Sample) {
        self.bends.push(bend(&self.samples, &sample));
        self.samples.push(sample);
    }

    /// Marks the youngest sample as a spike: only its input is used.
    pub fn refuse_youngest(&mut self) {
        if let Some(youngest) = self.samples.last_mut() {
            youngest.deformation = f64::NAN;
        }
    }

    /// Drops the oldest samples; the first remaining one then has no interval before it.
    pub fn drop_oldest(&mut self, count: usize) {
        self.samples.drain(..count);
        self.bends.drain(..count);
        if let Some(second) = self.bends.get_mut(1) {
            second[1] = 0.0;
        }
    }

    /// Drops all.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.bends.clear();
    }

    /// Length of the interval that ends with sample `index`, 1 or above, and the coefficients of the input on
    /// it, counted from `origin`.
    #[inline]
    pub fn interval(&self, index: usize, origin: f64) -> (f64, [f64; 3]) {
        let (last, now) = (&self.samples[index - 1], &self.samples[index]);
        let step = now.time - last.time;
        let start = last.motor_position - origin;
        (step, parabola(start, self.bends[index], step))
    }
}

/// Slope and curvature of the input up to the sample that comes next.
fn bend(samples: &[Sample], next: &Sample) -> [f64; 2] {
    let Some(last) = samples.last() else {
        return [0.0; 2];
    };
    let mut interval = Interval {
        start: last.motor_position,
        end: next.motor_position,
        step: next.time - last.time,
        ..Interval::default()
    };
    if let [.., before, _] = samples {
        interval.before = before.motor_position;
        interval.step_before = last.time - before.time;
    }
    interval.bend()
}
