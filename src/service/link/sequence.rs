//! The stamps of one sensor: in order, doubled, out of order, and how many are missing.

/// A stamp older than the newest by more than this is no longer a datagram that took a longer way, s:
/// the robot's clock has started anew.
const LONGEST_WAY: f64 = 1.0;
/// So many stamps in succession from a clock that seems to have started anew are believed: one alone
/// may be damaged.
const BELIEVED: u32 = 8;
/// Weight of a new gap in the mean of the gaps: the last 50 count.
const WEIGHT: f64 = 0.02;

/// What a stamp is, seen after those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The newest so far; so many before it are missing.
    Next {
        /// Stamps missing, by the sensor's usual gap.
        missing: u64,
    },
    /// Exactly the newest once more.
    Doubled,
    /// Older than the newest.
    Older,
    /// The robot's clock has started anew: everything before is to be forgotten.
    Restarted,
}

/// The stamps of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequence {
    newest: Option<f64>,
    gap: Option<f64>,
    behind: u32,
}

impl Sequence {
    /// Takes a finite stamp, s.
    pub fn take(&mut self, stamp: f64) -> Order {
        let Some(newest) = self.newest else {
            self.newest = Some(stamp);
            return Order::Next { missing: 0 };
        };
        if stamp == newest {
            return Order::Doubled;
        }
        if (stamp - newest).abs() > LONGEST_WAY {
            self.behind += 1;
            if self.behind >= BELIEVED {
                *self = Self {
                    newest: Some(stamp),
                    ..Self::default()
                };
                return Order::Restarted;
            }
            return Order::Older;
        }
        self.behind = 0;
        if stamp < newest {
            return Order::Older;
        }
        self.newest = Some(stamp);
        Order::Next {
            missing: self.missing(stamp - newest),
        }
    }

    /// Stamps that a gap leaves out; the usual gap is the mean of those that leave out none.
    fn missing(&mut self, gap: f64) -> u64 {
        let Some(usual) = self.gap else {
            self.gap = Some(gap);
            return 0;
        };
        let ratio = gap / usual;
        if ratio < 0.5 {
            // The first gap was itself one with stamps missing.
            self.gap = Some(gap);
            return 0;
        }
        let missing = (ratio.round() - 1.0).max(0.0);
        if missing == 0.0 {
            self.gap = Some(usual + WEIGHT * (gap - usual));
        }
        missing as u64
    }
}
