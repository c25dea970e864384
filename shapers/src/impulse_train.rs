//! Impulse trains: what a shaper designs.

use crate::ShaperError;
use arrayvec::ArrayVec;
use core::fmt;

/// How many impulses a train (and how many taps a grid train) holds.
pub const TRAIN_CAPACITY: usize = 256;

/// Impulses nearer to each other than this part of the train's duration are one: sums of the same
/// times in another order differ by a few units in the last place (2.2e-16 each).
const SAME_TIME: f64 = 1e-13;

/// One impulse: `amplitude` at `time` (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Seconds after the first impulse of the train.
    pub time: f64,
    /// Share of the command that is delayed by `time`.
    pub amplitude: f64,
}

/// A train of impulses `(t_i, A_i)`: ordered in time, the first at 0, with `sum A_i = 1`.
///
/// Shaping is convolution: `u_shaped(t) = sum A_i u(t - t_i)`. Holds [`TRAIN_CAPACITY`] impulses
/// in place (4 KiB) and never allocates.
///
/// # Example
/// ```
/// use quell_shapers::{Impulse, ImpulseTrain};
/// let pair = [Impulse { time: 0.0, amplitude: 1.0 }, Impulse { time: 0.5, amplitude: 1.0 }];
/// let zv = ImpulseTrain::new(&pair).unwrap();
/// let zvd = zv.convolve(&zv).unwrap();
/// let amplitudes: Vec<f64> = zvd.impulses().iter().map(|i| i.amplitude).collect();
/// assert_eq!(amplitudes, [0.25, 0.5, 0.25]);
/// assert_eq!(zvd.duration(), 1.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ImpulseTrain {
    impulses: ArrayVec<Impulse, TRAIN_CAPACITY>,
}

impl ImpulseTrain {
    /// The train that changes nothing: one impulse of amplitude 1 at time 0.
    pub fn identity() -> Self {
        let mut impulses = ArrayVec::new();
        impulses.push(Impulse {
            time: 0.0,
            amplitude: 1.0,
        });
        Self { impulses }
    }

    /// A train from impulses in any order: sorted, shifted so that the first is at 0, impulses at
    /// the same time added, amplitudes scaled to sum 1.
    ///
    /// # Errors
    /// [`ShaperError`] where the list is empty, too long, holds a value that is not finite or a
    /// negative time, or where the amplitudes do not add up to something above 0.
    pub fn new(impulses: &[Impulse]) -> Result<Self, ShaperError> {
        let mut train = Self {
            impulses: ArrayVec::new(),
        };
        for (index, impulse) in impulses.iter().enumerate() {
            let Impulse { time, amplitude } = *impulse;
            if !(time.is_finite() && time >= 0.0 && amplitude.is_finite()) {
                return Err(ShaperError::Impulse {
                    index,
                    time,
                    amplitude,
                });
            }
            train
                .impulses
                .try_push(*impulse)
                .map_err(|_| ShaperError::TooManyImpulses {
                    count: impulses.len(),
                    capacity: TRAIN_CAPACITY,
                })?;
        }
        train
            .impulses
            .sort_unstable_by(|a, b| a.time.total_cmp(&b.time));
        train.add_equal_times();
        train.normalise()?;
        Ok(train)
    }

    /// The impulses, in order of time.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Time of the last impulse, s: the delay that the train adds to the end of a move.
    pub fn duration(&self) -> f64 {
        self.impulses.last().map_or(0.0, |last| last.time)
    }

    /// `sum |A_i|`: the most by which the train can raise a peak; 1 where no amplitude is negative.
    pub fn gain(&self) -> f64 {
        self.impulses
            .iter()
            .map(|impulse| impulse.amplitude.abs())
            .sum()
    }

    /// The train that does what this one and then `other` do; its zeros are those of both.
    ///
    /// No allocation; `n m` impulses before equal times are added.
    ///
    /// # Errors
    /// [`ShaperError::TooManyImpulses`] where the result does not fit.
    pub fn convolve(&self, other: &Self) -> Result<Self, ShaperError> {
        let count = self.impulses.len() * other.impulses.len();
        // One cursor for each impulse of the first train: an n-way merge, so that equal times are
        // added before they need room.
        let mut cursors = [0_u16; TRAIN_CAPACITY];
        let mut train = Self {
            impulses: ArrayVec::new(),
        };
        while let Some((index, time)) = self.earliest(other, &cursors) {
            let second = other.impulses[usize::from(cursors[index])].amplitude;
            let amplitude = self.impulses[index].amplitude * second;
            cursors[index] += 1;
            train.add(Impulse { time, amplitude }, count)?;
        }
        train.normalise()?;
        Ok(train)
    }

    fn earliest(&self, other: &Self, cursors: &[u16]) -> Option<(usize, f64)> {
        self.impulses
            .iter()
            .zip(cursors)
            .enumerate()
            .filter_map(|(index, (impulse, &cursor))| {
                let second = other.impulses.get(usize::from(cursor))?;
                Some((index, impulse.time + second.time))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn add(&mut self, impulse: Impulse, count: usize) -> Result<(), ShaperError> {
        if let Some(last) = self.impulses.last_mut()
            && impulse.is_with(last)
        {
            last.amplitude += impulse.amplitude;
            return Ok(());
        }
        self.impulses
            .try_push(impulse)
            .map_err(|_| ShaperError::TooManyImpulses {
                count,
                capacity: TRAIN_CAPACITY,
            })
    }

    /// Adds impulses at the same time, the train sorted.
    fn add_equal_times(&mut self) {
        let mut kept = 0;
        for index in 1..self.impulses.len() {
            let impulse = self.impulses[index];
            if impulse.is_with(&self.impulses[kept]) {
                self.impulses[kept].amplitude += impulse.amplitude;
            } else {
                kept += 1;
                self.impulses[kept] = impulse;
            }
        }
        self.impulses.truncate(kept + 1);
    }

    // In place: a train by value is 4 KiB to copy.
    fn normalise(&mut self) -> Result<(), ShaperError> {
        let start = self.impulses.first().ok_or(ShaperError::Empty)?.time;
        let sum: f64 = self.impulses.iter().map(|impulse| impulse.amplitude).sum();
        if !(sum.is_finite() && sum > 0.0) {
            return Err(ShaperError::Sum(sum));
        }
        for impulse in &mut self.impulses {
            impulse.time -= start;
            impulse.amplitude /= sum;
        }
        Ok(())
    }
}

impl Impulse {
    /// Whether it is at the same time as another that is not later.
    fn is_with(&self, earlier: &Self) -> bool {
        self.time - earlier.time <= SAME_TIME * self.time
    }
}

impl fmt::Display for ImpulseTrain {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, impulse) in self.impulses.iter().enumerate() {
            let separator = if index == 0 { "" } else { ", " };
            write!(
                formatter,
                "{separator}{:.5} at {:.6} s",
                impulse.amplitude, impulse.time
            )?;
        }
        Ok(())
    }
}
