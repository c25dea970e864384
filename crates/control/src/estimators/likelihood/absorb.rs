//! Advances a linearisation along the samples, stretch by stretch.

use super::fit::fold;
use super::moments::Moments;
use super::priors::Priors;
use super::track::Track;
use super::walk::Step;
use super::window::Window;
use crate::estimators::Sample;
use crate::estimators::modal_response::INPUT;

/// The end of a stretch, and the quantities for its elimination.
#[derive(Clone, Copy, Debug)]
pub struct Folding {
    /// Length of a stretch, s.
    pub memory: f64,
    /// The present priors.
    pub priors: Priors,
    /// The noise's variance.
    pub variance: f64,
}

impl Track {
    /// Takes the next sample of the window, if there is one.
    pub fn absorb(&mut self, window: &Window, folding: &Folding) {
        if let Some(sample) = self.approach(window, folding) {
            self.take(sample);
        }
    }

    /// Moves to the next sample of the window: its row becomes the last one, but is not yet in the sums.
    pub fn approach<'a>(&mut self, window: &'a Window, folding: &Folding) -> Option<&'a Sample> {
        let (sample, step) = self.walk.next(window, folding.memory)?;
        match step {
            Step::First => {}
            Step::Interval(length, input) => self.response.advance(length, &input),
            Step::Free => self.set_free(folding),
        }
        let input = self.walk.input(sample);
        self.row = self.response.row(input, sample.deformation);
        // The gain applies to the input since the first sample, in every stretch.
        self.row[INPUT] = self.walk.total_input(sample);
        Some(sample)
    }

    /// Ends a stretch: its information is kept, and the vibration is free again from here on.
    fn set_free(&mut self, folding: &Folding) {
        if let Some(past) = fold(self, &folding.priors, folding.variance) {
            self.past = past;
            self.has_past = true;
        }
        self.moments = Moments::ZERO;
        self.response.restart();
    }
}
