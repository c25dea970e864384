//! Rest and motion of the motor side, from its position.

use super::SignalError;
use super::noise::noise_floor;
use super::spline::check_series;
use quell_recording::range;

/// Whether the motor side moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// It rests, or creeps too slowly to matter.
    Rest,
    /// It moves.
    Moving,
}

/// A stretch of rest or of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Which.
    pub motion: Motion,
    /// First instant, s; the start of a rest that follows motion is the start of a free decay.
    pub start: f64,
    /// Last instant, s.
    pub end: f64,
}

/// A rule that tells rest from motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestRule {
    /// Span over which a displacement is taken, and for which it must stay small, s. Short against
    /// the vibration's period, long against the sampling period.
    pub window: f64,
    /// Share of the move's own greatest speed below which a drift is rest. A drift with a share `r` of the
    /// move's speed excites a vibration of the order of `r` of the move's.
    pub drift: f64,
    /// Standard deviation of a position sample, rad.
    pub noise: f64,
    /// Quantisation step, rad; 0 for none.
    pub quantisation: f64,
}

impl RestRule {
    /// 20 ms and 1 %, for a sensor with this noise (standard deviation) and quantisation step, rad.
    pub fn new(noise: f64, quantisation: f64) -> Self {
        Self {
            window: 0.02,
            drift: 0.01,
            noise,
            quantisation,
        }
    }

    /// The rule for a recorded position, with its estimated noise and quantisation.
    pub fn from_values(values: &[f64]) -> Self {
        let floor = noise_floor(values);
        Self::new(floor.standard_deviation, floor.quantisation.unwrap_or(0.0))
    }

    /// The same for a position that may be without noise: a displacement below a share of the range is no motion.
    pub fn above(self, share: f64, values: &[f64]) -> Self {
        Self {
            noise: self.noise.max(share * range(values)),
            ..self
        }
    }

    /// The displacement that noise alone exceeds once in 1.7 million samples: 5 standard deviations of a
    /// difference (variance 2), plus the rounding.
    fn threshold(&self) -> f64 {
        5.0 * 2f64.sqrt() * self.noise + self.quantisation
    }
}

/// Positions kept: a window of 20 ms at up to 8 kHz.
const HISTORY: usize = 161;

/// Detects rest and motion sample by sample; does not allocate, block or fail.
///
/// Motion begins when the displacement over the window exceeds the larger of twice the noise
/// threshold and three times the drift that the last move allows; it ends when it has stayed below
/// the larger of the noise threshold and that drift for a window. A window never spans fewer than 3
/// sampling periods; at rates above 8 kHz it is shorter than asked for.
#[derive(Clone, Debug)]
pub struct RestDetector {
    rule: RestRule,
    history: [(f64, f64); HISTORY],
    count: usize,
    motion: Motion,
    /// Greatest displacement over a window in the present or last motion.
    peak: f64,
    quiet_since: Option<(f64, usize)>,
    changed: f64,
}

impl RestDetector {
    /// A detector that assumes rest until it detects motion.
    pub fn new(rule: RestRule) -> Self {
        Self {
            rule,
            history: [(0.0, 0.0); HISTORY],
            count: 0,
            motion: Motion::Rest,
            peak: 0.0,
            quiet_since: None,
            changed: f64::NEG_INFINITY,
        }
    }

    /// Takes a motor position (s, rad) and returns whether the motor moves. A sample that is not finite or does
    /// not advance is ignored.
    pub fn observe(&mut self, time: f64, position: f64) -> Motion {
        let advances = self.count == 0 || time > self.history[(self.count - 1) % HISTORY].0;
        if !(time.is_finite() && position.is_finite() && advances) {
            return self.motion;
        }
        self.history[self.count % HISTORY] = (time, position);
        self.count += 1;
        let displacement = self.displacement(time, position);
        match self.motion {
            Motion::Rest => self.watch_for_motion(time, displacement),
            Motion::Moving => self.watch_for_rest(time, displacement),
        }
        self.motion
    }

    /// Present state.
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Start of the present state, s; minus infinity before the first change. A rest begins with the first of
    /// the quiet samples that led to it, so that it is detected one window later.
    pub fn since(&self) -> f64 {
        self.changed
    }

    /// Start of the free decay, s: while the axis rests after a move.
    pub fn free_decay_from(&self) -> Option<f64> {
        (self.motion == Motion::Rest && self.changed.is_finite()).then_some(self.changed)
    }

    /// Displacement over the window.
    fn displacement(&self, time: f64, position: f64) -> f64 {
        let back = |lag: usize| self.history[(self.count - 1 - lag) % HISTORY];
        let kept = self.count.min(HISTORY) - 1;
        let mut lag = kept.min(3);
        while lag < kept && time - back(lag + 1).0 <= self.rule.window * (1.0 + 1e-9) {
            lag += 1;
        }
        (position - back(lag).1).abs()
    }

    fn watch_for_motion(&mut self, time: f64, displacement: f64) {
        let limit = (2.0 * self.rule.threshold()).max(3.0 * self.rule.drift * self.peak);
        if displacement > limit {
            self.motion = Motion::Moving;
            self.peak = displacement;
            self.quiet_since = None;
            self.changed = time;
        }
    }

    fn watch_for_rest(&mut self, time: f64, displacement: f64) {
        self.peak = self.peak.max(displacement);
        if displacement > self.rule.threshold().max(self.rule.drift * self.peak) {
            self.quiet_since = None;
            return;
        }
        let (start, samples) = self.quiet_since.unwrap_or((time, 0));
        self.quiet_since = Some((start, samples + 1));
        if samples + 1 >= 3 && time - start >= self.rule.window * (1.0 - 1e-9) {
            self.motion = Motion::Rest;
            self.changed = start;
        }
    }
}

/// Phases of rest and motion of a recorded motor position.
///
/// # Errors
/// [`SignalError`] for series of different lengths, values that are not finite or a time that does
/// not advance.
pub fn phases(time: &[f64], position: &[f64], rule: RestRule) -> Result<Vec<Phase>, SignalError> {
    check_series("motor position", time, position)?;
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else {
        return Ok(Vec::new());
    };
    let mut detector = RestDetector::new(rule);
    let mut phases = vec![Phase {
        motion: Motion::Rest,
        start: first,
        end: last,
    }];
    for (&t, &x) in time.iter().zip(position) {
        let before = detector.motion();
        if detector.observe(t, x) != before {
            let start = detector.since();
            if let Some(open) = phases.last_mut() {
                open.end = start;
            }
            phases.push(Phase {
                motion: detector.motion(),
                start,
                end: last,
            });
        }
    }
    phases.retain(|phase| phase.end > phase.start);
    Ok(phases)
}

/// Starts of the free decays: of each rest that follows a motion and lasts at least `shortest` s.
///
/// # Errors
/// As [`phases`].
pub fn free_decays(
    time: &[f64],
    position: &[f64],
    rule: RestRule,
    shortest: f64,
) -> Result<Vec<Phase>, SignalError> {
    let first = time.first().copied().unwrap_or(0.0);
    let mut decays = phases(time, position, rule)?;
    decays.retain(|p| p.motion == Motion::Rest && p.start > first && p.end - p.start >= shortest);
    Ok(decays)
}
