//! The gate for moves. It is closed at the start, opened by the engine on a request, and closed by the tick
//! itself at the first fault: in the same tick, independently of the engine.

use crate::service::guard::Fault;

/// Why the tick closed the gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The motor side of one joint has been silent for longer than the watchdog allows, while others are
    /// measured.
    Silent,
    /// The whole robot has been silent for as long.
    LinkLost,
    /// Following error of the motor side beyond its lag, rad.
    Following(f64),
    /// The sensor of the motor side gives impossible values, or no numbers for as long as it may be silent.
    Sensor(Fault),
    /// Nothing was sent to a moving joint for this time, s.
    Overrun(f64),
    /// A command that would have led to this position (rad) at least, beyond the joint's range. It was not sent.
    Range(f64),
}

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trip {
    /// The joint; `None` where it concerns all.
    pub joint: Option<usize>,
    /// Why.
    pub cause: Cause,
}

/// The decision of the gate on a plan.
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
/// A plan carries the permit of its request and begins under no other: a request from before a fault does not
/// begin after it, however long it took. A permit that was given without knowledge of the last fault does not
/// open the gate.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gate {
    permit: Option<u64>,
    /// Whether moves wait until the tick has all orders.
    held: bool,
    /// Number of faults so far.
    trips: u64,
    /// A fault that could not be reported to the engine for lack of room.
    untold: Option<Trip>,
}

impl Gate {
    /// Opens for a permit that was given when `trips` faults were known; returns whether it did.
    pub fn open(&mut self, permit: u64, trips: u64) -> bool {
        if trips == self.trips {
            self.permit = Some(permit);
        }
        self.is_open()
    }

    /// Closes on request.
    pub fn close(&mut self) {
        self.permit = None;
    }

    /// Closes for a fault. If the gate is closed already, it does not count as a fault.
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

    /// Lets moves wait, or ends the wait.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
    }

    /// The decision on a plan with this permit; a plan without one needs none.
    pub fn admits(&self, permit: Option<u64>) -> Admission {
        match permit {
            None => Admission::Begins,
            Some(_) if self.held => Admission::Waits,
            Some(_) if self.permit == permit => Admission::Begins,
            Some(_) => Admission::Refused,
        }
    }

    /// The fault to be reported, once.
    pub fn take_untold(&mut self) -> Option<Trip> {
        self.untold.take()
    }
}
