//! The batch fit of the whole recording: searched in a part of it, then continued over all.

use super::input_noise::White;
use quell_control::estimators::offline::{BatchFit, batch_fit, batch_fit_near};
use quell_control::estimators::{Sample, Settings};

/// Settings with the memory that a recording supports, and its batch fit.
///
/// The vibration is set free again after every one and a half periods if that halves the residual's variance,
/// with each fit's number of unknowns allowed for; with hundreds of samples chance changes it by a tenth. If
/// so, the measured motion of the motor side does not explain the vibration. The vibration that the noise of the
/// motor side's sensor makes in the model counts for that noise alone ([`White`]).
pub fn trusted_memory(samples: &[Sample], settings: Settings) -> (Settings, Option<BatchFit>) {
    let Some(carried) = batch_fit(samples, &settings, true) else {
        return (settings, None);
    };
    let mut period = carried.mode.damped_period();
    let white = White::of(samples, &carried, &settings);
    let left = white.map_or(carried.residual_std, |white| white.fit.residual_std);
    let limit = 0.5 * left.powi(2);
    let mut shorter = None;
    // Twice, since the frequency for the first memory may come from a poor fit.
    for _ in 0..2 {
        let settings = Settings {
            memory: 1.5 * period,
            ..settings
        };
        let Some(fit) = batch_fit(samples, &settings, true) else {
            break;
        };
        period = fit.mode.damped_period();
        shorter = Some((settings, fit));
    }
    let (settings, fit) = shorter
        .filter(|(_, fit)| fit.residual_std.powi(2) < limit)
        .unwrap_or((settings, carried));
    (settings, Some(fit))
}

/// The fit of a part continued over all samples, and the samples of the result. If it leaves the range of
/// frequencies, the fit of the part is kept.
pub fn follow<'a>(
    samples: &'a [Sample],
    part: &'a [Sample],
    settings: &Settings,
    fit: Option<BatchFit>,
) -> (&'a [Sample], Option<BatchFit>) {
    if part.len() == samples.len() {
        return (samples, fit);
    }
    let near = |fit: &BatchFit| batch_fit_near(samples, settings, fit.mode);
    let whole = fit.as_ref().and_then(near);
    match (whole, fit) {
        (None, Some(fit)) => (part, Some(fit)),
        (whole, _) => (samples, whole),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_shapers::Mode;

    /// A vibration of 8 Hz at 200 Hz.
    fn ringing(count: usize) -> Vec<Sample> {
        let sample = |k: usize| Sample {
            time: k as f64 / 200.0,
            motor_position: 0.0,
            deformation: (8.0 * core::f64::consts::TAU * k as f64 / 200.0).cos(),
        };
        (0..count).map(sample).collect()
    }

    fn around(hertz: f64) -> Settings {
        let belief = Mode::from_hertz(hertz, 0.05).unwrap();
        Settings::around(belief, 1.0 / 200.0)
    }

    #[test]
    fn a_fit_that_the_whole_leads_astray_stays_that_of_the_part() {
        let samples = ringing(400);
        let part = &samples[..200];
        let fit = batch_fit(part, &around(8.0), true);
        let (fitted, whole) = follow(&samples, part, &around(8.0), fit.clone());
        let hertz = whole.map(|fit| fit.mode.hertz()).unwrap();
        assert_eq!(fitted.len(), samples.len());
        assert!((hertz - 8.0).abs() < 1e-6, "{hertz}");
        // Nothing that ends near 8 Hz is in the range.
        let (fitted, of_part) = follow(&samples, part, &around(0.5), fit.clone());
        assert_eq!(fitted.len(), part.len());
        assert_eq!(of_part, fit);
        assert_eq!(
            follow(&samples, part, &around(8.0), None),
            (&samples[..], None)
        );
    }
}
