//! Whether moves may begin. Closed at the start, opened by the engine for a person, closed by the tick itself with
//! the first fault: in the tick in which it is seen, whatever the engine is doing.

use crate::service::guard::Fault;

/// Why the gate was closed by the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The motor side of one joint has not been heard for longer than the watchdog allows, while others are.
    Silent,
    /// Nothing of the robot has been heard for as long.
    LinkLost,
    /// The motor side is so far (rad) from all that was commanded in the time in which it follows.
    Following(f64),
    /// The sensor of the motor side says what cannot be.
    Sensor(Fault),
    /// Nothing was sent to a joint in motion for so long, s.
    Overrun(f64),
}

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trip {
    /// The joint; none where it is that of all.
    pub joint: Option<usize>,
    /// Why.
    pub cause: Cause,
}

/// What becomes of a plan at the gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// It may begin.
    Begins,
    /// It may not begin yet.
    Waits,
    /// It does not begin any more.
    Refused,
}

/// Whether moves may begin, and under which permit.
///
/// A plan carries the permit under which it was asked for and begins under no other: what was asked for before a
/// fault does not begin after it, however long it was under way. A permit that was given without knowledge of the
/// last fault opens nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gate {
    permit: Option<u64>,
    /// Whether moves wait until the tick knows all that was ordered.
    held: bool,
    /// Faults so far.
    trips: u64,
    /// A fault that the engine was not told for want of room.
    untold: Option<Trip>,
}

impl Gate {
    /// Opens for a permit that was given when so many faults were known. Whether it did.
    pub fn open(&mut self, permit: u64, trips: u64) -> bool {
        if trips == self.trips {
            self.permit = Some(permit);
        }
        self.is_open()
    }

    /// Closes, as a person wants it.
    pub fn close(&mut self) {
        self.permit = None;
    }

    /// Closes for a fault. One that finds the gate closed has nothing to close, and is none.
    pub fn trip(&mut self, trip: Trip) {
        if self.permit.take().is_some() {
            self.trips += 1;
            self.untold = Some(trip);
        }
    }

    /// Whether any move may begin.
    pub fn is_open(&self) -> bool {
        self.permit.is_some()
    }

    /// Lets moves wait, or no longer.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
    }

    /// What becomes of a plan of this permit now; one without needs none.
    pub fn admits(&self, permit: Option<u64>) -> Admission {
        match permit {
            None => Admission::Begins,
            Some(_) if self.held => Admission::Waits,
            Some(_) if self.permit == permit => Admission::Begins,
            Some(_) => Admission::Refused,
        }
    }

    /// The fault to be told; once.
    pub fn take_untold(&mut self) -> Option<Trip> {
        self.untold.take()
    }
}
