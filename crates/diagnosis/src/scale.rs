//! Whether a tracker's scale and the model's lever arm agree.
//!
//! A tracker that shows `(1 + g)` of every length shows the same angles about the joint; its error is
//! seen in the radius of the tip's circle alone, and no motion tells it from a lever arm that is `(1 + g)`
//! times as long.

use super::document::{Diagnosis, Finding, FittedParameter, NextMove, Verdict};
use super::search::Search;
use quell_model::{Experiment, Model};

/// Standard deviations by which the radius must be off. The jackknife's has 19 degrees of freedom: Student's
/// t exceeds 5 once in ten thousand recordings.
const OFF: f64 = 5.0;
/// 97.5 % of Student's t with these degrees of freedom.
const HALF_WIDTH: f64 = 2.093;

/// Key of the radius that the engineer believes.
const LEVER_ARM: &str = "lever_arm_m";

/// Adds the finding, unless something else is wrong in the sensor, which may show in the radius too, or nothing
/// explains the motion.
pub fn tell(search: &Search, diagnosis: &mut Diagnosis) {
    let Some(finding) = finding(search.judge.model, search.problem.experiments) else {
        return;
    };
    let elsewhere = diagnosis
        .findings
        .iter()
        .all(|other| other.place != finding.place);
    diagnosis.verdict = match diagnosis.verdict {
        Verdict::Unexplained | Verdict::NotExcited => return,
        _ if !elsewhere => return,
        Verdict::PartlyExplained => Verdict::PartlyExplained,
        Verdict::NoMismatch | Verdict::Named if finding.alternatives.is_empty() => Verdict::Named,
        _ => Verdict::Ambiguous,
    };
    diagnosis.findings.push(finding);
}

/// The verdict in a sentence, where the scale is all that is wrong.
pub fn sentence(diagnosis: &Diagnosis) -> Option<String> {
    let [finding] = diagnosis.findings.as_slice() else {
        return None;
    };
    is_scale(finding).then(|| {
        let percent = finding.parameters[0].value * 100.0;
        let larger = if percent > 0.0 { "larger" } else { "smaller" };
        format!(
            "The motion is explained down to the noise, but the tip's circle is {:.4} % {larger} than {LEVER_ARM} \
             says: a wrong scale of the sensor, or a wrong lever arm.",
            percent.abs()
        )
    })
}

/// What would tell scale and lever arm apart.
pub fn next_move(diagnosis: &Diagnosis) -> Option<NextMove> {
    let finding = diagnosis
        .findings
        .iter()
        .find(|finding| is_scale(finding))?;
    let other = finding.alternatives.first()?;
    Some(NextMove {
        why: "No motion tells a tracker's scale from the lever arm: measure a known length with the tracker, or \
              the lever arm by other means."
            .into(),
        separates: [finding.effect.clone(), other.clone()],
        expected_score: 0.0,
        moves: Vec::new(),
    })
}

/// The model with the radius that the tracker shows as its lever arm: the two predict the same.
pub fn corrected(mut model: Model, diagnosis: &Diagnosis) -> Model {
    if let Some(finding) = diagnosis.findings.iter().find(|finding| is_scale(finding)) {
        let keys = model.kind.keys.iter().position(|key| key.name == LEVER_ARM);
        if let Some(value) = keys.map(|index| &mut model.values[index]) {
            value.value *= 1.0 + finding.parameters[0].value;
        }
    }
    model
}

/// Whether a finding is that of this file: the search finds a gain only where it changes an angle.
fn is_scale(finding: &Finding) -> bool {
    finding.effect == EFFECT && finding.evidence.starts_with(SEEN)
}

/// Name of the effect.
const EFFECT: &str = "sensor_gain";
/// How its evidence begins.
const SEEN: &str = "The tip's circle";

/// The scale of the tracker, where it does not agree with the lever arm; what cannot be told from it is the
/// lever arm itself, unless that is `fixed`.
fn finding(model: &Model, experiments: &[Experiment]) -> Option<Finding> {
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
    Some(Finding {
        effect: EFFECT.into(),
        place: "sensor".into(),
        probability: if believed.fixed { 1.0 } else { 0.5 },
        parameters: vec![FittedParameter {
            name: "error".into(),
            value: relative(seen),
            unit: "1".into(),
            ci95: [relative(seen - half), relative(seen + half)],
        }],
        evidence: format!(
            "{SEEN} has a radius of {seen:.5} m in the sensor's frame, +-{half:.5} m; {LEVER_ARM} is \
             {arm:.5}. The angles are not touched by it."
        ),
        alternatives: match believed.fixed {
            true => Vec::new(),
            false => vec![LEVER_ARM.into()],
        },
    })
}
