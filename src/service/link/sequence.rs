//! The stamps of one sensor: in order, doubled or out of order, and the number of missing ones.
//!
//! A loss is judged with hindsight: a gap between two stamps is evaluated when [`HALF`] newer ones have
//! arrived. By then late datagrams are there, and the sensor's usual gap is known from both sides: the larger
//! one of the medians before and after. A median is robust against a burst of stamps that are closer than
//! usual. If the rate changes for good, the larger median avoids a false count of losses. A sensor that pauses
//! and then sends what it held back leaves a long gap and a run of short ones, which fill the apparent loss.

/// Age relative to the newest stamp, s, above which an older stamp is not a late datagram: the robot's clock
/// was restarted.
pub(super) const LONGEST_WAY: f64 = 1.0;
/// Number of successive stamps from a restarted clock that are required: a single one may be damaged.
const BELIEVED: u32 = 8;
/// Stamps on either side of a gap for its evaluation: at 1 kHz a datagram may be 64 ms late, and a burst of up
/// to 31 does not change the median.
const HALF: usize = 64;
/// Share of the usual gap below which one is short.
const SHORT: f64 = 0.5;

/// The kind of a stamp relative to those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The newest so far.
    Next {
        /// Number of lost stamps, by the sensor's usual gap: missing, and too old to arrive still.
        lost: u64,
    },
    /// Exactly the newest once more.
    Doubled,
    /// Older than the newest.
    Older,
    /// Far from the newest: damaged, or of a clock that was set, which is believed later.
    Doubted,
    /// The clock was set: this stamp and those that were doubted before it are believed.
    Restarted,
}

/// The stamps of one sensor. No allocation.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    /// The last stamps, in order.
    stamps: [f64; 2 * HALF + 2],
    length: usize,
    /// Number of evaluated gaps, counted from the oldest stamp.
    judged: usize,
    behind: u32,
}

impl Default for Sequence {
    fn default() -> Self {
        Self {
            stamps: [0.0; 2 * HALF + 2],
            length: 0,
            judged: 0,
            behind: 0,
        }
    }
}

impl Sequence {
    /// Takes a finite stamp, s.
    pub fn take(&mut self, stamp: f64) -> Order {
        let Some(&newest) = self.known().last() else {
            self.insert(0, stamp);
            return Order::Next { lost: 0 };
        };
        if stamp == newest {
            return Order::Doubled;
        }
        if (stamp - newest).abs() > LONGEST_WAY {
            self.behind += 1;
            if self.behind >= BELIEVED {
                *self = Self::default();
                self.insert(0, stamp);
                return Order::Restarted;
            }
            return Order::Doubted;
        }
        self.behind = 0;
        if stamp < newest {
            self.comes_late(stamp);
            return Order::Older;
        }
        self.insert(self.length, stamp);
        Order::Next { lost: self.judge() }
    }

    fn known(&self) -> &[f64] {
        &self.stamps[..self.length]
    }

    /// Inserts a late stamp, unless its gap has been evaluated.
    fn comes_late(&mut self, stamp: f64) {
        let place = self.known().partition_point(|known| *known < stamp);
        if place > self.judged && self.stamps[place] != stamp {
            self.insert(place, stamp);
        }
    }

    fn insert(&mut self, place: usize, stamp: f64) {
        let mut place = place;
        if self.length == self.stamps.len() {
            // The oldest is dropped; the gap behind it has been evaluated, or never will be.
            self.stamps.copy_within(1.., 0);
            self.length -= 1;
            self.judged = self.judged.saturating_sub(1);
            place = place.saturating_sub(1);
        }
        self.stamps.copy_within(place..self.length, place + 1);
        self.stamps[place] = stamp;
        self.length += 1;
    }

    /// Evaluates the gaps that have enough newer stamps; returns the number of lost stamps in them.
    fn judge(&mut self) -> u64 {
        let mut lost = 0;
        while self.length > self.judged + 1 + HALF {
            lost += self.missing(self.judged);
            self.judged += 1;
        }
        lost
    }

    /// Stamps that are missing in a gap.
    fn missing(&self, index: usize) -> u64 {
        let known = self.known();
        let before = median(&known[index.saturating_sub(HALF)..=index]);
        let after = median(&known[index + 1..]);
        // The median of a few gaps may itself be a gap with losses.
        let usual = match index >= HALF {
            true => before.max(after),
            false => after,
        };
        let places = ((known[index + 1] - known[index]) / usual).round();
        if places < 2.0 {
            return 0;
        }
        let followers = known[index + 1..].windows(2);
        let short = followers.take_while(|pair| pair[1] - pair[0] < SHORT * usual);
        (places as u64 - 1).saturating_sub(short.count() as u64)
    }
}

/// The median of the gaps between stamps, the lower one of two; at most [`HALF`] of them. The short gaps of a
/// burst would reduce it, so the median is taken over gaps that are not short relative to the median of all.
fn median(stamps: &[f64]) -> f64 {
    let mut gaps = [0.0; HALF];
    let count = (stamps.len().saturating_sub(1)).min(HALF);
    for (gap, pair) in gaps.iter_mut().zip(stamps.windows(2)) {
        *gap = pair[1] - pair[0];
    }
    if count == 0 {
        return 0.0;
    }
    let gaps = &mut gaps[..count];
    gaps.sort_unstable_by(f64::total_cmp);
    let of_all = gaps[(count - 1) / 2];
    let short = gaps.partition_point(|gap| *gap < SHORT * of_all);
    gaps[short + (count - short - 1) / 2]
}
