//! What a diagnosis says: the content of `diagnosis.json`.

use super::error::DiagnosisError;
use super::law_curve::{LawCurve, LearnedLaw};
use super::thresholds::CREDIBLE;
use quell_model::effects::Catalogue;
use quell_recording::Preferred;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much of the mismatch is explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model, its parameters refitted, explains the recording down to the noise.
    NoMismatch,
    /// One explanation stands out.
    Named,
    /// Several explanations fit alike, or the search was ended before all were tried.
    Ambiguous,
    /// The named physics is there, and something besides it.
    PartlyExplained,
    /// Something is missing that the catalogue does not explain.
    Unexplained,
    /// The recording cannot contradict the model: nothing moved, or too little to be seen above the noise.
    NotExcited,
}

impl Verdict {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoMismatch => "no_mismatch",
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::PartlyExplained => "partly_explained",
            Self::Unexplained => "unexplained",
            Self::NotExcited => "not_excited",
        }
    }
}

/// A fitted number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedParameter {
    /// Name.
    pub name: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// 95 % confidence interval.
    pub ci95: [f64; 2],
}

/// One piece of physics that the model lacks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// Name in the catalogue.
    pub effect: String,
    /// Its place in the chain.
    pub place: String,
    /// Probability that it is missing: of all explanations together that have it, by their marginal likelihoods, among
    /// those that were fitted.
    pub probability: f64,
    /// Its parameters.
    pub parameters: Vec<FittedParameter>,
    /// In words: how much larger the residual of the held-out data is without it, and its odds.
    pub evidence: String,
    /// Effects that the data cannot tell from it.
    pub alternatives: Vec<String>,
    /// The recordings in which it happened, one for each time; empty where it is the machine's. The better model does
    /// not have what happened.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub happened_in: Vec<String>,
    /// Its law as a curve, where it is a static one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<LawCurve>,
}

impl Finding {
    /// Whether no other explanation is credible: neither another effect in its place, nor none.
    pub fn is_certain(&self) -> bool {
        self.alternatives.is_empty() && self.probability >= CREDIBLE
    }

    /// Its name in a sentence; of a learned law with the named law that stays inside its band.
    ///
    /// # Example
    /// ```
    /// use quell_diagnosis::Finding;
    /// use quell_model::effects::Catalogue;
    /// let finding = r#"{
    ///     "effect": "learned_spring", "place": "transmission", "probability": 0.99, "parameters": [],
    ///     "evidence": "", "alternatives": [], "curve": {
    ///         "law": "spring force", "unit": "N", "coordinate": "deformation", "coordinate_unit": "m",
    ///         "points": [], "values": [], "ci95": [], "learned": {
    ///             "sentence": "The learned spring is odd.", "nearest": {
    ///                 "effect": "cubic_stiffness", "parameters": [], "values": [], "chi_squared": 0.8,
    ///                 "outside": []
    ///             }
    ///         }
    ///     }
    /// }"#;
    /// let finding: Finding = serde_json::from_str(finding).unwrap();
    /// assert_eq!(finding.title(Catalogue::default()), "learned spring, like cubic stiffness");
    /// ```
    pub fn title(&self, catalogue: Catalogue) -> String {
        let title = catalogue.title(&self.effect);
        let nearest = self.learned().and_then(|learned| learned.nearest.as_ref());
        match nearest.filter(|nearest| nearest.is_inside()) {
            Some(nearest) => format!("{title}, like {}", catalogue.title(&nearest.effect)),
            None => title,
        }
    }

    /// What is known of the curve of a learned law.
    pub fn learned(&self) -> Option<&LearnedLaw> {
        self.curve.as_ref()?.learned.as_ref()
    }
}

/// Where the mismatch sits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Location {
    /// Place in the chain, or none if there is nothing to place.
    pub place: Option<String>,
    /// Phases of the motion in which it is strong: `acceleration`, `cruise`, `reversal`, `settling`, `rest`.
    pub phases: Vec<String>,
    /// Stretches of time in which it is strong, s.
    pub times_s: Vec<[f64; 2]>,
    /// Coordinate that it follows best, such as `deformation rate`.
    pub coordinate: Option<String>,
    /// Frequency that stands out of the residual, Hz.
    pub frequency_hz: Option<f64>,
}

/// How well a model fits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quality {
    /// Root mean square residual where it was fitted.
    pub train_rms: f64,
    /// Root mean square residual where it was not.
    pub held_out_rms: f64,
    /// The latter over the noise.
    pub held_out_over_noise: f64,
}

/// Fit before and after; all numbers are 0 where nothing varied and nothing was fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Standard deviation of the noise of the first output.
    pub noise_std: f64,
    /// Its unit.
    pub unit: String,
    /// The given model, its parameters refitted.
    pub before: Quality,
    /// The model with the findings.
    pub after: Quality,
    /// The better model: without the findings that happened. None where nothing happened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_alone: Option<Quality>,
    /// The same two models on each recording that was looked at whole, as `score` says it; none
    /// where nothing was fitted.
    #[serde(default)]
    pub scores: Vec<Scored>,
}

impl Fit {
    /// The unit in which its misfits are told beside a motion of this size: that of the motion, or a smaller one.
    pub fn shown(&self, motion: f64) -> Preferred {
        Preferred::of_misfit(&self.unit, motion, self.noise_std.max(self.after.train_rms))
    }
}

/// The error of a prediction, as `score` says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// Root mean square error of the first output, in `unit`.
    pub rms: f64,
    /// Its unit.
    pub unit: String,
    /// Standard deviation of the noise.
    pub noise_std: f64,
    /// The former over the latter.
    pub rms_over_noise: f64,
    /// `100 (1 - |error| / |recorded - mean|)`, percent; of a joint's link position, whose deformation is what
    /// the model is about, that of the deformation.
    pub fit_percent: f64,
    /// Samples that the error is of.
    pub samples: usize,
    /// Largest value of the first output as it is drawn: beside it the error is told.
    pub motion: f64,
    /// Windows in which the motion was replayed, each with a start of its own; 1 is in one piece.
    pub windows: usize,
    /// Samples at the start of each output to which alone offsets, clocks and start were fitted, and which are not in
    /// the error; none where they were fitted to all.
    pub first: Option<usize>,
}

impl Score {
    /// The unit in which error and noise are told: that of the motion, or a smaller one.
    pub fn shown(&self) -> Preferred {
        Preferred::of_misfit(&self.unit, self.motion, self.noise_std.max(self.rms))
    }
}

/// How well the model predicts one recording, before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scored {
    /// Name of the recording.
    pub recording: String,
    /// Whether nothing was fitted to it.
    pub held_out: bool,
    /// The given model, its parameters refitted.
    pub before: Score,
    /// The model with the findings, as it is written.
    pub after: Score,
}

/// One proposed move, jerk-limited, from rest to rest. The first starts where the first recording does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProposedMove {
    /// Target relative to where the move starts, in `unit`.
    pub distance: f64,
    /// Greatest speed, `unit`/s.
    pub speed: f64,
    /// Greatest acceleration, `unit`/s^2.
    pub acceleration: f64,
    /// Greatest jerk, `unit`/s^3.
    pub jerk: f64,
    /// Pause after it, s.
    pub pause_s: f64,
    /// `rad` or `m`.
    pub unit: String,
}

/// The move that would tell two explanations apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextMove {
    /// One sentence.
    pub why: String,
    /// The two: the best explanation, and that of its equals which is hardest to tell from it.
    pub separates: [String; 2],
    /// Chi-squared by which the second would fail at least, were the first right, beyond what the
    /// recordings show already; in units of what the best explanation leaves of them.
    pub expected_score: f64,
    /// What to do; empty where no motion separates them (`expected_score` is below 10), and where the
    /// input is not a motion: `why` then says what to repeat.
    pub moves: Vec<ProposedMove>,
}

/// One line of the ranking.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Effect, or effects joined by ` + `.
    pub effect: String,
    /// Place of the (last) effect.
    pub place: String,
    /// Log of its marginal likelihood over that of the refitted model; positive is better.
    pub log_evidence: f64,
    /// Its probability among the explanations that were looked at.
    pub probability: f64,
    /// Held-out chi-squared over that of the refitted model.
    pub held_out_ratio: f64,
    /// Why it is refused, whatever its evidence: its probability is then 0. None where it is not.
    #[serde(default)]
    pub refused: Option<String>,
}

impl Diagnosis {
    /// Whether every number is finite: what is written can then be read, and a page shows no number that is none.
    ///
    /// # Errors
    /// [`DiagnosisError::NotFinite`].
    pub fn check(&self) -> Result<(), DiagnosisError> {
        let told = |error: serde_json::Error| DiagnosisError::NotFinite(error.to_string());
        // JSON has no such numbers: they are written as nothing, and nothing is not read back as a number.
        let written = serde_json::to_string(self).map_err(told)?;
        serde_json::from_str::<Self>(&written).map_err(told)?;
        Ok(())
    }
}

/// The whole diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Diagnosis {
    /// How much is explained.
    pub verdict: Verdict,
    /// One sentence, as an engineer would write it.
    pub summary: String,
    /// The best explanation, strongest effect first.
    pub findings: Vec<Finding>,
    /// Where the mismatch sits.
    pub location: Location,
    /// Fit before and after.
    pub fit: Fit,
    /// What was fitted besides: clock offsets, output offsets, the model's own parameters.
    pub nuisances: BTreeMap<String, f64>,
    /// 95 % confidence intervals of those of them that are parameters of the model.
    #[serde(default)]
    pub nuisances_ci95: BTreeMap<String, [f64; 2]>,
    /// What to do to be sure.
    pub next_move: Option<NextMove>,
    /// The ranking, best first; those with a parameter at the end of its range come after all others, whatever their
    /// evidence.
    pub candidates: Vec<Candidate>,
    /// Whether the search was ended, by a time limit or by its own limit of work, while there was more to try. All
    /// probabilities are then among what was fitted.
    #[serde(default)]
    pub ended_early: bool,
    /// What the reader should know: irregular clocks, parameters at their bounds, what was not tried.
    pub remarks: Vec<String>,
}
