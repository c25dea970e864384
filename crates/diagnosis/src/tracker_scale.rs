//! Whether a tracker's scale and the model's lever arm agree.
//!
//! A tracker that scales every length by `1 + g` shows the same angles about the joint. Its error shows only in
//! the radius of the tip's circle, and no motion separates it from a lever arm that is `1 + g` times as long.

use super::document::{Diagnosis, Finding, FittedParameter, NextMove, Verdict};
use super::search::Search;
use quell_model::effects::{Effect, Place};
use quell_model::{Experiment, Model, Radius};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Chance of an error of the radius in a recording without one: once in ten thousand.
const CHANCE: f64 = 1e-4;

/// Key of the believed radius.
const LEVER_ARM: &str = "lever_arm_m";

/// A tracker whose scale does not agree with the lever arm.
pub struct TrackerScale {
    /// The sensor effect for it.
    effect: &'static Effect,
    /// Relative error of the radius; positive if it is larger.
    error: f64,
    /// Its 95 % confidence interval.
    ci95: [f64; 2],
    /// Whether it could be the lever arm as well.
    is_in_doubt: bool,
    evidence: String,
}

/// Adds the finding. Not if another sensor effect was found, which may also change the radius, or if nothing
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
    /// The verdict in a sentence, if the scale is the only finding.
    pub fn sentence(&self) -> String {
        let percent = self.error * 100.0;
        let larger = if percent > 0.0 { "larger" } else { "smaller" };
        format!(
            "The motion is explained down to the noise, but the tip's circle is {:.4} % {larger} than {LEVER_ARM} \
             says. The sensor's scale is wrong, or the lever arm.",
            percent.abs()
        )
    }

    /// The measurement that separates scale and lever arm.
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

    /// The model with the tracker's radius as its lever arm: both predict the same.
    pub fn corrected(&self, mut model: Model) -> Model {
        let keys = model.kind.keys.iter().position(|key| key.name == LEVER_ARM);
        if let Some(value) = keys.map(|index| &mut model.values[index]) {
            value.value *= 1.0 + self.error;
        }
        model
    }

    /// The finding. Its alternative is the lever arm itself, unless that is `fixed`.
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
        let outputs = experiments
            .iter()
            .flat_map(|experiment| &experiment.outputs);
        let Radius { seen, std, freedom } = pooled(outputs.filter_map(|output| output.radius))?;
        // The standard deviation of the radius is an estimate, that of the belief is given.
        let doubt = believed.std.unwrap_or(0.0);
        let (estimated, given) = (StudentsT::new(0.0, 1.0, freedom).ok()?, Normal::standard());
        let reach = |chance: f64| {
            let up_to = 1.0 - 0.5 * chance;
            (estimated.inverse_cdf(up_to) * std).hypot(given.inverse_cdf(up_to) * doubt)
        };
        if (seen - arm).abs() <= reach(CHANCE) {
            return None;
        }
        let relative = |radius: f64| radius / arm - 1.0;
        let half = reach(0.05);
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

/// The radius of all recordings, each weighted by its variance.
fn pooled(each: impl Iterator<Item = Radius>) -> Option<Radius> {
    let (mut weight, mut sum, mut own_freedom) = (0.0, 0.0, 0.0);
    for radius in each {
        let own = radius.std.max(f64::MIN_POSITIVE).powi(-2);
        (weight, sum) = (weight + own, sum + own * radius.seen);
        own_freedom += own * own / radius.freedom;
    }
    // Without an arc there is no radius.
    (weight > 0.0).then(|| Radius {
        seen: sum / weight,
        std: weight.powf(-0.5),
        freedom: weight * weight / own_freedom,
    })
}
