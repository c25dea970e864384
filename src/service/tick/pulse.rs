//! The tick with its clock: due time, lateness, and missed ticks.

use super::{Histogram, Tick};
use crate::service::clock::ServiceClock;
use crate::service::contract::TickStatistics;

/// Number of published states per second.
const REPORTS: f64 = 20.0;

/// A tick with its clock.
pub struct Pulse {
    tick: Tick,
    clock: ServiceClock,
    /// When the next tick is due, s.
    due: f64,
    next_report: f64,
    statistics: TickStatistics,
    lateness: Histogram,
    work: Histogram,
}

impl Pulse {
    /// A tick that is due a period from now.
    pub fn new(tick: Tick, clock: ServiceClock) -> Self {
        let due = clock.now() + tick.period();
        Self {
            statistics: TickStatistics {
                rate_hz: 1.0 / tick.period(),
                ..TickStatistics::default()
            },
            tick,
            clock,
            due,
            next_report: due,
            lateness: Histogram::default(),
            work: Histogram::default(),
        }
    }

    /// Starts the ticks, on a thread with or without real-time priority and locked memory.
    pub fn begin(&mut self, real_time: bool, memory_locked: bool) {
        (self.statistics.real_time, self.statistics.memory_locked) = (real_time, memory_locked);
        self.due = self.clock.now() + self.tick.period();
        self.next_report = self.due;
    }

    /// Waits for the next tick and runs it. Ticks whose time is over by then are missed.
    pub fn beat(&mut self) {
        let (clock, period) = (&self.clock, self.tick.period());
        clock.sleep_until(self.due);
        let begun = clock.now();
        self.lateness.add(begun - self.due);
        let next = self.due + period;
        let missed = ((begun - self.due) / period).floor().max(0.0);
        self.statistics.skipped += missed as u64;
        self.due += missed * period;
        // The due time is used, so that lateness does not shift the command.
        self.tick.run(self.due, missed as u64);
        if begun >= self.next_report {
            self.next_report = begun + 1.0 / REPORTS;
            self.report();
        }
        let ended = self.clock.now();
        self.work.add(ended - begun);
        self.due += period;
        self.statistics.overruns += u64::from(ended > next);
    }

    fn report(&mut self) {
        let statistics = &mut self.statistics;
        statistics.lateness_p50_s = self.lateness.quantile(0.5);
        statistics.lateness_p99_s = self.lateness.quantile(0.99);
        statistics.lateness_max_s = self.lateness.longest();
        statistics.work_p50_s = self.work.quantile(0.5);
        statistics.work_p99_s = self.work.quantile(0.99);
        self.tick.report(self.due, self.statistics);
    }
}
