//! Reliability: of the claims with a probability of 90 %, 90 % should be true.
//!
//! Source: A. H. Murphy, R. L. Winkler, Applied Statistics 26 (1977).

use super::judgement::is_true;
use super::{Rate, Score};
use serde_json::{Value, json};

/// Edges of the bins: tenths, and finer above nine of them.
const EDGES: [f64; 13] = [
    0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0,
];
/// Claims from which a bin is judged.
pub const ENOUGH: usize = 20;
/// Allowed deviation of a bin, percent.
pub const OFF: f64 = 5.0;

/// Claims of about the same probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// From this probability, percent.
    pub low: f64,
    /// To below this one (100 included), percent.
    pub high: f64,
    /// The mean of the probabilities that were said, percent.
    pub said: f64,
    /// How many of the claims were so.
    pub so: Rate,
}

impl Bin {
    /// Whether the claimed probability is within [`OFF`] of the observed share; `None` with fewer claims than
    /// [`ENOUGH`].
    pub fn is_reliable(&self) -> Option<bool> {
        let reliable = (self.said - self.so.percent()).abs() <= OFF;
        (self.so.of >= ENOUGH).then_some(reliable)
    }

    /// As `90-95 %`.
    pub fn range(&self) -> String {
        format!("{:.0}-{:.0} %", self.low, self.high)
    }

    /// `yes`, `no`, or `too few`.
    pub fn verdict(&self) -> &'static str {
        match self.is_reliable() {
            Some(true) => "yes",
            Some(false) => "no",
            None => "too few",
        }
    }

    pub(super) fn to_json(self) -> Value {
        json!({
            "low": self.low,
            "high": self.high,
            "said": self.said,
            "so": self.so.to_json(),
            "reliable": self.is_reliable(),
        })
    }
}

impl Score {
    /// Claimed probabilities and observed shares; bins without a claim are left out.
    pub fn reliability(&self) -> Vec<Bin> {
        let mut bins = vec![(0.0, Rate::default()); EDGES.len() - 1];
        for case in &self.cases {
            for claim in &case.verdict.claims {
                if !(0.0..=1.0).contains(&claim.probability) {
                    continue;
                }
                let above = EDGES.partition_point(|edge| *edge <= claim.probability);
                let (sum, so) = &mut bins[above.min(EDGES.len() - 1) - 1];
                *sum += claim.probability;
                *so = so.and(is_true(&claim.effect, &case.truth));
            }
        }
        let bin = |(edges, (sum, so)): (&[f64], (f64, Rate))| Bin {
            low: 100.0 * edges[0],
            high: 100.0 * edges[1],
            said: 100.0 * sum / so.of as f64,
            so,
        };
        let all = EDGES.windows(2).zip(bins).map(bin);
        all.filter(|bin| bin.so.of > 0).collect()
    }
}
