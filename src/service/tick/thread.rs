//! The thread that keeps the tick.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;

use super::{Histogram, Tick, real_time};
use crate::service::clock::ServiceClock;
use crate::service::contract::TickStatistics;

/// State is published so many times a second.
const REPORTS: f64 = 20.0;

/// How the tick's thread runs.
#[derive(Clone, Copy, Debug)]
pub struct TickThreadSettings {
    /// Whether a real-time priority and locked memory are asked for.
    pub real_time: bool,
}

/// The thread that keeps the tick; it ends when this is dropped.
pub struct TickThread {
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl TickThread {
    /// Starts it.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(
        tick: Tick,
        clock: ServiceClock,
        settings: TickThreadSettings,
    ) -> io::Result<Self> {
        let ending = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&ending);
        let thread = std::thread::Builder::new()
            .name("quell-tick".into())
            .spawn(move || keep(tick, clock, settings, &stop))?;
        Ok(Self {
            ending,
            thread: Some(thread),
        })
    }

    /// Whether it has ended, which it never does by itself.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for TickThread {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // If it panicked, that was reported when it did.
            let _ = thread.join();
        }
    }
}

fn keep(mut tick: Tick, clock: ServiceClock, settings: TickThreadSettings, ending: &AtomicBool) {
    let mut statistics = TickStatistics {
        rate_hz: 1.0 / tick.period(),
        real_time: settings.real_time && real_time::raise_priority(),
        memory_locked: settings.real_time && real_time::lock_memory(),
        ..TickStatistics::default()
    };
    let (mut lateness, mut work) = (Histogram::default(), Histogram::default());
    let period = tick.period();
    let mut due = clock.now() + period;
    let mut next_report = due;
    while !ending.load(Relaxed) {
        clock.sleep_until(due);
        let begun = clock.now();
        lateness.add(begun - due);
        let next = due + period;
        let missed = ((begun - due) / period).floor().max(0.0);
        statistics.skipped += missed as u64;
        due += missed * period;
        // By the instant that it was due, so that lateness does not shift the command.
        tick.run(due, missed as u64);
        if begun >= next_report {
            next_report = begun + 1.0 / REPORTS;
            publish(&mut tick, due, &mut statistics, &lateness, &work);
        }
        let ended = clock.now();
        work.add(ended - begun);
        due += period;
        statistics.overruns += u64::from(ended > next);
    }
}

fn publish(
    tick: &mut Tick,
    now: f64,
    statistics: &mut TickStatistics,
    lateness: &Histogram,
    work: &Histogram,
) {
    statistics.lateness_p50_s = lateness.quantile(0.5);
    statistics.lateness_p99_s = lateness.quantile(0.99);
    statistics.lateness_max_s = lateness.longest();
    statistics.work_p50_s = work.quantile(0.5);
    statistics.work_p99_s = work.quantile(0.99);
    tick.report(now, *statistics);
}
