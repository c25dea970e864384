//! The deformation of a move in its stretches without acceleration.

use quell_shapers::Mode;

use crate::service::contract::TickRow;
use crate::service::following::FOLLOWED;
use crate::service::ringing::{STEADY, largest};

/// The vibration measured in cruise.
#[derive(Clone, Debug)]
pub struct Cruise {
    /// Time in which the command still accelerates after its plan and the motor side follows, s.
    follows: f64,
    /// Planned position and its increment at the tick before.
    before: Option<(f64, f64)>,
    /// End of the forced deformation, s.
    forced_until: f64,
    /// Stamps and deformations in rad, one list for each stretch.
    stretches: Vec<Vec<(f64, f64)>>,
}

impl Cruise {
    /// For a move whose longest train lasts `train` s.
    pub fn new(train: f64) -> Self {
        Self {
            follows: train + FOLLOWED,
            before: None,
            forced_until: f64::NEG_INFINITY,
            stretches: Vec::new(),
        }
    }

    /// Takes command and measurement of a tick.
    pub fn take(&mut self, row: &TickRow) {
        let (position, increment) = self.before.unwrap_or((row.planned, 0.0));
        let now = row.planned - position;
        self.before = Some((row.planned, now));
        if (now - increment).abs() > STEADY || now == 0.0 {
            self.forced_until = row.time + self.follows;
        }
        if row.time <= self.forced_until {
            self.end_stretch();
        } else if row.deformation.is_finite() {
            self.listen((row.deformation_time, row.deformation));
        }
    }

    /// Stamps and deformations in each stretch.
    pub fn into_stretches(self) -> Vec<Vec<(f64, f64)>> {
        self.stretches
    }

    fn end_stretch(&mut self) {
        if self.stretches.last().is_none_or(|last| !last.is_empty()) {
            self.stretches.push(Vec::new());
        }
    }

    fn listen(&mut self, sample: (f64, f64)) {
        let Some(stretch) = self.stretches.last_mut() else {
            return;
        };
        if stretch.last().is_none_or(|last| sample.0 > last.0) {
            stretch.push(sample);
        }
    }

    /// The largest amplitude in cruise, rad; `None` where no stretch is long enough.
    pub fn vibration(&self, mode: Mode, sure: bool) -> Option<f64> {
        let each = self.stretches.iter();
        each.filter_map(|stretch| largest(stretch, mode, sure))
            .reduce(f64::max)
    }
}
