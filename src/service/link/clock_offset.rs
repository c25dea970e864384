//! Offset between two clocks, from datagrams of which some have little delay.

/// Length of a window, s: clocks that drift by 100 ppm move by 1 ms in it.
const WINDOW: f64 = 10.0;

/// The difference of a sender's clock and the receiver's.
///
/// `stamp - received = offset - delay`, and a delay is never negative: the largest difference within a window
/// belongs to the datagram of least delay. The present and the last window count, so that a drift is tracked.
///
/// Source: minimum-delay filter of the Network Time Protocol, D. Mills, RFC 5905, section 10.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClockOffset {
    started: Option<f64>,
    present: Option<f64>,
    last: Option<f64>,
}

impl ClockOffset {
    /// Takes a stamp and the time at which it was received, both s.
    pub fn take(&mut self, stamp: f64, received: f64) {
        let difference = stamp - received;
        let started = *self.started.get_or_insert(received);
        if received - started > WINDOW {
            self.started = Some(received);
            self.last = self.present.take();
        }
        self.present = Some(self.present.map_or(difference, |most| most.max(difference)));
    }

    /// The sender's clock minus the receiver's, s, less the least delay.
    pub fn offset(&self) -> Option<f64> {
        match (self.present, self.last) {
            (Some(present), Some(last)) => Some(present.max(last)),
            (present, last) => present.or(last),
        }
    }

    /// Restarts, for example after a restart of the sender's clock.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}
