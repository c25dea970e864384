//! The search for a pair that explains the window better, repeated while the window grows.

use quell_shapers::Mode;

use super::descent::{Descent, Ground};
use super::grid::{Grid, REACH, STARTS};
use crate::estimators::Settings;
use crate::estimators::likelihood::noise::Noise;
use crate::estimators::likelihood::region::{Region, log_point};

/// Growth of the window between two searches. The evidence of a second mode grows at least linearly with the
/// window, and all searches together cost some three and a half times the last.
const GROWTH: f64 = 1.4;
/// Damping ratios of the grid's modes. Over a few periods modes are alike if their damping ratios differ by
/// less than a few hundredths.
const DAMPING: (f64, f64) = (0.01, 0.1);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Waiting for a longer window.
    Waiting,
    /// The grid is advanced along the window.
    Grid,
    /// Descents from one start after another.
    Descents,
}

/// The middle of the grid. It is the fitted mode, moved so that the grid stays within the range of the
/// settings. If that range is an octave to either side, as around a belief, it is the middle of the range.
fn centre(settings: &Settings, mode: Mode) -> Mode {
    let (low, high) = settings.frequency_range;
    let (first, last) = (low * REACH, high / REACH);
    let w = match first < last {
        true => mode.natural_frequency().max(first).min(last),
        false => (low * high).sqrt(),
    };
    let damping = mode.damping_ratio().clamp(DAMPING.0, DAMPING.1);
    Mode::new(w, damping).unwrap_or(mode)
}

/// Starts from a grid, and descents from them.
#[derive(Clone, Debug)]
pub struct Search {
    stage: Stage,
    grid: Grid,
    starts: [Option<[Mode; 2]>; STARTS],
    descent: Option<Descent>,
    /// Length of the window, in samples, at which the next search begins.
    next: usize,
}

impl Search {
    /// A search; allocates all its memory.
    pub fn new(settings: &Settings, mode: Mode) -> Self {
        Self {
            stage: Stage::Waiting,
            grid: Grid::new(centre(settings, mode), settings.sample_time),
            starts: [None; STARTS],
            descent: None,
            next: 0,
        }
    }

    /// Aborts the search; the next one may begin at once.
    pub fn restart(&mut self) {
        self.stage = Stage::Waiting;
        self.starts = [None; STARTS];
        self.descent = None;
        self.next = 0;
    }

    /// Processes the new samples of the window.
    pub fn follow(&mut self, ground: &Ground<'_>) {
        if let Some(descent) = &mut self.descent {
            descent.follow(ground);
        }
    }

    /// Continues around the one mode that is fitted, within the budget; returns a descent that has converged.
    pub fn advance(
        &mut self,
        ground: &Ground<'_>,
        (mode, noise): (Mode, Noise),
        budget: &mut usize,
    ) -> Option<Descent> {
        if self.stage == Stage::Waiting && ground.window.samples().len() >= self.next {
            let centre = centre(ground.settings, mode);
            self.grid.begin(centre, ground.settings.sample_time);
            self.stage = Stage::Grid;
        }
        if self.stage == Stage::Grid {
            let (window, priors) = (ground.window, ground.priors);
            if !self.grid.advance(window, priors, noise.variance, budget) {
                return None;
            }
            self.starts = self.grid.starts();
            self.stage = Stage::Descents;
        }
        match self.stage {
            Stage::Descents => self.descend(ground, noise, budget),
            _ => None,
        }
    }

    /// Descends from the present start, or from the next one.
    fn descend(
        &mut self,
        ground: &Ground<'_>,
        noise: Noise,
        budget: &mut usize,
    ) -> Option<Descent> {
        if self.descent.is_none() {
            let Some(start) = self.starts.iter_mut().find_map(Option::take) else {
                self.stage = Stage::Waiting;
                self.next = (GROWTH * ground.window.samples().len() as f64) as usize + 1;
                return None;
            };
            // The grid may exceed the range a little.
            let region = Region::new(ground.settings.frequency_range);
            let start = start.map(|mode| region.mode(log_point(mode)).unwrap_or(mode));
            self.descent = Some(Descent::new(start, noise, ground.settings.sample_time));
        }
        let descent = self.descent.as_mut()?;
        descent.advance(ground, budget);
        if descent.is_hopeless(ground) {
            // The other starts have a higher cost than this one had.
            self.descent = None;
            self.starts = [None; STARTS];
            return None;
        }
        self.descent.take_if(|descent| descent.rests())
    }
}
