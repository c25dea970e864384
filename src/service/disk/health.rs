//! The health of the disk: the writes that failed last and have not worked since.

use crate::service::contract::{DiskFault, DiskPart, DiskState, DiskView};

/// A write that failed and has not worked since.
#[derive(Debug, Default)]
pub struct Health {
    faults: Vec<DiskFault>,
    failures: u64,
    recordings_lost: u64,
}

impl Health {
    /// Something could not be written, at `now` (seconds since 1970). Told once, until it works again.
    pub fn failed(&mut self, what: DiskPart, reason: &str, now: f64) {
        self.failures += 1;
        if !self.is_failing(what) {
            tracing::error!(what = what.name(), "cannot be written: {reason}");
            self.faults.push(DiskFault {
                what,
                reason: reason.into(),
                since_unix_time_s: now,
            });
        }
    }

    /// Something was written.
    pub fn worked(&mut self, what: DiskPart) {
        if self.is_failing(what) {
            tracing::info!(what = what.name(), "can be written again");
            self.faults.retain(|fault| fault.what != what);
        }
    }

    /// A recording is not whole on the shelf, and will not be.
    pub fn lost_recording(&mut self) {
        self.recordings_lost += 1;
    }

    /// Whether something could not be written the last time.
    pub fn is_failing(&self, what: DiskPart) -> bool {
        self.faults.iter().any(|fault| fault.what == what)
    }

    /// For the outside.
    pub fn view(&self) -> DiskView {
        DiskView {
            state: match self.faults.is_empty() {
                true => DiskState::Fine,
                false => DiskState::Failing,
            },
            faults: self.faults.clone(),
            failures: self.failures,
            recordings_lost: self.recordings_lost,
        }
    }
}
