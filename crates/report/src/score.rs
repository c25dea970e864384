//! A score in words, the same everywhere.

use super::case::Case;
use super::head::times;
use super::shown::Shown;
use quell_diagnosis::{Carrying, Judgement, Score};
use quell_page::{digits, fixed, significant};

/// Why the noise in a score is not that of the diagnosis.
pub const NOISE_ANEW: &str = "The noise in a score is measured anew, for its recording and beside its model: what changes from \
    sample to sample without a pattern counts as noise, also where the model misses it.";

impl Case<'_> {
    /// Whether a score shows another noise than the diagnosis, to two digits.
    pub fn noise_differs(&self) -> bool {
        let fit = &self.diagnosis.fit;
        let scores = fit.scores.iter().flat_map(|own| [&own.before, &own.after]);
        let mut scores = scores.filter(|score| score.unit == fit.unit);
        scores.any(|score| digits(score.noise_std, 2) != digits(fit.noise_std, 2))
    }
}

/// One line: error in the unit of the recording and relative to the noise, the explained share of the
/// recording, and how it was fitted if not to the whole in one piece.
pub fn score_line(score: &Score) -> String {
    line_in(score, &Shown::from(score.shown()))
}

/// The line of a score and, where the recording has a payload, one with the link's inertia fitted.
pub fn judgement_lines(judgement: &Judgement) -> String {
    let line = score_line(&judgement.score);
    match &judgement.with_payload {
        Some(carried) => format!("{line}\n{}", carrying_line(carried)),
        None => line,
    }
}

fn carrying_line(carried: &Carrying) -> String {
    format!(
        "A model does not say with which payload it holds; this recording has the payload {:?}. With {} times the model's \
         inertia of the link: {}",
        carried.payload,
        significant(carried.relative_inertia, 4),
        score_line(&carried.score)
    )
}

/// The same beside other misfits: in the unit in which they are told.
pub fn score_beside(score: &Score, case: &Case) -> String {
    match score.unit == case.diagnosis.fit.unit {
        true => line_in(score, &case.misfit_unit()),
        false => score_line(score),
    }
}

fn line_in(score: &Score, shown: &Shown) -> String {
    let unit = &shown.unit;
    let [rms, noise] = [score.rms, score.noise_std].map(|value| shown.number(value));
    let how = match (score.first, score.windows) {
        (Some(first), _) => format!("; a free run, its start fitted to the first {first} samples"),
        (None, 1) => String::new(),
        (None, windows) => format!("; in {windows} windows, each with a start of its own"),
    };
    format!(
        "rms {rms} {unit}, {} times the noise of {noise} {unit}; fit {} %{how}",
        times(score.rms_over_noise),
        fixed(score.fit_percent, 2)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_has_one_unit_and_says_how() {
        let score = Score {
            rms: 6.12e-6,
            unit: "rad".into(),
            noise_std: 6e-6,
            rms_over_noise: 1.02,
            fit_percent: 99.21,
            samples: 100,
            motion: 1e-3,
            windows: 1,
            first: None,
        };
        let expected = "rms 6.12 urad, 1.02 times the noise of 6 urad; fit 99.21 %";
        assert_eq!(score_line(&score), expected);
        let windows = Score {
            windows: 7,
            ..score.clone()
        };
        assert!(score_line(&windows).ends_with("; in 7 windows, each with a start of its own"));
        let first = Score {
            first: Some(20),
            ..score
        };
        assert!(score_line(&first).ends_with("fitted to the first 20 samples"));
    }
}
