//! What is said where the search was ended while there was more to try.

use super::document::{Diagnosis, Verdict};

/// Remark on a search that was ended early.
const UNTRIED: &str = "The search was ended before all that it would have tried was fitted. The probabilities are among what \
    was fitted; another explanation, or a further effect, may be missing.";

impl Diagnosis {
    /// Says that explanations were left untried. No explanation then stands out: `Named` becomes `Ambiguous`.
    pub(super) fn end_early(&mut self) {
        if std::mem::replace(&mut self.ended_early, true) {
            return;
        }
        if self.verdict == Verdict::Named {
            self.verdict = Verdict::Ambiguous;
        }
        let sentence = self.summary.trim_end_matches('.');
        self.summary = format!("{sentence}; the search was ended before all was tried.");
        self.remarks.push(UNTRIED.into());
    }
}
