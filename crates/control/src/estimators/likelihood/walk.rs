//! The position of a linearisation in the window: from sample to sample, and into a new stretch.

use super::window::Window;
use crate::estimators::Sample;

/// The step between a sample and the one before.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// None: it is the window's first sample.
    First,
    /// An interval in which the input drives the vibration: its length, s, and the input's coefficients on it.
    Interval(f64, [f64; 3]),
    /// The end of a stretch: the vibration is free again from this sample on.
    Free,
}

/// Position in the window, and the start of its stretch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Walk {
    /// Samples of the window seen so far.
    pub count: usize,
    /// Input at the first sample, and at the present stretch's first.
    origin: f64,
    stretch_origin: f64,
    stretch_from: f64,
}

impl Walk {
    /// Moves to the next sample of the window, where stretches are `memory` (s) long.
    #[inline]
    pub fn next<'a>(&mut self, window: &'a Window, memory: f64) -> Option<(&'a Sample, Step)> {
        let sample = window.samples().get(self.count)?;
        let step = if self.count == 0 {
            self.origin = sample.motor_position;
            self.begin_stretch(sample);
            Step::First
        } else if sample.time - self.stretch_from >= memory {
            self.begin_stretch(sample);
            Step::Free
        } else {
            let (length, input) = window.interval(self.count, self.stretch_origin);
            Step::Interval(length, input)
        };
        self.count += 1;
        Some((sample, step))
    }

    /// The input since the stretch's first sample.
    pub fn input(&self, sample: &Sample) -> f64 {
        sample.motor_position - self.stretch_origin
    }

    /// The input since the window's first sample.
    pub fn total_input(&self, sample: &Sample) -> f64 {
        sample.motor_position - self.origin
    }

    fn begin_stretch(&mut self, sample: &Sample) {
        self.stretch_origin = sample.motor_position;
        self.stretch_from = sample.time;
    }
}
