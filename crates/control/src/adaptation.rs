//! Decides whether an estimate becomes the mode to shape for, or states why not.
//!
//! Three questions are asked in this order:
//! 1. Is the estimate plausible?
//! 2. Is it certain enough? The train designed for it must hold its tolerance two standard deviations away.
//! 3. Does it matter? The present command must leave more than a new one would, by more than the dead band and
//!    by more than the estimate's own uncertainty explains.
//!
//! A mode that differs much from the one learned before must also persist for half a period. Estimators look
//! back as long before they call an estimate converged, so that two windows without overlap agree.
//! they call an estimate converged, so that two windows without overlap agree.

use crate::estimators::Estimate;
use crate::learning::Hold;
use quell_shapers::{GridTrain, Mode, Tap, UncertainMode};
use std::f64::consts::PI;

/// The settings of an adaptation: the plausible range, and the thresholds for a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptationSettings {
    /// Plausible natural frequencies `[from, to]`, rad/s.
    pub natural_frequency: [f64; 2],
    /// Plausible damping ratios `[from, to]`.
    pub damping_ratio: [f64; 2],
    /// Residual vibration V that uncertainty may add, as a fraction of the unshaped. The field's
    /// 5 % (Singer and Seering 1990 draw insensitivity at it).
    pub tolerance: f64,
    /// Residual vibration V of the train in force below which a new train is not worth a retune.
    pub dead_band: f64,
    /// Relative change of `omega_n` against the last learned mode that is accepted at once; a larger one must
    /// persist for half a period of the new mode.
    pub largest_step: f64,
}

impl AdaptationSettings {
    /// Settings around a belief: frequencies from a quarter to four times the believed one, and all damping
    /// ratios at which a shaper still helps. Dead band 1 %, tolerance 5 %; steps above 10 % must persist.
    pub fn around(belief: Mode) -> Self {
        let omega = belief.natural_frequency();
        Self {
            natural_frequency: [0.25 * omega, 4.0 * omega],
            damping_ratio: [0.0, 0.35],
            tolerance: 0.05,
            dead_band: 0.01,
            largest_step: 0.10,
        }
    }
}

/// The answer of [`Adaptation::consider`] to an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// Shape for this mode from now on.
    Accept(Mode),
    /// Keep the train in force.
    Keep(Reason),
}

/// Why an estimate does not change the train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// The estimator has not settled.
    NotConverged,
    /// `omega_n` (rad/s) or `xi` lies outside the plausible range.
    Implausible(Mode),
    /// Within two standard deviations the new train would leave this fraction of the unshaped
    /// vibration, which is above the tolerance.
    Uncertain(f64),
    /// The present command leaves only this fraction more than a new one would.
    DeadBand(f64),
    /// The residual of the present command may be an error of the estimate: three standard deviations of it are
    /// this fraction.
    NotSignificant(f64),
    /// The train was solved from what earlier moves have taught, and is not changed in motion.
    Held(Hold),
    /// The estimated mode leaves this fraction of the vibration unexplained, and a new train would remove no
    /// more than that.
    Unexplained(f64),
    /// The mode has jumped by this relative step and has not yet persisted for half a period, twice the window over which estimates must agree.
    Unconfirmed(f64),
}

/// Accepts or refuses estimates; remembers the last mode that was learned.
#[derive(Clone, Debug)]
pub struct Adaptation {
    settings: AdaptationSettings,
    learned: Option<Mode>,
    jump: Option<(Mode, f64)>,
}

impl Adaptation {
    /// An adaptation that has learned nothing yet.
    pub fn new(settings: AdaptationSettings) -> Self {
        Self {
            settings,
            learned: None,
            jump: None,
        }
    }

    /// The last mode that was accepted, or that confirmed the present one.
    pub fn learned(&self) -> Option<Mode> {
        self.learned
    }

    /// Whether a train should be designed for an estimate: it has settled, and is plausible.
    ///
    /// # Errors
    /// [`Reason::NotConverged`], [`Reason::Implausible`].
    pub fn screen(&self, estimate: &Estimate) -> Result<(), Reason> {
        match estimate.converged {
            false => Err(Reason::NotConverged),
            true if !self.plausible(estimate.mode) => Err(Reason::Implausible(estimate.mode)),
            true => Ok(()),
        }
    }

    /// How well the mode of an estimate is known for as long as its train is in force.
    ///
    /// This is the estimate's own variance, plus that of a change too small to cause a retune: one that leaves
    /// less than the dead band. For a small change the shortest train, two impulses half a period apart, leaves
    /// `V = pi/2 |d omega| / omega` and `V = pi/2 |d xi|`. So two standard deviations must cover at least a
    /// change of `2/pi` of the dead band.
    pub fn known(&self, estimate: &Estimate) -> UncertainMode {
        let unseen = 0.5 * (2.0 / PI) * self.settings.dead_band;
        let mode = estimate.mode;
        let omega = mode.natural_frequency();
        UncertainMode {
            mode,
            natural_frequency_std: estimate.natural_frequency_std.hypot(unseen * omega),
            damping_ratio_std: estimate.damping_ratio_std.hypot(unseen),
        }
    }

    /// Whether a train suits the mode of an estimate: it leaves less than the dead band there, and no more than
    /// the tolerance two standard deviations away.
    pub fn suits(&self, train: &GridTrain, estimate: &Estimate) -> bool {
        residual(train, estimate.mode) < self.settings.dead_band
            && worst_within_two_sigma(estimate, train) <= self.settings.tolerance
    }

    /// Judges an estimate that was [screened](Adaptation::screen).
    ///
    /// `next` is the train designed for it. `excess` gives what the present command leaves of a mode minus what
    /// a new one would leave, as a fraction of the unshaped vibration. Bounded work, at most five calls of
    /// `excess`, no allocation.
    pub fn consider(
        &mut self,
        estimate: &Estimate,
        next: &GridTrain,
        mut excess: impl FnMut(Mode) -> f64,
    ) -> Decision {
        let mode = estimate.mode;
        if let Err(reason) = self.certain(estimate, next) {
            return Decision::Keep(reason);
        }
        let at_estimate = excess(mode);
        if at_estimate < self.settings.dead_band {
            (self.learned, self.jump) = (Some(mode), None);
            return Decision::Keep(Reason::DeadBand(at_estimate));
        }
        let explained = doubt_of(estimate, at_estimate, excess);
        if at_estimate < explained {
            self.jump = None;
            return Decision::Keep(Reason::NotSignificant(explained));
        }
        if let Some(step) = self.unconfirmed_jump(mode, estimate.time) {
            return Decision::Keep(Reason::Unconfirmed(step));
        }
        self.accept(mode)
    }

    /// Whether the command under way may be corrected for an estimate that was [screened](Adaptation::screen):
    /// it is certain enough for its train `next`, and no jump that has yet to persist.
    pub fn may_correct(&mut self, estimate: &Estimate, next: &GridTrain) -> bool {
        let certain = self.certain(estimate, next).is_ok();
        certain
            && self
                .unconfirmed_jump(estimate.mode, estimate.time)
                .is_none()
    }

    /// Records that the command was corrected for a mode.
    pub fn accept(&mut self, mode: Mode) -> Decision {
        self.learned = Some(mode);
        Decision::Accept(mode)
    }

    /// Whether the train designed for an estimate holds its tolerance two standard deviations away.
    fn certain(&self, estimate: &Estimate, next: &GridTrain) -> Result<(), Reason> {
        let tolerance = self.settings.tolerance;
        // The bound is cheap, and enough for a well-known estimate.
        if most_within_two_sigma(estimate, next) <= tolerance {
            return Ok(());
        }
        let doubt = worst_within_two_sigma(estimate, next) - residual(next, estimate.mode);
        match doubt > tolerance {
            true => Err(Reason::Uncertain(doubt)),
            false => Ok(()),
        }
    }

    fn plausible(&self, mode: Mode) -> bool {
        let [low, high] = self.settings.natural_frequency;
        let [least, most] = self.settings.damping_ratio;
        (low..=high).contains(&mode.natural_frequency())
            && (least..=most).contains(&mode.damping_ratio())
    }

    /// The relative step from the learned mode, if it is large and younger than half a period.
    fn unconfirmed_jump(&mut self, mode: Mode, time: f64) -> Option<f64> {
        let step = relative_step(self.learned?, mode);
        if step <= self.settings.largest_step {
            self.jump = None;
            return None;
        }
        match self.jump {
            Some((candidate, since))
                if relative_step(candidate, mode) <= self.settings.largest_step =>
            {
                (time - since < 0.5 * mode.damped_period()).then_some(step)
            }
            _ => {
                self.jump = Some((mode, time));
                Some(step)
            }
        }
    }
}

/// V of a train at a mode.
pub(crate) fn residual(train: &GridTrain, mode: Mode) -> f64 {
    train.residual_vibration(mode.natural_frequency(), mode.damping_ratio())
}

fn relative_step(from: Mode, to: Mode) -> f64 {
    (to.natural_frequency() / from.natural_frequency() - 1.0).abs()
}

/// Standard deviations by which an excess counts as significant. As a complex number that is
/// Gaussian in both parts it exceeds them by chance once in 90 times (`exp(-4.5)`), and it is judged
/// some ten times a move.
const SIGNIFICANT: f64 = 3.0;

/// The vibration that the estimate's uncertainty alone may leave, [`SIGNIFICANT`] standard
/// deviations of it.
///
/// The residual is the magnitude of a complex number `r(omega, xi)` that is linear near the estimate,
/// so that `|r' d|^2 = (|r(+d)|^2 + |r(-d)|^2) / 2 - |r(0)|^2` for a step `d` of either.
fn doubt_of(estimate: &Estimate, centre: f64, mut left: impl FnMut(Mode) -> f64) -> f64 {
    let mode = estimate.mode;
    let steps = [
        (SIGNIFICANT * estimate.natural_frequency_std, 0.0),
        (0.0, SIGNIFICANT * estimate.damping_ratio_std),
    ];
    let mut square = 0.0;
    for (across, along) in steps {
        let mut sum = 0.0;
        for sign in [-1.0, 1.0] {
            let omega = mode.natural_frequency() + sign * across;
            let xi = (mode.damping_ratio() + sign * along).max(0.0);
            match Mode::new(omega, xi) {
                Ok(step) => sum += left(step).powi(2),
                Err(_) => return f64::INFINITY,
            }
        }
        square += (0.5 * sum - centre * centre).max(0.0);
    }
    square.sqrt()
}

/// The largest V of `train` over the corners of two standard deviations of frequency and damping.
fn worst_within_two_sigma(estimate: &Estimate, train: &GridTrain) -> f64 {
    largest_at_corners(estimate, |corner| residual(train, corner))
}

/// A bound on the change of V of `train` at those corners: `sum |A_i| (t_n - t_i) |lambda' - lambda|`, since
/// `exp(lambda t)` changes by at most `t` times as much as `lambda` for decaying modes.
fn most_within_two_sigma(estimate: &Estimate, train: &GridTrain) -> f64 {
    let pole = |mode: Mode| (mode.decay_rate(), mode.damped_frequency());
    let (rate, turn) = pole(estimate.mode);
    let furthest = largest_at_corners(estimate, |corner| {
        let (other_rate, other_turn) = pole(corner);
        (other_rate - rate).powi(2) + (other_turn - turn).powi(2)
    });
    let time = |tap: &Tap| f64::from(tap.delay) * train.sample_time();
    let age = |tap: &Tap| tap.amplitude.abs() * (train.duration() - time(tap));
    furthest.sqrt() * train.taps().iter().map(age).sum::<f64>()
}

/// The largest value of `of` at the corners of two standard deviations of frequency and damping; infinity where
/// a corner is no mode.
fn largest_at_corners(estimate: &Estimate, of: impl Fn(Mode) -> f64) -> f64 {
    let mode = estimate.mode;
    let mut largest: f64 = 0.0;
    for across in [-2.0, 2.0] {
        for along in [-2.0, 2.0] {
            let omega = mode.natural_frequency() + across * estimate.natural_frequency_std;
            let xi = mode.damping_ratio() + along * estimate.damping_ratio_std;
            match Mode::new(omega, xi.max(0.0)) {
                Ok(corner) => largest = largest.max(of(corner)),
                Err(_) => return f64::INFINITY,
            }
        }
    }
    largest
}
