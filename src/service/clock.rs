//! The service's clock: seconds since the service started, and the wall-clock time.
//!
//! All code that needs the time uses a [`ServiceClock`]. A simulated one stands still until it is advanced, so
//! that time-dependent code can be run step by step.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

use rustix::thread::{ClockId, Timespec, clock_nanosleep_absolute};
use rustix::time::clock_gettime;

/// The service's clock. All threads hold the same one.
#[derive(Clone, Debug)]
pub struct ServiceClock(Source);

#[derive(Clone, Debug)]
enum Source {
    /// The system's monotonic clock; `start` is its reading at the start, ns.
    System {
        start: i128,
    },
    Simulated(Arc<Simulated>),
}

/// Both times as bits of a floating-point number.
#[derive(Debug)]
struct Simulated {
    now: AtomicU64,
    /// Wall-clock time when `now` was 0, seconds since 1970.
    wall: AtomicU64,
}

/// Advances a simulated clock.
#[derive(Clone, Debug)]
pub struct SimulatedTime(Arc<Simulated>);

impl ServiceClock {
    /// A clock that starts now.
    pub fn start() -> Self {
        let start = nanoseconds();
        Self(Source::System { start })
    }

    /// A clock that stands at 0 while the wall clock shows `unix_time` (seconds since 1970), and the handle
    /// that advances it.
    ///
    /// # Example
    /// ```
    /// use quell::service::clock::ServiceClock;
    /// let (clock, time) = ServiceClock::simulated(1e9);
    /// time.advance_to(2.0);
    /// time.jump_wall(-3600.0);
    /// assert_eq!((clock.now(), clock.unix_time()), (2.0, 1e9 - 3598.0));
    /// ```
    pub fn simulated(unix_time: f64) -> (Self, SimulatedTime) {
        let both = Arc::new(Simulated {
            now: AtomicU64::new(0f64.to_bits()),
            wall: AtomicU64::new(unix_time.to_bits()),
        });
        let time = SimulatedTime(Arc::clone(&both));
        (Self(Source::Simulated(both)), time)
    }

    /// Time since the start, s; exact to a nanosecond for 100 days.
    pub fn now(&self) -> f64 {
        match &self.0 {
            Source::System { start } => (nanoseconds() - start) as f64 * 1e-9,
            Source::Simulated(both) => read(&both.now),
        }
    }

    /// Seconds since 1970 by the wall clock, which may jump: for display only, never for control.
    pub fn unix_time(&self) -> f64 {
        match &self.0 {
            Source::System { .. } => {
                let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
                now.map_or(0.0, |since| since.as_secs_f64())
            }
            Source::Simulated(both) => read(&both.wall) + read(&both.now),
        }
    }

    /// Sleeps until `time` (s): an absolute sleep, so that delays do not accumulate. A simulated clock is
    /// advanced to that time instead.
    pub fn sleep_until(&self, time: f64) {
        match &self.0 {
            Source::System { start } => self.sleep(start + (time * 1e9) as i128, time),
            Source::Simulated(both) => SimulatedTime(Arc::clone(both)).advance_to(time),
        }
    }

    fn sleep(&self, at: i128, time: f64) {
        let (seconds, rest) = (at.div_euclid(SECOND), at.rem_euclid(SECOND));
        let (Ok(tv_sec), Ok(tv_nsec)) = (seconds.try_into(), rest.try_into()) else {
            return;
        };
        let until = Timespec { tv_sec, tv_nsec };
        // A signal ends the sleep early; then it sleeps on.
        while clock_nanosleep_absolute(ClockId::Monotonic, &until).is_err() && self.now() < time {}
    }
}

impl SimulatedTime {
    /// Moves the clock on to `time`, s; time does not go back.
    pub fn advance_to(&self, time: f64) {
        let later = read(&self.0.now).max(time);
        self.0.now.store(later.to_bits(), SeqCst);
    }

    /// Moves the wall clock forward by so many seconds, or back.
    pub fn jump_wall(&self, by: f64) {
        let jumped = read(&self.0.wall) + by;
        self.0.wall.store(jumped.to_bits(), SeqCst);
    }
}

fn read(number: &AtomicU64) -> f64 {
    f64::from_bits(number.load(SeqCst))
}

/// Nanoseconds of a second.
const SECOND: i128 = 1_000_000_000;

fn nanoseconds() -> i128 {
    let now = clock_gettime(rustix::time::ClockId::Monotonic);
    i128::from(now.tv_sec) * SECOND + i128::from(now.tv_nsec)
}
