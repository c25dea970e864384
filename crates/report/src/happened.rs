//! Events of a single recording, which do not belong to the machine.

use super::case::Case;
use super::{head, words};
use quell_diagnosis::{Finding, FittedParameter, OutputTrace};

/// Whether a parameter is the instant of an event.
fn is_time(parameter: &FittedParameter) -> bool {
    parameter.name == "time" || parameter.name.starts_with("time_")
}

/// Sentence on the recordings in which a finding happened, or which it lasted through, and that the better model does not
/// contain it; `None` for findings of the machine.
pub fn of(finding: &Finding) -> Option<String> {
    let mut names: Vec<String> = Vec::new();
    for name in &finding.happened_in {
        let name = format!("\"{name}\"");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let names = words::list(&names, "and");
    let what = match finding.happened_in.len() {
        0 => return None,
        _ if !finding.parameters.iter().any(is_time) => format!("It lasted through {names}"),
        1 => format!("It happened once, in {names}"),
        count => format!("It happened {count} times, in {names}"),
    };
    Some(format!("{what}. The better model does not have it."))
}

/// Times and names of the events in the recording of a trace, in the order of time.
pub fn times(case: &Case, trace: &OutputTrace) -> Vec<(f64, String)> {
    let mut all = Vec::new();
    for finding in &case.diagnosis.findings {
        let times = finding.parameters.iter();
        let times = times.filter(|own| is_time(own));
        for (name, time) in finding.happened_in.iter().zip(times) {
            // With several recordings a trace has its recording's name.
            let several = trace.name.contains(": ");
            if !several || trace.name.starts_with(&format!("{name}: ")) {
                all.push((time.value, case.title(&finding.effect)));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Residual of the better model without events; `None` without events.
pub fn left_alone(case: &Case) -> Option<String> {
    let quality = case.diagnosis.fit.model_alone?;
    Some(format!(
        "the better model alone, without what happened, leaves {}",
        head::left_by(case, &quality)
    ))
}

/// The findings that are in the better model.
pub fn in_model(findings: &[Finding]) -> impl Iterator<Item = &Finding> {
    let stays = |finding: &&Finding| finding.happened_in.is_empty();
    findings.iter().filter(stays)
}
