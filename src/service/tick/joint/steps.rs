//! How far the command goes from one setpoint that is sent to the next.

use crate::service::following::FOLLOWED;

/// The largest step of the command that a motor side may still follow. No allocation.
///
/// After missed ticks the next setpoint is that of its own instant: a drive that takes it at once steps by what
/// was commanded in all of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Steps {
    last: Option<f64>,
    largest: f64,
    /// When the largest was sent, s.
    since: f64,
}

impl Steps {
    /// A setpoint is sent at `now` (s) and a position (rad); returns the largest step of the last [`FOLLOWED`].
    pub fn take(&mut self, now: f64, position: f64) -> f64 {
        let step = self.last.map_or(0.0, |last| (position - last).abs());
        self.last = Some(position);
        if step >= self.largest || now - self.since > FOLLOWED {
            (self.largest, self.since) = (step, now);
        }
        self.largest
    }
}
