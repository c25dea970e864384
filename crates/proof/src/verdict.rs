//! The answer of a diagnosis to a case, as far as it is scored.

use serde::{Deserialize, Deserializer, Serialize};

/// A diagnosis in a few words.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// `no_mismatch`, `named`, `ambiguous`, `partly_explained`, `unexplained`, `not_excited`; `failed` if the
    /// diagnosis did not finish.
    pub kind: String,
    /// The best explanation, strongest first.
    pub findings: Vec<FindingSummary>,
    /// What was said with a probability: findings, and alternatives where they have one.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// Rms over the noise on the part of the recording that was kept apart, before.
    #[serde(deserialize_with = "or_not_a_number")]
    pub before_over_noise: f64,
    /// The same with the findings in the model.
    #[serde(deserialize_with = "or_not_a_number")]
    pub after_over_noise: f64,
    /// Rms over the noise of the resulting model on moves that it has never seen.
    #[serde(deserialize_with = "or_not_a_number")]
    pub test_rms_over_noise: f64,
    /// Time of the diagnosis, s.
    pub seconds: f64,
}

/// One finding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FindingSummary {
    /// Name in the catalogue.
    pub effect: String,
    /// Its place.
    pub place: String,
    /// Effects that the data cannot tell from it.
    pub alternatives: Vec<String>,
    /// Its parameters.
    pub parameters: Vec<ParameterSummary>,
}

/// An effect and how probable it is said to be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Name in the catalogue.
    pub effect: String,
    /// From 0 to 1.
    pub probability: f64,
}

/// A parameter with its interval, SI.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterSummary {
    /// Name.
    pub name: String,
    /// Value.
    pub value: f64,
    /// 95 % confidence interval.
    pub ci95: [f64; 2],
}

impl Verdict {
    /// A diagnosis that did not finish.
    pub fn failed(seconds: f64) -> Self {
        Self {
            kind: "failed".into(),
            before_over_noise: f64::NAN,
            after_over_noise: f64::NAN,
            test_rms_over_noise: f64::NAN,
            seconds,
            ..Self::default()
        }
    }

    /// Whether it says that something is missing.
    pub fn detects(&self) -> bool {
        !["no_mismatch", "not_excited", "failed"].contains(&self.kind.as_str())
    }

    /// Whether it does not commit to a name.
    pub fn doubts(&self) -> bool {
        ["ambiguous", "partly_explained", "unexplained"].contains(&self.kind.as_str())
    }

    /// The name that it gives first.
    pub fn first_name(&self) -> Option<&str> {
        self.findings.first().map(|finding| finding.effect.as_str())
    }
}

/// JSON has no NaN: `null` stands for it.
fn or_not_a_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl FindingSummary {
    /// The name and its alternatives, each once.
    pub fn set(&self) -> Vec<&str> {
        let mut set = vec![self.effect.as_str()];
        for other in &self.alternatives {
            if !set.contains(&other.as_str()) {
                set.push(other);
            }
        }
        set
    }
}
