//! Whether a tracker's scale and the model's lever arm agree.
//!
//! A tracker that shows `(1 + g)` of every length shows the same angles about the joint; its error is
//! seen in the radius of the tip's circle alone, and no motion tells it from a lever arm that is `(1 + g)`
//! times as long.

use super::document::{Diagnosis, Finding, FittedParameter, NextMove, Verdict};
use super::search::Search;
use quell_model::effects::{Effect, Place};
use quell_model::{Experiment, Model};

/// Standard deviations by which the radius must be off. The jackknife's has 19 degrees of freedom: Student's
/// t exceeds 5 once in ten thousand recordings.
const OFF: f64 = 5.0;
/// 97.5 % of Student's t with these degrees of freedom.
const HALF_WIDTH: f64 = 2.093;

/// Key of the radius that the engineer believes.
const LEVER_ARM: &str = "lever_arm_m";

/// A tracker whose scale does not agree with the lever arm.
pub struct TrackerScale {
    /// Which effect that is.
    effect: &'static Effect,
    /// By how much the radius is larger, relative.
    error: f64,
    /// 95 % confidence interval of that.
    ci95: [f64; 2],
    /// Whether it could be the lever arm as well.
    is_in_doubt: bool,
    evidence: String,
}

/// Adds the finding, unless something else is wrong in the sensor, which may show in the radius too, or nothing
/// explains the motion.
pub fn tell(search: &Search, diagnosis: &mut Diagnosis) -> Option<TrackerScale> {
    let problem = search.problem;
    let effect = problem.catalogue.find(Effect::is_wrong_scale)?;
    let scale = TrackerScale::of(search.judge.model, problem.experiments, effect)?;
    let finding = scale.finding();
    let elsewhere = diagnosis
        .findings
        .iter()
        .all(|other| other.place != finding.place);
    diagnosis.verdict = match diagnosis.verdict {
        Verdict::Unexplained | Verdict::NotExcited => return None,
        _ if !elsewhere => return None,
        Verdict::PartlyExplained => Verdict::PartlyExplained,
        Verdict::NoMismatch | Verdict::Named if !scale.is_in_doubt => Verdict::Named,
        _ => Verdict::Ambiguous,
    };
    diagnosis.findings.push(finding);
    Some(scale)
}

impl TrackerScale {
    /// The verdict in a sentence, where the scale is all that is wrong.
    pub fn sentence(&self) -> String {
        let percent = self.error * 100.0;
        let larger = if percent > 0.0 { "larger" } else { "smaller" };
        format!(
            "The motion is explained down to the noise, but the tip's circle is {:.4} % {larger} than {LEVER_ARM} \
             says. The sensor's scale is wrong, or the lever arm.",
            percent.abs()
        )
    }

    /// What would tell scale and lever arm apart.
    pub fn next_move(&self) -> Option<NextMove> {
        self.is_in_doubt.then(|| NextMove {
            why: "No motion tells a tracker's scale from the lever arm. Measure a known length with the tracker, or \
                  the lever arm by other means."
                .into(),
            separates: [self.effect.name.into(), LEVER_ARM.into()],
            expected_score: 0.0,
            moves: Vec::new(),
        })
    }

    /// The model with the radius that the tracker shows as its lever arm: the two predict the same.
    pub fn corrected(&self, mut model: Model) -> Model {
        let keys = model.kind.keys.iter().position(|key| key.name == LEVER_ARM);
        if let Some(value) = keys.map(|index| &mut model.values[index]) {
            value.value *= 1.0 + self.error;
        }
        model
    }

    /// As it is told; what cannot be told from it is the lever arm itself, unless that is `fixed`.
    fn finding(&self) -> Finding {
        Finding {
            effect: self.effect.name.into(),
            place: Place::Sensor.name().into(),
            probability: if self.is_in_doubt { 0.5 } else { 1.0 },
            parameters: vec![FittedParameter {
                name: self.effect.parameters[self.effect.size()].name.into(),
                value: self.error,
                unit: "1".into(),
                ci95: self.ci95,
            }],
            evidence: self.evidence.clone(),
            alternatives: match self.is_in_doubt {
                true => vec![LEVER_ARM.into()],
                false => Vec::new(),
            },
            happened_in: Vec::new(),
            curve: None,
        }
    }

    /// The scale of the tracker, where it does not agree with the lever arm.
    fn of(model: &Model, experiments: &[Experiment], effect: &'static Effect) -> Option<Self> {
        let (index, _) = model
            .kind
            .keys
            .iter()
            .enumerate()
            .find(|(_, key)| key.name == LEVER_ARM)?;
        let believed = &model.values[index];
        let arm = believed.value;
        let (mut weight, mut sum) = (0.0, 0.0);
        let outputs = experiments
            .iter()
            .flat_map(|experiment| &experiment.outputs);
        for radius in outputs.filter_map(|output| output.radius) {
            let own = 1.0 / radius.std.max(f64::MIN_POSITIVE).powi(2);
            (weight, sum) = (weight + own, sum + own * radius.seen);
        }
        let (seen, std) = (sum / weight, weight.powf(-0.5));
        let doubt = believed.std.unwrap_or(0.0);
        let off = (seen - arm).abs();
        // Where no arc told a radius it is no number.
        if off.is_nan() || off <= OFF * std.hypot(doubt) {
            return None;
        }
        let relative = |radius: f64| radius / arm - 1.0;
        let half = HALF_WIDTH * std.hypot(doubt);
        Some(Self {
            effect,
            error: relative(seen),
            ci95: [relative(seen - half), relative(seen + half)],
            is_in_doubt: !believed.fixed,
            evidence: format!(
                "The tip's circle has a radius of {seen:.5} m in the sensor's frame, +-{half:.5} m; {LEVER_ARM} is \
                 {arm:.5}. The angles are not touched by it."
            ),
        })
    }
}
