//! Estimators of a vibratory mode, on-line, sample by sample.
//!
//! Each method is one file and one line in [`ESTIMATORS`]; command line, documents and tests loop over that
//! table.
//!
//! All methods share one model of the deformation `delta = y - u` of a joint whose motor side is at
//! `u` (measured) and whose link is at `y`:
//! ```text
//! delta'' + 2 xi w delta' + w^2 delta = -u''             damper across the joint
//! delta'' + 2 xi w delta' + w^2 delta = -u'' - 2 xi w u'  damper to ground
//! ```
//! Both have static gain 0: at rest only a free decay is left.

use quell_shapers::Mode;

mod algebraic;
mod convergence;
pub(crate) mod correlation;
mod cramer_rao;
mod least_squares;
mod likelihood;
mod modal_response;
pub mod offline;
mod quadrature;
mod regression;
mod settings;
mod super_twisting;
mod two_mode_likelihood;

pub use algebraic::{Algebraic, AlgebraicForm};
pub use convergence::{Convergence, SETTLED};
pub use cramer_rao::{Bound, cramer_rao, two_mode_cramer_rao};
pub use likelihood::Likelihood;
pub use quadrature::Integral;
pub use settings::Settings;
pub use super_twisting::SuperTwisting;
pub use two_mode_likelihood::TwoModeLikelihood;

/// One aligned sample of the axis, on the sensor's stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time: f64,
    /// Motor-side position `u`, rad.
    pub motor_position: f64,
    /// `delta = y - u`, link position minus motor-side position, rad.
    pub deformation: f64,
}

impl Sample {
    /// Whether all three numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.time.is_finite() && self.motor_position.is_finite() && self.deformation.is_finite()
    }
}

/// The estimate after the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time of the last sample used, s.
    pub time: f64,
    /// `omega_n` and `xi`.
    pub mode: Mode,
    /// One standard deviation of `omega_n`, rad/s.
    pub natural_frequency_std: f64,
    /// One standard deviation of `xi`.
    pub damping_ratio_std: f64,
    /// Static gain `K`, dimensionless.
    pub gain: f64,
    /// One standard deviation of `K`.
    pub gain_std: f64,
    /// Whether the estimate has settled (see the estimator's convergence rule).
    pub converged: bool,
}

/// A method that learns a mode from a stream of samples.
///
/// `observe` runs at the tick: it does not allocate, block or fail; a sample that is not finite or
/// does not advance in time is ignored.
pub trait Estimator: Send {
    /// Takes one sample.
    fn observe(&mut self, sample: Sample);
    /// The present estimate, once there is one.
    fn estimate(&self) -> Option<Estimate>;
    /// A second mode beside that of the estimate, if the method looks for one and has found one.
    fn further(&self) -> Option<Estimate> {
        None
    }
    /// Share `p_2 / (p_1 + p_2)` of that second mode in what the sensor sees of a motion of the motor side. A free decay does
    /// not tell it.
    fn further_share(&self) -> Option<f64> {
        None
    }
    /// Amplitude of the part of the deformation, rad, that is neither explained by the estimate nor white
    /// noise; 0 where the method does not know it.
    fn unexplained(&self) -> f64 {
        0.0
    }
    /// Discards every sample, to begin a new window.
    fn restart(&mut self);
}

/// One line of the table of estimators.
#[derive(Clone, Copy, Debug)]
pub struct EstimatorEntry {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Its description, in one sentence.
    pub summary: &'static str,
    /// Whether its model holds while the motor side moves. If not, it must be fed from the start of the free
    /// decay on.
    pub uses_motion: bool,
    /// Whether its standard deviations are those of its error, so that they can be used before convergence. If
    /// not, they are the spread of its recent estimates.
    pub states_error: bool,
    /// Builds an estimator; allocates all its memory.
    pub build: fn(&Settings) -> Box<dyn Estimator>,
}

/// All estimators, the best of this project first.
pub const ESTIMATORS: &[EstimatorEntry] = &[
    EstimatorEntry {
        name: "likelihood",
        summary: "maximum likelihood of the output error, the motion included",
        uses_motion: true,
        states_error: true,
        build: |settings| Box::new(Likelihood::new(settings)),
    },
    EstimatorEntry {
        name: "two_mode_likelihood",
        summary: "the same of two modes, where the likelihood ratio excludes one",
        uses_motion: true,
        states_error: true,
        build: |settings| Box::new(TwoModeLikelihood::new(settings)),
    },
    EstimatorEntry {
        name: "algebraic",
        summary: "algebraic method on the equation that holds in motion and at rest",
        uses_motion: true,
        states_error: false,
        build: |settings| Box::new(Algebraic::new(settings, AlgebraicForm::Energetic)),
    },
    EstimatorEntry {
        name: "algebraic_integrated",
        summary: "the same with one more integration",
        uses_motion: true,
        states_error: false,
        build: |settings| Box::new(Algebraic::new(settings, AlgebraicForm::Integrated)),
    },
    EstimatorEntry {
        name: "algebraic_paper",
        summary: "algebraic method with the three unknowns of the paper, free decay only",
        uses_motion: false,
        states_error: false,
        build: |settings| Box::new(Algebraic::new(settings, AlgebraicForm::Paper)),
    },
    EstimatorEntry {
        name: "super_twisting",
        summary: "super-twisting observer and regression, free decay only",
        uses_motion: false,
        states_error: false,
        build: |settings| Box::new(SuperTwisting::new(settings)),
    },
];

/// The estimator of that name.
pub fn estimator(name: &str) -> Option<&'static EstimatorEntry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}
