//! The recommended estimate of a recording, and how far the others contradict it.

use super::{Identification, Run};
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
    /// Scatter between the fits of separate stretches beyond their own deviations: one standard deviation of
    /// `omega_n`, rad/s, and of `xi`. 0 where they agree.
    pub between: [f64; 2],
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
        let between = self.between();
        let widen = |mode: UncertainMode| UncertainMode {
            natural_frequency_std: mode.natural_frequency_std.hypot(between[0]),
            damping_ratio_std: mode.damping_ratio_std.hypot(between[1]),
            ..mode
        };
        let told = |method, mode: UncertainMode, further: Option<UncertainMode>, why| Recommended {
            method,
            mode: widen(mode),
            further: further.map(widen),
            further_share: None,
            doubted: None,
            between,
            why,
        };
        let ran = |line: &'static EstimatorEntry, index: usize| {
            let run = self.quoted(index)?;
            let result = run.estimator(line.name)?;
            Some((
                line.name,
                result.estimate?,
                result.further,
                !run.is_free_decay,
            ))
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
        if let Some((name, first, further, moves)) = two.filter(|_| doubted.is_none()) {
            // The gains of all modes together follow the motor side.
            let share = further.map(|own| own.gain / (first.gain + own.gain));
            let further = further.as_ref().map(uncertain);
            return Some(Recommended {
                further_share: share.filter(|_| moves),
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

    /// Scatter between the batch fits of free decays, and of the whole where its input holds, beyond their own
    /// deviations.
    fn between(&self) -> [f64; 2] {
        let whole = match self.known_input_holds {
            Some(true) => Some(&self.whole),
            _ => None,
        };
        let fits: Vec<_> = self
            .free_decays
            .iter()
            .chain(whole)
            .filter_map(Run::batch)
            .collect();
        let frequency = fits
            .iter()
            .filter_map(|fit| Some((fit.mode.natural_frequency(), fit.natural_frequency_std?)));
        let damping = fits
            .iter()
            .filter_map(|fit| Some((fit.mode.damping_ratio(), fit.damping_ratio_std?)));
        [
            paule_mandel(&frequency.collect::<Vec<_>>()),
            paule_mandel(&damping.collect::<Vec<_>>()),
        ]
    }
}

/// The mode of an estimate with its deviations.
fn uncertain(estimate: &Estimate) -> UncertainMode {
    UncertainMode {
        mode: estimate.mode,
        natural_frequency_std: estimate.natural_frequency_std,
        damping_ratio_std: estimate.damping_ratio_std,
    }
}

/// The standard deviation between values `x_i`, beside their own `s_i`: the `t >= 0` for which
/// `sum (x_i - m)^2 / (s_i^2 + t^2) = n - 1` about their weighted mean `m`; 0 where they agree as they are (Paule and
/// Mandel, J. Research of the National Bureau of Standards 87 (1982) 377).
fn paule_mandel(values: &[(f64, f64)]) -> f64 {
    let values: Vec<_> = values
        .iter()
        .filter(|(x, s)| x.is_finite() && s.is_finite() && *s > 0.0)
        .collect();
    if values.len() < 2 {
        return 0.0;
    }
    let excess = |between: f64| {
        let weight = |s: f64| 1.0 / (s * s + between * between);
        let sum: f64 = values.iter().map(|(_, s)| weight(*s)).sum();
        let mean = values.iter().map(|(x, s)| weight(*s) * x).sum::<f64>() / sum;
        let chi: f64 = values
            .iter()
            .map(|(x, s)| weight(*s) * (x - mean).powi(2))
            .sum();
        chi - (values.len() - 1) as f64
    };
    if excess(0.0) <= 0.0 {
        return 0.0;
    }
    // It falls as `t` grows, and at the range of the values it is below 0: their variance is smaller than its square.
    let ends = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (x, _)| {
            [low.min(*x), high.max(*x)]
        });
    let (mut low, mut high) = (0.0, ends[1] - ends[0]);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match excess(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::paule_mandel;

    #[test]
    fn values_that_agree_have_nothing_between_them() {
        assert_eq!(paule_mandel(&[(1.0, 0.1), (1.05, 0.1), (0.98, 0.2)]), 0.0);
        assert_eq!(paule_mandel(&[(1.0, 0.1)]), 0.0);
    }

    /// Of two values with the same `s` the equation has a closed form: `t^2 = (x_1 - x_2)^2 / 2 - s^2`.
    #[test]
    fn val_two_values_that_contradict_each_other() {
        let between = paule_mandel(&[(1.0, 0.1), (2.0, 0.1)]);
        assert!(
            (between - (0.5_f64 - 0.01).sqrt()).abs() < 1e-9,
            "{between}"
        );
    }
}
