//! The service's clock: monotonic, in seconds since the service started.

use rustix::thread::{ClockId, Timespec, clock_nanosleep_absolute};
use rustix::time::clock_gettime;

/// The service's clock. All threads hold the same one.
#[derive(Clone, Copy, Debug)]
pub struct ServiceClock {
    start: i128,
}

impl ServiceClock {
    /// A clock that starts now.
    pub fn start() -> Self {
        Self {
            start: nanoseconds(),
        }
    }

    /// Time since the start, s; exact to a nanosecond for 100 days.
    pub fn now(&self) -> f64 {
        (nanoseconds() - self.start) as f64 * 1e-9
    }

    /// Sleeps until `time` (s): an absolute sleep, so that what came before does not add up.
    pub fn sleep_until(&self, time: f64) {
        let at = self.start + (time * 1e9) as i128;
        let (seconds, rest) = (at.div_euclid(SECOND), at.rem_euclid(SECOND));
        let (Ok(tv_sec), Ok(tv_nsec)) = (seconds.try_into(), rest.try_into()) else {
            return;
        };
        let until = Timespec { tv_sec, tv_nsec };
        // A signal ends the sleep early; then there is a rest to sleep.
        while clock_nanosleep_absolute(ClockId::Monotonic, &until).is_err() && self.now() < time {}
    }
}

/// Nanoseconds of a second.
const SECOND: i128 = 1_000_000_000;

fn nanoseconds() -> i128 {
    let now = clock_gettime(rustix::time::ClockId::Monotonic);
    i128::from(now.tv_sec) * SECOND + i128::from(now.tv_nsec)
}

/// Seconds since 1970 by the system's clock; for people, never for control.
pub fn unix_time() -> f64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.map_or(0.0, |since| since.as_secs_f64())
}
