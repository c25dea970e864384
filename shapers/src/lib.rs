#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod adaptive_filter;
mod ahead;
mod buffer;
mod candidates;
mod correction;
mod cross_fade;
mod double_oracle;
mod ei;
mod equal_ripple;
mod error;
mod filter;
mod game;
mod grid;
mod history;
mod impulse_train;
mod limits;
mod linear;
mod modal_state;
mod mode;
mod mzv;
mod optimal;
mod path;
mod pole;
mod recommend;
mod replay;
mod residual;
mod retune;
mod retune_outcome;
mod smooth_step;
mod three_hump_ei;
mod two_hump_ei;
mod um_zv;
mod uncertain_mode;
mod vibration;
mod zv;
mod zvd;
mod zvdd;

pub use adaptive_filter::{AdaptiveFilter, Buffers, Residual};
pub use buffer::{Buffer, OwnBuffer};
pub use correction::CORRECTED_MODES;
pub use ei::Ei;
pub use equal_ripple::HUMP_TOLERANCE;
pub use error::ShaperError;
pub use filter::Setpoint;
#[cfg(feature = "alloc")]
pub use filter::ShapingFilter;
pub use grid::{GridTrain, Tap};
pub use history::Entry;
pub use impulse_train::{Impulse, ImpulseTrain, TRAIN_CAPACITY};
pub use limits::{MotionLimits, PeakRatios, peak_ratios, shaped_peak_ratios};
pub use mode::{Mode, ModeError};
pub use mzv::Mzv;
pub use optimal::Optimal;
pub use path::common_train;
pub use recommend::{
    Candidate, Criterion, Reason, Recommendation, Requirements, Standing, recommend,
};
pub use residual::{Band, insensitivity, residual_curve, residual_vibration, same_instant_ratio};
pub use retune_outcome::{Correction, Refusal, Retune, RetuneOutcome};
pub use three_hump_ei::ThreeHumpEi;
pub use two_hump_ei::TwoHumpEi;
pub use um_zv::UmZv;
pub use uncertain_mode::UncertainMode;
pub use zv::Zv;
pub use zvd::Zvd;
pub use zvdd::Zvdd;

/// A rule that makes an impulse train for a mode.
///
/// To add one: a file with a (unit) struct that implements this trait, and a line in [`SHAPERS`].
pub trait Shaper: Sync {
    /// Short stable name, as typed on a command line.
    fn name(&self) -> &'static str;

    /// Name as the literature writes it.
    fn title(&self) -> &'static str;

    /// One sentence: what it does and what it costs.
    fn summary(&self) -> &'static str;

    /// The impulse train for a mode: times in s from 0, amplitudes with sum 1. No allocation.
    ///
    /// # Errors
    /// [`ShaperError`] where the damping ratio is above what the rule can be solved for.
    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError>;

    /// The train with its taps on a grid of `sample_time` seconds, its zeros at the mode kept exact.
    ///
    /// # Errors
    /// As [`Shaper::design`], and where half the damped period is below two ticks.
    fn on_grid(&self, mode: Mode, sample_time: f64) -> Result<GridTrain, ShaperError> {
        GridTrain::split(&self.design(mode)?, mode, sample_time)
    }

    /// The train for a mode that is known only so well. Most rules design for the estimate, however well that is
    /// known.
    ///
    /// # Errors
    /// As [`Shaper::design`].
    fn design_for(&self, known: &UncertainMode) -> Result<ImpulseTrain, ShaperError> {
        self.design(known.mode)
    }

    /// [`Shaper::design_for`] with its taps on a grid, as [`Shaper::on_grid`].
    ///
    /// # Errors
    /// As [`Shaper::on_grid`].
    fn on_grid_for(
        &self,
        known: &UncertainMode,
        sample_time: f64,
    ) -> Result<GridTrain, ShaperError> {
        self.on_grid(known.mode, sample_time)
    }

    /// Whether every amplitude is positive, so that the limits of a move survive the shaping.
    fn is_convex(&self) -> bool {
        true
    }
}

/// Every shaper.
pub static SHAPERS: &[&dyn Shaper] = &[
    &Zv,
    &Mzv,
    &Zvd,
    &Ei,
    &Zvdd,
    &TwoHumpEi,
    &ThreeHumpEi,
    &UmZv,
    &Optimal::TYPICAL,
];

/// The shaper of that [`Shaper::name`].
pub fn shaper_by_name(name: &str) -> Option<&'static dyn Shaper> {
    SHAPERS.iter().copied().find(|shaper| shaper.name() == name)
}

/// The train of one rule for several modes: the convolution of the trains for each.
///
/// # Errors
/// As [`Shaper::design_for`], and where a train cannot hold so many impulses.
pub fn design_for_all(
    shaper: &dyn Shaper,
    known: &[UncertainMode],
) -> Result<ImpulseTrain, ShaperError> {
    let next = |train: ImpulseTrain, known| train.convolve(&shaper.design_for(known)?);
    known.iter().try_fold(ImpulseTrain::identity(), next)
}
