//! The filter that can be retuned in motion.

#[cfg(feature = "alloc")]
use crate::buffer::on_heap;
use crate::correction::{Schedule, sum};
use crate::cross_fade::CrossFade;
use crate::filter::{DelayLine, at_least, valid_sample_time};
use crate::history::{Entry, History, SHORTEST_HISTORY};
use crate::pole::pole;
use crate::{Buffer, GridTrain, Mode, OwnBuffer, Setpoint, ShaperError};

/// A [`crate::ShapingFilter`] that can also change its train in motion: [`AdaptiveFilter::retune`].
///
/// It remembers its input and its output. So it can compute the vibration that its command will have left,
/// whatever trains made it, and send what cancels that.
#[derive(Clone, Debug)]
pub struct AdaptiveFilter<S = OwnBuffer<Setpoint>, E = OwnBuffer<Entry>> {
    pub(crate) sample_time: f64,
    pub(crate) tick: u64,
    pub(crate) line: DelayLine<S>,
    pub(crate) fade: CrossFade,
    pub(crate) pending: Option<GridTrain>,
    /// A retune counts on the train in force until the planned input ends at this tick.
    pub(crate) pending_from: u64,
    pub(crate) schedule: Schedule,
    pub(crate) history: History<E>,
    pub(crate) sent: Setpoint,
    /// The lowest and the highest position that a correction may send.
    pub(crate) range: [f64; 2],
    /// Scratch of [`AdaptiveFilter::retune`]: the planned input and the output it leads to.
    pub(crate) planned: S,
    pub(crate) future: S,
}

/// The memory of an [`AdaptiveFilter`] where there is no heap; see [`AdaptiveFilter::in_buffers`].
#[derive(Clone, Copy, Debug)]
pub struct Buffers<S, E> {
    /// Two for each tick of the longest train, and two more.
    pub line: S,
    /// As many ticks as are remembered, at least 2.
    pub history: E,
    /// As many ticks as a retune can look ahead, at least 1.
    pub planned: S,
    /// As many as `planned`.
    pub future: S,
}

/// Vibration that a command leaves in a mode, in units of the position.
///
/// `|sum du_k exp(lambda (t - t_k))|`, `lambda = -xi omega + j omega_d`: the amplitude at `t` of the
/// mode's answer to the increments of the command, divided by its answer to a step of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Left by what was sent.
    pub shaped: f64,
    /// Left by the planned input, had it been sent as it is.
    pub unshaped: f64,
}

impl Residual {
    /// `shaped / unshaped` at the same instant; 0 where nothing is left of either.
    pub fn ratio(&self) -> f64 {
        if self.shaped == 0.0 {
            0.0
        } else {
            self.shaped / self.unshaped
        }
    }
}

#[cfg(feature = "alloc")]
impl AdaptiveFilter {
    /// A filter at rest at position 0 that changes nothing.
    ///
    /// * `sample_time`: length of a tick, s; not finite or not above 0 is taken as 1 s, and every
    ///   train for another one is then refused;
    /// * `capacity`: longest train, ticks;
    /// * `horizon`: ticks of the past that are remembered, and of the future that a retune can look
    ///   ahead. It must cover the longest move with the longest train; twice that lets vibration
    ///   left by one move be cancelled in the next.
    ///
    /// The only place that allocates: 48 bytes for each tick of `capacity`, 72 for each of
    /// `horizon`.
    pub fn new(sample_time: f64, capacity: usize, horizon: usize) -> Self {
        let buffers = Buffers {
            line: on_heap(DelayLine::<OwnBuffer<Setpoint>>::places(capacity)),
            history: on_heap(horizon.max(SHORTEST_HISTORY)),
            planned: on_heap(horizon.max(1)),
            future: on_heap(horizon.max(1)),
        };
        Self::on(sample_time, buffers)
    }
}

impl<S: Buffer<Setpoint>, E: Buffer<Entry>> AdaptiveFilter<S, E> {
    /// [`AdaptiveFilter::new`] without a heap: the lengths of the buffers are capacity and horizon.
    ///
    /// # Errors
    /// [`ShaperError::OutOfRange`] where a buffer is shorter than [`Buffers`] says.
    pub fn in_buffers(sample_time: f64, buffers: Buffers<S, E>) -> Result<Self, ShaperError> {
        at_least("length of the delay line", buffers.line.len(), 2)?;
        let (history, planned) = (buffers.history.len(), buffers.planned.len());
        at_least("length of the history", history, SHORTEST_HISTORY)?;
        at_least("ticks ahead", planned, 1)?;
        at_least("ticks of the future", buffers.future.len(), planned)?;
        Ok(Self::on(sample_time, buffers))
    }

    fn on(sample_time: f64, buffers: Buffers<S, E>) -> Self {
        let sample_time = valid_sample_time(sample_time);
        Self {
            sample_time,
            tick: 0,
            line: DelayLine::new(buffers.line),
            fade: CrossFade::new(GridTrain::unit(sample_time)),
            pending: None,
            pending_from: 0,
            schedule: Schedule::default(),
            history: History::new(buffers.history),
            sent: Setpoint::default(),
            range: [f64::NEG_INFINITY, f64::INFINITY],
            planned: buffers.planned,
            future: buffers.future,
        }
    }

    /// Becomes a copy of another filter with buffers of the same lengths, as its clone is. No allocation; only
    /// the used part of the past is copied.
    pub fn copy_from(&mut self, other: &Self) {
        self.tick = other.tick;
        self.line.copy_from(&other.line);
        self.fade.clone_from(&other.fade);
        self.pending.clone_from(&other.pending);
        self.pending_from = other.pending_from;
        self.schedule.clone_from(&other.schedule);
        self.history.copy_from(&other.history);
        self.sent = other.sent;
        self.range = other.range;
    }

    /// From now on no correction leaves this range, in which the planned input stays. Before, there is none.
    pub fn keep_within(&mut self, range: [f64; 2]) {
        self.range = range;
    }

    /// Ticks up to now.
    pub fn ticks(&self) -> u64 {
        self.tick
    }

    /// One tick: takes the planned setpoint, returns the shaped one, with what a retune added.
    ///
    /// Never allocates, blocks or fails; cost proportional to the number of taps of the trains at
    /// work (one, or up to four while they fade).
    #[inline]
    pub fn step(&mut self, input: Setpoint) -> Setpoint {
        if self.pending.is_some() {
            self.try_install();
        }
        self.tick += 1;
        self.line.push(input);
        self.sent = if self.fade.is_single() && self.schedule.is_idle() {
            self.line.shaped(self.fade.last())
        } else {
            self.blended()
        };
        self.history
            .push(input.position, self.sent.position, self.is_settled());
        self.sent
    }

    /// The output while trains fade or a correction is under way.
    #[cold]
    fn blended(&mut self) -> Setpoint {
        let shaped = self
            .fade
            .output(self.tick, self.sample_time, |age| self.line.at(age));
        let added = self.schedule.output(self.tick, self.sample_time);
        self.fade.tidy(self.tick);
        self.schedule.tidy(self.tick);
        // At rest the sum is left out, so that the target is met to the bit.
        if self.schedule.is_idle() {
            shaped
        } else {
            sum(shaped, added)
        }
    }

    /// Installs a train at rest, as [`crate::ShapingFilter::install`].
    ///
    /// # Errors
    /// [`ShaperError::SampleTimeMismatch`]; [`ShaperError::TooLong`].
    pub fn install(&mut self, train: &GridTrain) -> Result<(), ShaperError> {
        self.check(train)?;
        self.pending = Some(train.clone());
        self.pending_from = 0;
        self.try_install();
        Ok(())
    }

    /// Puts the filter to rest at `position`, not vibrating, with a waiting train installed.
    pub fn reset(&mut self, position: f64) {
        self.line.fill(Setpoint::at_rest(position));
        self.schedule.clear();
        self.history.reset(position);
        self.sent = Setpoint::at_rest(position);
        let last = self
            .pending
            .take()
            .unwrap_or_else(|| self.fade.last().clone());
        self.fade.replace(&last);
    }

    /// Treats the command so far as having left no vibration, as after it has decayed. Returns false, and
    /// changes nothing, while the output still moves.
    ///
    /// Vibration of another mode than the present one, for example with another payload, cannot be replayed
    /// with the present mode.
    pub fn forget(&mut self) -> bool {
        let settled = self.is_settled();
        if settled {
            self.history.reset(self.sent.position);
        }
        settled
    }

    /// Whether the output is constant: the input has been for as long as the trains last, and no
    /// correction is under way.
    pub fn is_settled(&self) -> bool {
        self.schedule.is_idle() && self.line.unchanged_for() >= self.fade.duration_in_ticks()
    }

    /// The train in force, or the one that is fading in.
    pub fn train(&self) -> &GridTrain {
        self.fade.last()
    }

    /// The train that waits for rest.
    pub fn pending(&self) -> Option<&GridTrain> {
        self.pending.as_ref()
    }

    /// Whether a correction is under way or still to come.
    pub fn is_correcting(&self) -> bool {
        !self.schedule.is_idle()
    }

    /// The setpoint last sent.
    pub fn sent(&self) -> Setpoint {
        self.sent
    }

    /// Length of a tick, s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// Longest train, ticks.
    pub fn capacity(&self) -> usize {
        self.line.capacity()
    }

    /// Ticks remembered and looked ahead.
    pub fn horizon(&self) -> usize {
        self.future.len()
    }

    /// The vibration of `mode` now, due to everything sent so far, beside what the planned input
    /// would have caused; from rest at the last [`AdaptiveFilter::reset`].
    ///
    /// `None` where the start of a move that is still remembered in part has been overwritten. Cost
    /// proportional to the horizon.
    pub fn residual(&self, mode: Mode) -> Option<Residual> {
        let [planned, sent] = self.history.left(pole(mode, self.sample_time))?;
        let (shaped, unshaped) = (sent.norm(), planned.norm());
        Some(Residual { shaped, unshaped })
    }

    // Apart from the step: it moves a train of 4 KiB, once.
    #[cold]
    fn try_install(&mut self) {
        let waiting = self.pending.as_ref().map(GridTrain::duration_in_ticks);
        let longest = waiting.map(|ticks| ticks.max(self.fade.duration_in_ticks()));
        if self.tick >= self.pending_from
            && longest.is_some_and(|ticks| self.line.unchanged_for() >= ticks)
            && let Some(train) = self.pending.take()
        {
            self.fade.replace(&train);
        }
    }

    pub(crate) fn check(&self, train: &GridTrain) -> Result<(), ShaperError> {
        self.fade.last().check_same_grid(train.sample_time())?;
        let (ticks, capacity) = (train.duration_in_ticks(), self.capacity());
        if ticks > capacity {
            return Err(ShaperError::TooLong { ticks, capacity });
        }
        Ok(())
    }
}
