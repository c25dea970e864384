//! What may stand in the place of a finding, with the probabilities.

use super::document::{Candidate, Diagnosis, Finding};
use super::thresholds::CREDIBLE;
use quell_model::effects::Catalogue;

/// The explanations of a diagnosis, shared among what one finding may be.
///
/// Each explanation belongs to one share: to the finding, if it has the effect or a law that has it as a limit, as a lag of
/// second order has one of first order; else to the alternatives that it has, else to nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct InPlace<'f> {
    /// Name and probability of the finding's effect and of each alternative, the likeliest first.
    pub effects: Vec<(&'f str, f64)>,
    /// Probability of the explanations that have none of these.
    pub nothing: f64,
}

impl<'f> InPlace<'f> {
    fn of(candidates: &[Candidate], finding: &'f Finding, catalogue: Catalogue) -> Self {
        let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
        let mut effects: Vec<(&str, f64)> = names.map(|name| (name.as_str(), 0.0)).collect();
        let mut nothing = 0.0;
        for candidate in candidates {
            let has = |name: &str| has(candidate, name, catalogue);
            let is_finding = has(&finding.effect);
            let mut is_any = false;
            for (k, (name, probability)) in effects.iter_mut().enumerate() {
                if (k == 0) == is_finding && has(name) {
                    *probability += candidate.probability;
                    is_any = true;
                }
            }
            if !is_any {
                nothing += candidate.probability;
            }
        }
        effects.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self { effects, nothing }
    }
}

impl Diagnosis {
    /// What may stand in the place of a finding.
    pub fn in_place<'f>(&self, finding: &'f Finding, catalogue: Catalogue) -> InPlace<'f> {
        InPlace::of(&self.candidates, finding, catalogue)
    }

    /// Whether it is credible that nothing stands in the place of a finding.
    pub fn may_be_absent(&self, finding: &Finding, catalogue: Catalogue) -> bool {
        match finding.alternatives.is_empty() {
            true => !finding.is_certain(),
            false => self.in_place(finding, catalogue).nothing > 1.0 - CREDIBLE,
        }
    }
}

/// Whether an explanation has an effect, or a law that has it as a limit.
fn has(candidate: &Candidate, name: &str, catalogue: Catalogue) -> bool {
    let simple = catalogue.effect(name);
    candidate.effect.split(" + ").any(|own| {
        let law = catalogue.effect(own);
        own == name || law.zip(simple).is_some_and(|(law, it)| law.contains(it))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn explanations(all: &[(&str, f64)]) -> Vec<Candidate> {
        let one = |&(effect, probability): &(&str, f64)| Candidate {
            effect: effect.into(),
            place: "sensor".into(),
            log_evidence: 0.0,
            probability,
            held_out_ratio: 1.0,
            refused: None,
        };
        all.iter().map(one).collect()
    }

    fn finding(alternatives: &[&str]) -> Finding {
        serde_json::from_value(json!({
            "effect": "sensor_lag", "place": "sensor", "probability": 0.9, "parameters": [], "evidence": "",
            "alternatives": alternatives
        }))
        .unwrap()
    }

    /// A law that has the finding as its limit is no absence, and no explanation is counted twice for one finding.
    #[test]
    fn the_shares_are_of_one_whole() {
        let own = finding(&["viscous_drag"]);
        let all = explanations(&[
            ("sensor_lag", 0.5),
            ("sensor_lag_second_order", 0.2),
            ("sensor_lag + viscous_drag", 0.15),
            ("viscous_drag", 0.1),
            ("backlash", 0.05),
        ]);
        let told = InPlace::of(&all, &own, Catalogue::default());
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let [(first, lag), (second, drag)] = told.effects[..] else {
            panic!("{told:?}");
        };
        assert_eq!([first, second], ["sensor_lag", "viscous_drag"]);
        assert!(near(lag, 0.85) && near(drag, 0.1) && near(told.nothing, 0.05));
    }
}
