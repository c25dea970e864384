//! Whether a motor side that is not commanded stands still: only then may commanding begin.

/// How long it must have stood still, s: longer than the time between two strokes of a joint that is
/// moved by something else.
const STILL: f64 = 0.25;
/// How far it may seem to go meanwhile, rad: more than the noise of an encoder, and less than a joint
/// that is moved goes in that time.
const SPAN: f64 = 2e-4;

/// Whether a motor side stands still.
#[derive(Clone, Copy, Debug, Default)]
pub struct Standstill {
    since: Option<(f64, f64)>,
    still: Option<f64>,
}

impl Standstill {
    /// Takes a motor position (rad) and when it was received (s).
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

    /// Where it stands, rad.
    pub fn position(&self) -> Option<f64> {
        self.still
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}
