//! The stamps of one sensor: in order, doubled, out of order, and how many are missing.
//!
//! A loss is judged with hindsight: a gap between two stamps is looked at when [`HALF`] younger
//! ones have come. By then whatever took a longer way is there, and the sensor's usual gap is known from
//! both sides: it is the larger one of the medians before and after. A median does not follow a burst,
//! stamps that lie closer than usual for a while, and where the rate changes for good the larger of the
//! two counts none as missing that the sensor did not send. A sensor that pauses and then sends what it
//! held back leaves a long gap and a run of short ones: these are what seemed to be missing.

/// A stamp older than the newest by more than this is no longer a datagram that took a longer way, s:
/// the robot's clock has started anew.
const LONGEST_WAY: f64 = 1.0;
/// So many stamps in succession from a clock that seems to have started anew are believed: one alone
/// may be damaged.
const BELIEVED: u32 = 8;
/// Stamps on either side of a gap that it is judged by: at 1 kHz a datagram may be 64 ms late, and a
/// burst of up to 31 does not change what is usual.
const HALF: usize = 64;
/// Share of the usual gap below which one is short: half way to none.
const SHORT: f64 = 0.5;

/// The kind of a stamp, seen after those before it.
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

/// The stamps of one sensor. No allocation.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    /// The last stamps, in order.
    stamps: [f64; 2 * HALF + 2],
    length: usize,
    /// Gaps that have been judged, counted from the oldest stamp.
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
            return Order::Older;
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

    /// One that took a longer way is put where it belongs, unless that has been judged.
    fn comes_late(&mut self, stamp: f64) {
        let place = self.known().partition_point(|known| *known < stamp);
        if place > self.judged && self.stamps[place] != stamp {
            self.insert(place, stamp);
        }
    }

    fn insert(&mut self, place: usize, stamp: f64) {
        let mut place = place;
        if self.length == self.stamps.len() {
            // The oldest goes; the gap behind it has been judged, or never will be.
            self.stamps.copy_within(1.., 0);
            self.length -= 1;
            self.judged = self.judged.saturating_sub(1);
            place = place.saturating_sub(1);
        }
        self.stamps.copy_within(place..self.length, place + 1);
        self.stamps[place] = stamp;
        self.length += 1;
    }

    /// Judges the gaps behind which enough has come; says how many stamps are lost in them.
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
        // The median of a few gaps may itself be one with stamps missing.
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

/// The median of the gaps between stamps, the lower one of two; at most [`HALF`] of them. The short gaps of a burst
/// would draw it to the least of the usual ones: it is taken of what is not short beside the median of all.
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
