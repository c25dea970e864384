//! The static law of a finding as a curve, with how well it is known.

use serde::{Deserialize, Serialize};

/// A static law over its coordinate, where the motion was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LawCurve {
    /// What the law gives, such as `spring force`.
    pub law: String,
    /// Its unit.
    pub unit: String,
    /// What it depends on, such as `deformation`.
    pub coordinate: String,
    /// The coordinate's unit.
    pub coordinate_unit: String,
    /// Points of the coordinate, in rising order. Outside of them nothing is known.
    pub points: Vec<f64>,
    /// The law at the points.
    pub values: Vec<f64>,
    /// 95 % band at the points.
    pub ci95: Vec<[f64; 2]>,
    /// What the recording says without the law, each a coordinate and what the law should give there; empty where
    /// that cannot be read off.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seen: Vec<[f64; 2]>,
    /// Of a learned law what its curve looks like.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearnedLaw>,
}

/// What is known of the curve of a learned law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LearnedLaw {
    /// What the curve looks like, as far as that is known at 95 %.
    pub sentence: String,
    /// The named law that is nearest; none where no named law lives over its coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestLaw>,
}

/// A named law that was fitted to a learned one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NearestLaw {
    /// Name in the catalogue.
    pub effect: String,
    /// Its parameters.
    pub parameters: Vec<LawParameter>,
    /// The law at the points of the curve.
    pub values: Vec<f64>,
    /// Squared distance from the learned ordinates in their standard deviations, for each degree of freedom.
    pub chi_squared: f64,
    /// Ranges of the coordinate where it is outside of the 95 % band.
    pub outside: Vec<[f64; 2]>,
}

/// A parameter of a law that was fitted to a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LawParameter {
    /// Name.
    pub name: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Unit.
    pub unit: String,
}

impl NearestLaw {
    /// Whether it stays inside the band of the learned curve.
    pub fn is_inside(&self) -> bool {
        self.outside.is_empty()
    }
}

impl LawCurve {
    /// Whether all its numbers are.
    pub(super) fn is_finite(&self) -> bool {
        let band = self.ci95.iter().flatten();
        let mut numbers = self.points.iter().chain(&self.values).chain(band);
        numbers.all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Finding;

    #[test]
    fn a_curve_is_read_back_and_none_is_needed() {
        let finding = Finding {
            effect: "learned_spring".into(),
            place: "transmission".into(),
            probability: 0.9,
            parameters: Vec::new(),
            evidence: String::new(),
            alternatives: Vec::new(),
            happened_in: Vec::new(),
            curve: Some(LawCurve {
                law: "spring force".into(),
                unit: "N".into(),
                coordinate: "deformation".into(),
                coordinate_unit: "m".into(),
                points: vec![-0.1, 0.1],
                values: vec![-1.0 / 3.0, 1.0 / 3.0],
                ci95: vec![[-0.5, -0.2], [0.2, 0.5]],
                seen: vec![[-0.1, -0.3]],
                learned: Some(LearnedLaw {
                    sentence: "The learned spring is odd.".into(),
                    nearest: None,
                }),
            }),
        };
        let written = serde_json::to_string(&finding).unwrap();
        assert_eq!(serde_json::from_str::<Finding>(&written).unwrap(), finding);
        // As it was written before there were curves.
        let old = Finding {
            curve: None,
            ..finding
        };
        let written = serde_json::to_string(&old).unwrap();
        assert!(!written.contains("curve"), "{written}");
        assert_eq!(serde_json::from_str::<Finding>(&written).unwrap(), old);
    }
}
