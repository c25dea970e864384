//! The recommended estimate of a recording, and how far the others contradict it.

use super::{Identification, OffLine, Run, scatter};
use quell_control::estimators::{ESTIMATORS, Estimate, EstimatorEntry};
use quell_shapers::UncertainMode;

/// Why an estimate is recommended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Maximum likelihood, with the motion as known input.
    Motion,
    /// Maximum likelihood on the free decay alone, as the motion does not explain the deformation.
    Decay,
    /// Two modes, as the likelihood ratio excludes one.
    TwoModes,
    /// The off-line fit, as maximum likelihood found no mode on-line.
    OffLine,
}

/// The recommended estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recommended {
    /// The estimator, or `batch_fit`.
    pub method: &'static str,
    /// Its mode. The deviations combine the method's own and [`between`](Self::between).
    pub mode: UncertainMode,
    /// The second mode, if it has two.
    pub further: Option<UncertainMode>,
    /// Share of the second mode in the deformation, where the motion as known input tells it.
    pub further_share: Option<f64>,
    /// A second mode that improves the fit of the whole, but does not show in the strongest free decay.
    pub doubted: Option<UncertainMode>,
    /// Scatter between the fits of separate stretches beyond their own deviations and chance: one standard deviation of
    /// `omega_n`, rad/s, and of `xi`. 0 where they agree.
    pub between: [f64; 2],
    /// Whether the free decays agree, so that a scatter is that of the whole, with its motion as known input.
    pub decays_agree: bool,
    /// Why this estimate.
    pub why: Why,
}

impl Recommended {
    /// Its one mode, or its two.
    pub fn modes(&self) -> impl Iterator<Item = UncertainMode> + use<> {
        [Some(self.mode), self.further].into_iter().flatten()
    }
}

impl Identification {
    /// The recommended estimate; `None` where no method found a mode.
    ///
    /// Maximum likelihood is efficient: no unbiased method has a smaller deviation on the same samples. It is
    /// used on all samples that its model explains.
    pub fn recommended(&self) -> Option<Recommended> {
        let told = |method, mode: UncertainMode, further: Option<UncertainMode>, why| {
            let (between, decays_agree) = self.between(further.map(|_| method));
            let widen = |mode: UncertainMode| UncertainMode {
                natural_frequency_std: mode.natural_frequency_std.hypot(between[0]),
                damping_ratio_std: mode.damping_ratio_std.hypot(between[1]),
                ..mode
            };
            Recommended {
                method,
                mode: widen(mode),
                further: further.map(widen),
                further_share: None,
                doubted: None,
                between,
                decays_agree,
                why,
            }
        };
        let ran = |line: &'static EstimatorEntry, index: usize| {
            let run = self.quoted(index)?;
            let result = run.estimator(line.name)?;
            let share = result.further_share.filter(|_| !run.is_free_decay);
            Some((line.name, result.estimate?, result.further, share))
        };
        let mut stating = ESTIMATORS
            .iter()
            .enumerate()
            .filter(|own| own.1.states_error);
        let two = stating
            .clone()
            .filter_map(|(index, line)| ran(line, index))
            .find(|own| own.2.is_some());
        let doubted = two.filter(|own| !self.rings_with_two(own.0));
        if let Some((name, first, further, further_share)) = two.filter(|_| doubted.is_none()) {
            let further = further.as_ref().map(uncertain);
            return Some(Recommended {
                further_share,
                ..told(name, uncertain(&first), further, Why::TwoModes)
            });
        }
        let doubted = doubted.and_then(|own| own.2.as_ref().map(uncertain));
        let why = match self.known_input_holds {
            Some(false) => Why::Decay,
            _ => Why::Motion,
        };
        if let Some((name, one, ..)) = stating.find_map(|(index, line)| ran(line, index)) {
            let best = told(name, uncertain(&one), None, why);
            return Some(Recommended { doubted, ..best });
        }
        let fit = self.reference().batch()?;
        let mode = UncertainMode {
            mode: fit.mode,
            natural_frequency_std: fit.natural_frequency_std.unwrap_or(0.0),
            damping_ratio_std: fit.damping_ratio_std.unwrap_or(0.0),
        };
        Some(told(fit.method, mode, None, Why::OffLine))
    }

    /// Standard deviations of `omega_n` (rad/s) and `xi` for display beside an estimate, which may contradict
    /// the recommended one.
    ///
    /// A method that states its error gets this and the scatter between separate stretches. The others state
    /// the spread of their recent estimates, which may be far below their error; they get also their distance
    /// from the recommended estimate.
    pub fn deviations(&self, estimate: &Estimate, states_error: bool) -> [f64; 2] {
        let own = [estimate.natural_frequency_std, estimate.damping_ratio_std];
        let Some(best) = self.recommended() else {
            return own;
        };
        let off = |mode: &UncertainMode| {
            [
                estimate.mode.natural_frequency() - mode.mode.natural_frequency(),
                estimate.mode.damping_ratio() - mode.mode.damping_ratio(),
            ]
        };
        let more = match states_error {
            true => best.between,
            // Of two modes the nearer one counts.
            false => {
                let distances = best.modes().map(|mode| off(&mode));
                distances
                    .min_by(|a, b| a[0].abs().total_cmp(&b[0].abs()))
                    .unwrap_or_default()
            }
        };
        [own[0].hypot(more[0]), own[1].hypot(more[1])]
    }

    /// Whether a second mode, found with the motion as known input, also shows in the strongest free decay. An
    /// error of the input, such as a clock offset, looks like a mode in motion, but does not continue in a
    /// decay. True where there is no free decay.
    fn rings_with_two(&self, method: &str) -> bool {
        let decay = self.best_decay.and_then(|best| self.free_decays.get(best));
        decay.is_none_or(|run| {
            run.estimator(method)
                .is_some_and(|own| own.further.is_some())
        })
    }

    /// Scatter between the fits of free decays, and of the whole where its input holds, beyond their own deviations; and
    /// whether the decays alone have none. The fits are batch fits; of two modes those of the method that found them,
    /// since one mode fitted to two is another one in each stretch.
    fn between(&self, two: Option<&str>) -> ([f64; 2], bool) {
        let fit = |run: &Run| match two {
            Some(name) => run.two_modes(name),
            None => run.batch().and_then(known),
        };
        let decays: Vec<_> = self.free_decays.iter().filter_map(fit).collect();
        let whole = match self.known_input_holds {
            Some(true) => fit(&self.whole),
            _ => None,
        };
        let all: Vec<_> = decays.iter().copied().chain(whole).collect();
        let scatter = |fits: &[UncertainMode]| {
            let frequency = fits
                .iter()
                .map(|fit| (fit.mode.natural_frequency(), fit.natural_frequency_std));
            let damping = fits
                .iter()
                .map(|fit| (fit.mode.damping_ratio(), fit.damping_ratio_std));
            [
                scatter::between(&frequency.collect::<Vec<_>>()),
                scatter::between(&damping.collect::<Vec<_>>()),
            ]
        };
        let (own, with) = (scatter(&decays), scatter(&all));
        ([own[0].max(with[0]), own[1].max(with[1])], own == [0.0; 2])
    }
}

impl Run {
    /// The first of two modes that a method found here, if it found two.
    fn two_modes(&self, name: &str) -> Option<UncertainMode> {
        let own = self.estimator(name).filter(|own| own.further.is_some())?;
        own.estimate.as_ref().map(uncertain)
    }
}

/// The mode of an off-line method that knows its deviations.
pub(super) fn known(line: &OffLine) -> Option<UncertainMode> {
    Some(UncertainMode {
        mode: line.mode,
        natural_frequency_std: line.natural_frequency_std?,
        damping_ratio_std: line.damping_ratio_std?,
    })
}

/// The mode of an estimate with its deviations.
fn uncertain(estimate: &Estimate) -> UncertainMode {
    UncertainMode {
        mode: estimate.mode,
        natural_frequency_std: estimate.natural_frequency_std,
        damping_ratio_std: estimate.damping_ratio_std,
    }
}
