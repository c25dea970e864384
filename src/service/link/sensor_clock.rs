//! The clock of one sensor, over each time that it is set.
//!
//! A clock that is set, as by NTP from 1970 to today, would end what is learned, aligned and recorded by its stamps. So
//! the link hands them on as by the clock before that: reception minus stamp goes on as it was, up to the
//! difference between the least delays before and after. Behind the link no clock is ever set.

use super::{ClockOffset, LONGEST_WAY};

/// How long sensors on one clock may take to show that it was set, s: eight samples of a slow one.
const TOGETHER: f64 = 10.0;

/// How a clock was set.
#[derive(Clone, Copy, Debug)]
pub struct Set {
    /// By how much it went on, s.
    leap: f64,
    /// When that was noticed, s on the service's clock.
    noticed: f64,
}

/// A sensor's clock. No allocation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SensorClock {
    offset: ClockOffset,
    /// The same by stamps that are far from the last ones, until they are believed.
    unbelieved: ClockOffset,
    /// What the clock was set back by since the first stamp, s.
    shift: f64,
}

impl SensorClock {
    /// Takes a stamp and its reception, both s; returns the sample's delay beyond the least one, s.
    pub fn take(&mut self, stamp: f64, received: f64) -> f64 {
        self.unbelieved.restart();
        self.offset.take(stamp, received);
        self.offset
            .offset()
            .map_or(0.0, |offset| received - stamp + offset)
    }

    /// Takes a stamp far from the last ones: a damaged one, or one of a clock that was set.
    pub fn doubt(&mut self, stamp: f64, received: f64) {
        self.unbelieved.take(stamp, received);
    }

    /// Believes the stamps that were doubted until `received`, s.
    ///
    /// Sensors on one clock are set together: the first of them decides for the others by `last`, so that their relative
    /// times do not change. `delay` is the longest by which a sample may come late, s: leaps that differ by
    /// no more are one.
    pub fn believe(&mut self, last: &mut Option<Set>, received: f64, delay: f64) {
        let before = core::mem::replace(&mut self.offset, self.unbelieved);
        self.unbelieved.restart();
        let (Some(before), Some(after)) = (before.offset(), self.offset.offset()) else {
            return;
        };
        let leap = after - before;
        // The sensor was silent for a while; its clock went on.
        if leap.abs() <= LONGEST_WAY {
            return;
        }
        let is_same =
            |set: &Set| (set.leap - leap).abs() <= delay && received - set.noticed <= TOGETHER;
        let set = match last.filter(is_same) {
            Some(set) => set,
            None => *last.insert(Set {
                leap,
                noticed: received,
            }),
        };
        self.shift -= set.leap;
    }

    /// A stamp as by the clock of the first one, s.
    pub fn as_before(&self, stamp: f64) -> f64 {
        stamp + self.shift
    }

    /// The clock minus the service's, s, as it is set now, less the least delay.
    pub fn offset(&self) -> Option<f64> {
        self.offset.offset()
    }
}
