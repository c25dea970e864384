//! On-line alignment of two sensors with different clocks.

use arrayvec::ArrayVec;

use super::Measurement;

/// How a sensor's clock reads: `stamp = (1 + skew) t + offset`, `t` on the controller's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Reading at `t = 0`, s.
    pub offset: f64,
    /// Relative rate error, dimensionless.
    pub skew: f64,
}

impl Clock {
    /// The controller's own clock.
    pub const REFERENCE: Self = Self {
        offset: 0.0,
        skew: 0.0,
    };

    /// A clock of the right rate whose reading is `offset` (s) too large.
    pub const fn with_offset(offset: f64) -> Self {
        Self { offset, skew: 0.0 }
    }

    /// Stamp at time `t` (s).
    pub fn stamp(&self, time: f64) -> f64 {
        (1.0 + self.skew) * time + self.offset
    }

    /// Time on the controller's clock at a stamp (s).
    pub fn time(&self, stamp: f64) -> f64 {
        (stamp - self.offset) / (1.0 + self.skew)
    }
}

/// A measurement with the motor position at its instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aligned {
    /// Instant on the controller's clock, s.
    pub time: f64,
    /// Motor-side position `u` at that instant, rad.
    pub motor_position: f64,
    /// The measurement itself, its own stamp unchanged.
    pub measurement: Measurement,
}

/// Number of encoder samples that are kept: at 250 Hz a quarter of a second.
const HISTORY: usize = 64;
/// Most measurements that wait for the encoder.
const WAITING: usize = 64;

/// Interpolates the motor position at the stamps of another sensor, in the order of arrival.
///
/// A measurement is emitted as soon as encoder samples lie on both sides of its instant, in the order of
/// arrival. The motor position there is the cubic through the two samples before and the two after; if the
/// second one after has not arrived yet, through three before and one after. Against linear interpolation,
/// whose error `h^2 a / 8` is 30 urad at
/// before and one after. Against linear interpolation, whose error `h^2 a / 8` is 30 urad at
/// `h` = 4 ms and `a` = 15 rad/s^2 (50 um at a lever arm of 1.8 m), the cubic's error is of the order
/// of `h^3` times the step of the jerk over 16: about 1 urad at 250 rad/s^3.
///
/// The aligner does not allocate, block or fail. A stamp that is not finite or does not advance is ignored. A
/// measurement older than the history (64 encoder samples) is dropped and counted, and so is the oldest one
/// when 64 wait.
#[derive(Clone, Debug)]
pub struct Aligner {
    clock: Clock,
    encoder: Ring<(f64, f64), HISTORY>,
    waiting: Ring<(f64, Measurement), WAITING>,
    dropped: u64,
}

impl Aligner {
    /// An aligner for a sensor whose clock reads as `clock`; the encoder's is the reference.
    pub fn new(clock: Clock) -> Self {
        Self {
            clock,
            encoder: Ring::new(),
            waiting: Ring::new(),
            dropped: 0,
        }
    }

    /// Takes a measurement; afterwards call [`next_aligned`](Self::next_aligned) until it is `None`.
    pub fn observe(&mut self, measurement: Measurement) {
        if let Measurement::MotorPosition { time, position } = measurement {
            let advances = self.encoder.back().is_none_or(|&(last, _)| time > last);
            if time.is_finite() && position.is_finite() && advances {
                self.encoder.push(&(time, position));
            }
            return;
        }
        let time = self.clock.time(measurement.time());
        if !(time.is_finite() && is_finite(&measurement)) {
            return;
        }
        if self.waiting.is_full() {
            self.dropped += 1;
        }
        self.waiting.push(&(time, measurement));
    }

    /// The next measurement that the encoder brackets, with the motor position at its instant.
    pub fn next_aligned(&mut self) -> Option<Aligned> {
        loop {
            let &(time, measurement) = self.waiting.front()?;
            let &(newest, _) = self.encoder.back()?;
            if time > newest {
                return None;
            }
            self.waiting.pop_front();
            match self.motor_position(time) {
                Some(motor_position) => {
                    return Some(Aligned {
                        time,
                        motor_position,
                        measurement,
                    });
                }
                None => self.dropped += 1,
            }
        }
    }

    /// Measurements dropped so far: older than the history, or too many waiting.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Discards every sample.
    pub fn restart(&mut self) {
        self.encoder.clear();
        self.waiting.clear();
    }

    /// Motor position at an instant within the history, rad.
    fn motor_position(&self, time: f64) -> Option<f64> {
        let count = self.encoder.len();
        // Newest first: the instant is nearly always in the last interval or the one before.
        let after = (0..count)
            .rev()
            .find(|&k| self.encoder.get(k).is_some_and(|s| s.0 <= time))?;
        if self.encoder.get(after).is_some_and(|s| s.0 == time) {
            return self.encoder.get(after).map(|s| s.1);
        }
        // Two before and two after, shifted into the history where it ends.
        let first = (after + 3).min(count).saturating_sub(4);
        let points: ArrayVec<(f64, f64), 4> = (first..(first + 4).min(count))
            .filter_map(|k| self.encoder.get(k).copied())
            .collect();
        // There are nearly always four, and loops of a constant length cost half.
        Some(match <&[(f64, f64); 4]>::try_from(points.as_slice()) {
            Ok(four) => lagrange(four, time),
            Err(_) => lagrange(&points, time),
        })
    }
}

fn is_finite(measurement: &Measurement) -> bool {
    match *measurement {
        Measurement::MotorPosition { position, .. }
        | Measurement::LinkPosition { position, .. } => position.is_finite(),
        Measurement::Deformation { deformation, .. } => deformation.is_finite(),
        Measurement::TipPosition { position, .. } => position.iter().all(|x| x.is_finite()),
    }
}

/// The polynomial through all points, at `time`; the points' times differ.
#[inline(always)]
fn lagrange(points: &[(f64, f64)], time: f64) -> f64 {
    // Relative to the first value, so that a large common offset costs no digits.
    let origin = points.first().map_or(0.0, |p| p.1);
    let mut sum = origin;
    for (i, &(ti, value)) in points.iter().enumerate() {
        // One division a point.
        let (mut above, mut below) = (value - origin, 1.0);
        for (j, &(tj, _)) in points.iter().enumerate() {
            if i != j {
                above *= time - tj;
                below *= ti - tj;
            }
        }
        sum += above / below;
    }
    sum
}

/// The last `N` values pushed, oldest first.
#[derive(Clone, Debug)]
struct Ring<T, const N: usize> {
    values: [Option<T>; N],
    first: usize,
    len: usize,
}

impl<T: Copy, const N: usize> Ring<T, N> {
    fn new() -> Self {
        Self {
            values: [None; N],
            first: 0,
            len: 0,
        }
    }

    fn len(&self) -> usize {
        self.len
    }

    fn is_full(&self) -> bool {
        self.len == N
    }

    fn push(&mut self, value: &T) {
        self.values[(self.first + self.len) % N] = Some(*value);
        if self.is_full() {
            self.first = (self.first + 1) % N;
        } else {
            self.len += 1;
        }
    }

    fn get(&self, index: usize) -> Option<&T> {
        if index < self.len {
            self.values[(self.first + index) % N].as_ref()
        } else {
            None
        }
    }

    fn front(&self) -> Option<&T> {
        self.get(0)
    }

    fn back(&self) -> Option<&T> {
        self.get(self.len.checked_sub(1)?)
    }

    fn pop_front(&mut self) {
        if self.len > 0 {
            self.first = (self.first + 1) % N;
            self.len -= 1;
        }
    }

    fn clear(&mut self) {
        self.first = 0;
        self.len = 0;
    }
}
