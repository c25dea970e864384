//! A shaper designed for modes on a grid, and its residual vibration.

use super::trial::Simulated;
use crate::cli::shaping;
use crate::identification::ToldMode;
use quell_shapers::{
    GridTrain, ImpulseTrain, Mode, SHAPERS, Shaper, ShaperError, insensitivity, residual_vibration,
};

/// Residual vibration that defines the insensitivity.
pub const TOLERANCE: f64 = 0.05;

/// A shaper and the result of its design.
pub struct Candidate {
    /// The shaper.
    pub shaper: &'static dyn Shaper,
    /// Its design, or the reason why it cannot be designed for these modes on this grid.
    pub design: Result<Design, String>,
}

/// A train on the grid.
pub struct Design {
    /// The taps.
    pub train: GridTrain,
    /// Width of the band with `V <= 0.05` around the first mode, over its frequency.
    pub insensitivity: Option<f64>,
    /// The robot's move with it, if the robot is simulated.
    pub simulated: Option<Simulated>,
    impulses: ImpulseTrain,
    modes: Vec<Mode>,
}

/// Every shaper, designed for all the modes at once.
pub fn all(modes: &[ToldMode], sample_time: f64) -> Vec<Candidate> {
    let candidate = |&shaper: &&'static dyn Shaper| Candidate {
        shaper,
        design: Design::new(shaper, modes, sample_time).map_err(|error| error.to_string()),
    };
    SHAPERS.iter().map(candidate).collect()
}

impl Design {
    fn new(shaper: &dyn Shaper, told: &[ToldMode], sample_time: f64) -> Result<Self, ShaperError> {
        let known = told.iter().map(ToldMode::or_believed);
        let train = shaping::train(shaper, known, sample_time)?;
        let modes: Vec<Mode> = told.iter().map(|told| told.mode).collect();
        let impulses = train.to_impulses();
        let mut insensitive = None;
        if let Some(mode) = modes.first() {
            let (frequency, damping_ratio) = (mode.natural_frequency(), mode.damping_ratio());
            insensitive = insensitivity(&impulses, damping_ratio, frequency, TOLERANCE)?;
        }
        let insensitivity = insensitive.map(|band| band.width());
        Ok(Self {
            train,
            insensitivity,
            simulated: None,
            impulses,
            modes,
        })
    }

    /// Largest residual vibration of the modes, with the frequencies of all modes `1 + error` times the
    /// believed ones.
    pub fn residual(&self, error: f64) -> f64 {
        let residual = |mode: &Mode| {
            let frequency = (1.0 + error) * mode.natural_frequency();
            residual_vibration(&self.impulses, frequency, mode.damping_ratio())
        };
        self.modes.iter().map(residual).fold(0.0, f64::max)
    }
}
