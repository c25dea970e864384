//! The health of the disk: the last failed writes that have not succeeded since.

use crate::service::contract::{DiskFault, DiskPart, DiskState, DiskView};

/// Failed writes that have not succeeded since.
#[derive(Debug, Default)]
pub struct Health {
    faults: Vec<DiskFault>,
    failures: u64,
    recordings_lost: u64,
}

impl Health {
    /// Notes a failed write at `now` (seconds since 1970). It is logged once, until a write succeeds; the view
    /// has the newest reason.
    pub fn failed(&mut self, what: DiskPart, reason: &str, now: f64) {
        self.failures += 1;
        let known = self.faults.iter_mut().find(|fault| fault.what == what);
        if let Some(fault) = known {
            fault.reason = reason.into();
            return;
        }
        tracing::error!(what = what.name(), "cannot be written: {reason}");
        self.faults.push(DiskFault {
            what,
            reason: reason.into(),
            since_unix_time_s: now,
        });
    }

    /// Notes a successful write.
    pub fn worked(&mut self, what: DiskPart) {
        if self.is_failing(what) {
            tracing::info!(what = what.name(), "can be written again");
            self.faults.retain(|fault| fault.what != what);
        }
    }

    /// Counts a recording that is incomplete on the shelf, for good.
    pub fn lost_recording(&mut self) {
        self.recordings_lost += 1;
    }

    /// Whether the last write failed.
    pub fn is_failing(&self, what: DiskPart) -> bool {
        self.faults.iter().any(|fault| fault.what == what)
    }

    /// The view for clients.
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
