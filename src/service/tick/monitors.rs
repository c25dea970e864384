//! What closes the gate at the tick: silence, sensors and following errors, missed ticks, commands beyond the range.

use super::gate::{Cause, Trip};
use super::rings::ORDERS;
use super::{Event, JointTick, Tick};
use crate::service::guard::Fault;

impl Tick {
    /// Checks the reception of a joint. Only if all received data were taken, as they are not after a long
    /// pause, and if there is room for answers to orders, too.
    pub(super) fn look(&mut self, index: usize, now: f64) {
        let is_behind = self.inbox.len() == self.inbox.capacity();
        let has_room = self.rings.events.slots() > ORDERS * self.joints.len();
        if has_room
            && !is_behind
            && let Some(event) = self.joints[index].look(now)
        {
            if let Event::Lost(_) = event {
                self.gate.trip(self.silent(index, now));
            }
            self.tell(event);
        }
    }

    /// The fault of a silent joint. If its motor side sent what is no number in the last half of the timeout, that
    /// sensor is at fault; if another joint was measured then, the link is not.
    pub(super) fn silent(&self, index: usize, now: f64) -> Trip {
        if self.joints[index].sends_no_number(now) {
            return Trip {
                joint: Some(index),
                cause: Cause::Sensor(Fault::NotFinite),
            };
        }
        let heard = |joint: &JointTick| {
            let [silence, timeout] = joint.silence(now);
            silence < 0.5 * timeout
        };
        match self.joints.iter().any(heard) {
            true => Trip {
                joint: Some(index),
                cause: Cause::Silent,
            },
            false => Trip {
                joint: None,
                cause: Cause::LinkLost,
            },
        }
    }

    /// Closes the gate for measurements, and for missed ticks.
    ///
    /// A robot that got no setpoint for as long as the watchdog's timeout has stood still, and people nearby
    /// take it for at rest: it must not continue by itself. Shorter gaps are bridged by the [`pace`].
    pub(super) fn watch(&mut self, missed: u64, moves: bool) {
        for (index, joint) in self.joints.iter().enumerate() {
            if let Some(cause) = joint.fault() {
                let joint = Some(index);
                self.gate.trip(Trip { joint, cause });
            }
        }
        let without = missed as f64 * self.period;
        let patience = self.joints.iter().map(|joint| joint.silence(0.0)[1]);
        if moves && without > patience.fold(f64::INFINITY, f64::min) {
            self.gate.trip(Trip {
                joint: None,
                cause: Cause::Overrun(without),
            });
        }
    }

    /// Reports a fault to the engine, once there is room.
    pub(super) fn tell_trip(&mut self) {
        if self.rings.events.slots() > ORDERS
            && let Some(trip) = self.gate.take_untold()
        {
            self.tell(Event::Tripped(trip));
        }
    }

    /// Closes the gate for a command that leads beyond the range of a joint.
    pub(super) fn tell_left(&mut self, index: usize) {
        if let Some(position) = self.joints[index].take_left() {
            self.gate.trip(Trip {
                joint: Some(index),
                cause: Cause::Range(position),
            });
            // First the reason: the move that it ends has it.
            self.tell_trip();
            self.tell(Event::Left(index));
        }
    }
}
