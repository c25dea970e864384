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
    /// The newest so far.
    Next {
        /// Stamps that are lost, by the sensor's usual gap: missing, and too old by now to come still.
        lost: u64,
    },
    /// Exactly the newest once more.
    Doubled,
    /// Older than the newest.
    Older,
    /// The robot's clock has started anew: everything before is to be forgotten.
    Restarted,
}

/// The stamps of one sensor.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    newest: Option<f64>,
    gap: Option<f64>,
    behind: u32,
    /// What has come of the last 64 by the usual gap, the newest in the lowest bit: one that is missing
    /// may only have taken a longer way.
    come: u64,
}

impl Default for Sequence {
    fn default() -> Self {
        Self {
            newest: None,
            gap: None,
            behind: 0,
            come: u64::MAX,
        }
    }
}

impl Sequence {
    /// Takes a finite stamp, s.
    pub fn take(&mut self, stamp: f64) -> Order {
        let Some(newest) = self.newest else {
            self.newest = Some(stamp);
            return Order::Next { lost: 0 };
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
            self.comes_late(newest - stamp);
            return Order::Older;
        }
        self.newest = Some(stamp);
        let missing = self.missing(stamp - newest);
        Order::Next {
            lost: self.shift(missing.saturating_add(1)),
        }
    }

    /// One that is so much older than the newest (s) is not lost.
    fn comes_late(&mut self, by: f64) {
        let places = self.gap.map_or(f64::INFINITY, |gap| (by / gap).round());
        if places < f64::from(u64::BITS) {
            self.come |= 1 << places as u32;
        }
    }

    /// The newest is so many places further; says how many of those that leave had not come.
    fn shift(&mut self, places: u64) -> u64 {
        let kept = match places {
            1..64 => self.come >> (u64::from(u64::BITS) - places),
            _ => self.come,
        };
        let leave = places.min(u64::from(u64::BITS));
        let beyond = places - leave;
        self.come = match places {
            1..64 => (self.come << places) | 1,
            _ => 1,
        };
        leave - u64::from(kept.count_ones()) + beyond
    }

    /// Stamps that a gap leaves out; the usual gap is the mean of those that leave out none.
    fn missing(&mut self, gap: f64) -> u64 {
        let Some(usual) = self.gap else {
            self.gap = Some(gap);
            return 0;
        };
        let ratio = gap / usual;
        if ratio < 0.5 {
            // The first gap was itself one with stamps missing, which were not counted.
            self.come = u64::MAX;
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
