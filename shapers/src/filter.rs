//! The filter that runs a train at the tick.

use crate::{Buffer, GridTrain, ShaperError};
#[cfg(feature = "alloc")]
use crate::{OwnBuffer, buffer::on_heap};

/// Position, velocity and acceleration of one axis at one tick (rad, rad/s, rad/s^2, or m ...).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
}

impl Setpoint {
    /// Standing still at `position`.
    pub fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }
}

/// Runs one axis' setpoints through a train: `out(k) = sum A_i in(k - n_i)`, the same for
/// position, velocity and acceleration.
///
/// The position is computed as `in(k) + sum A_i (in(k - n_i) - in(k))`, which is the same because
/// the amplitudes add up to 1, and which makes a constant input come out to the bit: a move ends
/// exactly on its target.
///
/// A train of positive amplitudes is a convex combination, so that limits which hold for the input
/// hold for the output.
///
/// It keeps its past on the heap; where there is none, [`crate::AdaptiveFilter::in_buffers`] does the same.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug)]
pub struct ShapingFilter {
    sample_time: f64,
    line: DelayLine<OwnBuffer<Setpoint>>,
    train: GridTrain,
    pending: Option<GridTrain>,
}

#[cfg(feature = "alloc")]
impl ShapingFilter {
    /// A filter at rest at position 0 that changes nothing, for ticks of `sample_time` seconds and
    /// trains of up to `capacity` ticks. The only place that allocates (48 bytes a tick).
    ///
    /// A sample time that is not a finite number above 0 is taken as 1 s: trains for another one
    /// are then refused by [`ShapingFilter::install`].
    pub fn new(sample_time: f64, capacity: usize) -> Self {
        let sample_time = valid_sample_time(sample_time);
        let places = DelayLine::<OwnBuffer<Setpoint>>::places(capacity);
        Self {
            sample_time,
            line: DelayLine::new(on_heap(places)),
            train: GridTrain::unit(sample_time),
            pending: None,
        }
    }

    /// One tick: takes the planned setpoint, returns the shaped one.
    ///
    /// Never allocates, blocks or fails; cost proportional to the number of taps.
    #[inline]
    pub fn step(&mut self, input: Setpoint) -> Setpoint {
        if self.pending.is_some() {
            self.try_install();
        }
        self.line.push(input);
        self.line.shaped(&self.train)
    }

    /// Installs a train at rest: it takes effect at the first tick at which the filter is settled,
    /// until then the old one runs on. A later call replaces a train that is still waiting.
    ///
    /// # Errors
    /// [`ShaperError::SampleTimeMismatch`]; [`ShaperError::TooLong`].
    pub fn install(&mut self, train: &GridTrain) -> Result<(), ShaperError> {
        self.check(train)?;
        self.pending = Some(train.clone());
        self.try_install();
        Ok(())
    }

    /// Puts the filter to rest at `position`, with a waiting train installed.
    pub fn reset(&mut self, position: f64) {
        self.line.fill(Setpoint::at_rest(position));
        if let Some(train) = self.pending.take() {
            self.train = train;
        }
    }

    /// Whether the input has been constant for as long as the train lasts, so that the output is
    /// that constant and a change of train changes nothing.
    pub fn is_settled(&self) -> bool {
        self.line.unchanged_for() >= self.train.duration_in_ticks()
    }

    /// The train in force.
    pub fn train(&self) -> &GridTrain {
        &self.train
    }

    /// The train that waits for rest.
    pub fn pending(&self) -> Option<&GridTrain> {
        self.pending.as_ref()
    }

    /// Length of a tick, s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// Longest train, ticks.
    pub fn capacity(&self) -> usize {
        self.line.capacity()
    }

    // Apart from the step: it moves a train of 4 KiB, once.
    #[cold]
    fn try_install(&mut self) {
        // Constant for the longer of the two: the new train must not reach past the constant.
        let waiting = self.pending.as_ref().map(GridTrain::duration_in_ticks);
        let longest = waiting.map(|ticks| ticks.max(self.train.duration_in_ticks()));
        if longest.is_some_and(|ticks| self.line.unchanged_for() >= ticks)
            && let Some(train) = self.pending.take()
        {
            self.train = train;
        }
    }

    fn check(&self, train: &GridTrain) -> Result<(), ShaperError> {
        self.train.check_same_grid(train.sample_time())?;
        let (ticks, capacity) = (train.duration_in_ticks(), self.capacity());
        if ticks > capacity {
            return Err(ShaperError::TooLong { ticks, capacity });
        }
        Ok(())
    }
}

/// A sample time that is not a finite number above 0 becomes 1 s.
pub(crate) fn valid_sample_time(sample_time: f64) -> f64 {
    if sample_time.is_finite() && sample_time > 0.0 {
        sample_time
    } else {
        1.0
    }
}

/// # Errors
/// [`ShaperError::OutOfRange`] where a buffer is shorter than it must be.
pub(crate) fn at_least(name: &'static str, length: usize, least: usize) -> Result<(), ShaperError> {
    if length >= least {
        return Ok(());
    }
    let value = length as f64;
    Err(ShaperError::OutOfRange { name, value })
}

/// The last setpoints by age.
///
/// A ring that is written twice, half its length apart: the newest `length` setpoints then always lie one after
/// the other, and an age is found without asking where the ring ends.
#[derive(Clone, Debug)]
pub(crate) struct DelayLine<S> {
    ring: S,
    length: usize,
    /// Of the first of the two.
    newest: usize,
    unchanged: usize,
}

impl<S: Buffer<Setpoint>> DelayLine<S> {
    /// Places that a line of so many ticks takes.
    #[cfg(feature = "alloc")]
    pub fn places(capacity: usize) -> usize {
        2 * (capacity + 1)
    }

    /// At rest at position 0; holds ages from 0 to one less than half of the ring, which has at least 2 places.
    pub fn new(ring: S) -> Self {
        let length = ring.len() / 2;
        let mut line = Self {
            ring,
            length,
            newest: 0,
            unchanged: usize::MAX,
        };
        line.fill(Setpoint::default());
        line
    }

    pub fn capacity(&self) -> usize {
        self.length - 1
    }

    /// Becomes a copy of another one of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        self.ring.copy_from_slice(&other.ring);
        (self.newest, self.unchanged) = (other.newest, other.unchanged);
    }

    pub fn fill(&mut self, setpoint: Setpoint) {
        self.ring.fill(setpoint);
        self.unchanged = usize::MAX;
    }

    #[inline]
    pub fn push(&mut self, input: Setpoint) {
        let same = input == self.ring[self.newest];
        self.unchanged = if same {
            self.unchanged.saturating_add(1)
        } else {
            0
        };
        self.newest = if self.newest + 1 == self.length {
            0
        } else {
            self.newest + 1
        };
        self.ring[self.newest] = input;
        self.ring[self.newest + self.length] = input;
    }

    /// Ticks for which the newest setpoint has been repeated.
    pub fn unchanged_for(&self) -> usize {
        self.unchanged
    }

    /// The last setpoints, oldest first.
    #[inline]
    fn window(&self) -> &[Setpoint] {
        &self.ring[self.newest + 1..][..self.length]
    }

    /// The setpoint `age` ticks ago, 0 for the newest; an age above the capacity gives the oldest.
    #[inline]
    pub fn at(&self, age: usize) -> Setpoint {
        by_age(self.window(), age)
    }

    /// `sum A_i in(k - n_i)`, with a constant passed to the bit.
    #[inline]
    pub fn shaped(&self, train: &GridTrain) -> Setpoint {
        let window = self.window();
        shape(train, |age| by_age(window, age))
    }
}

#[inline]
fn by_age(window: &[Setpoint], age: usize) -> Setpoint {
    let last = window.len() - 1;
    window[last - age.min(last)]
}

/// `sum A_i in(n_i)` of setpoints given by age.
#[inline]
pub(crate) fn shape(train: &GridTrain, input: impl Fn(usize) -> Setpoint) -> Setpoint {
    let newest = input(0);
    let mut output = Setpoint::at_rest(newest.position);
    for tap in train.taps() {
        let past = input(tap.delay as usize);
        output.position += tap.amplitude * (past.position - newest.position);
        output.velocity += tap.amplitude * past.velocity;
        output.acceleration += tap.amplitude * past.acceleration;
    }
    output
}
