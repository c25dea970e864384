//! Lateness of a loop that sleeps until each tick and does nothing.

use serde::Serialize;
use std::time::{Duration, Instant};

/// Time between two ticks.
const PERIOD: Duration = Duration::from_millis(1);
/// Number of ticks.
const TICKS: u32 = 1000;

/// Lateness, us.
#[derive(Debug, Serialize)]
pub struct Lateness {
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The maximum.
    pub max: f64,
}

/// Measured on this thread, for a second.
pub fn measured() -> Lateness {
    let start = Instant::now();
    let late = (1..=TICKS).map(|tick| {
        let due = start + tick * PERIOD;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        Instant::now().saturating_duration_since(due).as_secs_f64() * 1e6
    });
    of(late.collect())
}

/// Quantiles of at least one number.
fn of(mut late: Vec<f64>) -> Lateness {
    late.sort_by(f64::total_cmp);
    let at = |share: f64| late[((late.len() - 1) as f64 * share).round() as usize];
    Lateness {
        median: at(0.5),
        p99: at(0.99),
        max: at(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::of;

    #[test]
    fn quantiles_are_of_the_sorted_numbers() {
        let late = of((0..=100).rev().map(f64::from).collect());
        assert_eq!([late.median, late.p99, late.max], [50.0, 99.0, 100.0]);
    }
}
