//! Whether a motor side that is not commanded stands still, as required before commanding begins.

/// Required duration of the standstill, s: longer than the time between two strokes of a joint that is moved by
/// something else.
const STILL: f64 = 0.25;
/// Largest apparent motion during that time, rad: more than the noise of an encoder, and less than a joint
/// moves in that time.
const SPAN: f64 = 2e-4;

/// Whether a motor side stands still.
#[derive(Clone, Copy, Debug, Default)]
pub struct Standstill {
    since: Option<(f64, f64)>,
    still: Option<f64>,
}

impl Standstill {
    /// Takes a motor position (rad) and its time of reception (s).
    pub fn take(&mut self, time: f64, position: f64) {
        match self.since {
            Some((since, at)) if (position - at).abs() <= SPAN => {
                self.still = (time - since >= STILL).then_some(position);
            }
            _ => {
                self.since = Some((time, position));
                self.still = None;
            }
        }
    }

    /// Its position at standstill, rad.
    pub fn position(&self) -> Option<f64> {
        self.still
    }

    /// Restarts the observation.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}
