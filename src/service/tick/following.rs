//! Distance of a motor side from its command, beyond its normal lag.

use crate::service::contract::Measured;
use crate::service::following::FOLLOWED;
use crate::service::link::ClockOffset;

/// Time for which commands are remembered, s; an older measurement is not judged.
const REMEMBERED: f64 = 1.0;

/// Compares a motor side with its commands. No allocation.
///
/// The error is the distance of a reading from the interval of all commands between [`FOLLOWED`] before the
/// reading's instant and now. A joint that only lags has no error at any speed. A joint that is held or pushed
/// has the displacement as its error. The instant comes from the reading's stamp, by the readings of least
/// delay, so that a late one is compared with the commands of its time.
#[derive(Clone, Debug)]
pub struct Following {
    limit: f64,
    offset: ClockOffset,
    /// Time (s) and position (rad) of the commands, a ring.
    commands: Box<[(f64, f64)]>,
    next: usize,
    error: f64,
}

impl Following {
    /// A joint with an allowed error of `limit` (rad), commanded every `period` (s).
    pub fn new(limit: f64, period: f64) -> Self {
        let commands = (REMEMBERED / period).ceil().max(1.0) as usize;
        Self {
            limit,
            offset: ClockOffset::default(),
            commands: vec![(f64::NEG_INFINITY, 0.0); commands].into(),
            next: 0,
            error: 0.0,
        }
    }

    /// Discards the commands, for example when the joint is commanded again.
    pub fn restart(&mut self) {
        self.offset.restart();
        self.commands.fill((f64::NEG_INFINITY, 0.0));
        self.error = 0.0;
    }

    /// Discards the last error, until the next reading.
    pub fn forgive(&mut self) {
        self.error = 0.0;
    }

    /// Adds a command (rad) with its time (s).
    pub fn command(&mut self, time: f64, position: f64) {
        self.commands[self.next] = (time, position);
        self.next = (self.next + 1) % self.commands.len();
    }

    /// Takes a position of the motor side.
    pub fn take(&mut self, measured: &Measured) {
        self.offset.take(measured.stamp, measured.received);
        let offset = self.offset.offset().unwrap_or(0.0);
        let at = measured.stamp - offset;
        let late = measured.received - at;
        if late > REMEMBERED - FOLLOWED {
            // The clock was set back, or the reading is outdated.
            self.offset.restart();
            return;
        }
        let since = at - FOLLOWED;
        let newest_first = (1..=self.commands.len()).map(|back| {
            self.commands[(self.next + self.commands.len() - back) % self.commands.len()]
        });
        let mut range: Option<[f64; 2]> = None;
        for (time, position) in newest_first {
            let [low, high] = range.unwrap_or([position; 2]);
            if time == f64::NEG_INFINITY {
                break;
            }
            range = Some([low.min(position), high.max(position)]);
            // The command before the interval is in force at its beginning.
            if time < since {
                break;
            }
        }
        let Some([low, high]) = range else { return };
        let position = measured.value[0];
        self.error = (low - position).max(position - high).max(0.0);
    }

    /// The last error, rad.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The error, rad, if it exceeds the limit.
    pub fn excess(&self) -> Option<f64> {
        (self.error > self.limit).then_some(self.error)
    }
}
