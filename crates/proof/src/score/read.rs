//! Scores read back, so that a campaign can be run in shares.

use super::{Judged, Score};
use crate::truth::Truth;
use crate::verdict::Verdict;
use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

/// Why a score cannot be read.
#[derive(Debug, Error)]
pub enum ScoreError {
    /// No JSON, or none of a score.
    #[error("no score: {0}")]
    Json(#[from] serde_json::Error),
    /// A case whose truth does not say what was hidden.
    #[error("case {0} does not say its \"effect\"")]
    Truth(String),
}

#[derive(Deserialize)]
struct Document {
    each: Vec<Each>,
}

#[derive(Deserialize)]
struct Each {
    case: String,
    truth: Value,
    verdict: Verdict,
    oracle_over_noise: Option<f64>,
}

impl Score {
    /// The score that a text of [`to_json`](Self::to_json) holds; its cases are judged anew.
    ///
    /// # Errors
    /// [`ScoreError`].
    pub fn from_json(text: &str) -> Result<Self, ScoreError> {
        let document: Document = serde_json::from_str(text)?;
        let judged = |each: Each| {
            let truth = Truth::from_json(&each.truth);
            let truth = truth.ok_or_else(|| ScoreError::Truth(each.case.clone()))?;
            let oracle = each.oracle_over_noise;
            Ok(Judged::new(each.case, truth, each.verdict, oracle))
        };
        let cases = document.each.into_iter().map(judged);
        Ok(Self {
            cases: cases.collect::<Result<_, ScoreError>>()?,
        })
    }

    /// All cases of several scores; their names begin with the number of the score.
    pub fn joined(scores: impl IntoIterator<Item = Self>) -> Self {
        let numbered = scores.into_iter().zip(1..);
        let cases = numbered.flat_map(|(score, number)| {
            score.cases.into_iter().map(move |mut case| {
                case.name = format!("{number}/{}", case.name);
                case
            })
        });
        Self {
            cases: cases.collect(),
        }
    }
}
