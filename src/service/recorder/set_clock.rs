//! A recording in which a sensor's clock was set.
//!
//! A file has one time for each sensor, which increases. A clock that is set, as by NTP from 1970 to today, would end
//! the sensor's channel where it goes back, and make the recording decades long where it goes on.
//! Stamps after that are shifted so that reception minus stamp goes on as before, up to the difference of two delays.

use crate::service::link::{LONGEST_WAY, is_set};

/// How a clock was set: stamp minus reception before and after, s.
#[derive(Clone, Copy, Debug)]
pub struct Set {
    from: f64,
    to: f64,
}

/// What is to be added to a sensor's stamps from now on, s, by reception and stamp of its last sample and of this one.
///
/// Sensors on one clock are set together: the first of them decides for the others, so that their relative times do
/// not change.
pub fn shift_of(set: &mut Option<Set>, last: (f64, f64), now: (f64, f64)) -> f64 {
    if !is_set(last, now) {
        return 0.0;
    }
    let [from, to] = [last, now].map(|(received, stamp)| stamp - received);
    let is_near = |one: f64, other: f64| (one - other).abs() <= LONGEST_WAY;
    let is_same = |set: &Set| is_near(set.from, from) && is_near(set.to, to);
    let set = match set.filter(is_same) {
        Some(set) => set,
        None => *set.insert(Set { from, to }),
    };
    set.from - set.to
}
