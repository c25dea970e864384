//! The verdict in one sentence.

use super::document::{Diagnosis, Verdict};
use super::split::HeldOut;

/// One sentence, as an engineer would write it.
pub fn summary(diagnosis: &Diagnosis, judged_by: HeldOut) -> String {
    let held_out = judged_by.words();
    let (before, after) = (&diagnosis.fit.before, &diagnosis.fit.after);
    let change = format!(
        "on {held_out} the residual falls from {} to {} times the noise",
        times(before.held_out_over_noise),
        times(after.held_out_over_noise)
    );
    if let Some(sentence) = super::scale::sentence(diagnosis) {
        return sentence;
    }
    match diagnosis.verdict {
        Verdict::NoMismatch => format!(
            "Nothing is missing: with its parameters refitted the model explains the recording down to \
             the noise ({} times the noise on {}).",
            times(before.held_out_over_noise),
            held_out.trim_end_matches(',')
        ),
        Verdict::Named => format!("The model lacks {}: {change}.", names(diagnosis)),
        Verdict::Ambiguous => format!(
            "The model lacks {}, which this recording cannot tell from {}: {change}.",
            names(diagnosis),
            alternatives(diagnosis)
        ),
        Verdict::PartlyExplained => format!(
            "The model lacks something like {}, but that is not all: {change}.",
            names(diagnosis)
        ),
        // Whoever finds that says it.
        Verdict::NotExcited => diagnosis.summary.clone(),
        Verdict::Unexplained => format!(
            "Something is missing that the catalogue does not explain{}: the residual is {} times the \
             noise on {}.",
            place(diagnosis),
            times(before.held_out_over_noise),
            held_out.trim_end_matches(',')
        ),
    }
}

/// A number without its decimals, in digits that can be read whatever its size.
pub fn whole(value: f64) -> String {
    match value.abs() < 1e6 {
        true => format!("{value:.0}"),
        false => format!("{value:.1e}"),
    }
}

/// A ratio, in digits that can be read whatever its size.
pub fn times(ratio: f64) -> String {
    match ratio {
        ratio if ratio < 10.0 => format!("{ratio:.2}"),
        ratio => whole(ratio),
    }
}

fn words(name: &str) -> String {
    name.replace('_', " ")
}

fn names(diagnosis: &Diagnosis) -> String {
    let name = |finding: &super::document::Finding| match finding.place.as_str() {
        "environment" => words(&finding.effect),
        "sensor" => format!("{} (in the sensor)", words(&finding.effect)),
        "base" => format!("{} (under the robot)", words(&finding.effect)),
        place => format!("{} (at the {place})", words(&finding.effect)),
    };
    let names: Vec<String> = diagnosis.findings.iter().map(name).collect();
    names.join(" and ")
}

fn alternatives(diagnosis: &Diagnosis) -> String {
    let all = diagnosis
        .findings
        .iter()
        .flat_map(|finding| &finding.alternatives);
    let names: Vec<String> = all.map(|name| words(name)).collect();
    names.join(" or ")
}

fn place(diagnosis: &Diagnosis) -> String {
    let place = diagnosis.location.place.as_ref();
    place.map_or_else(String::new, |place| {
        format!(" (it seems to sit in the {place})")
    })
}
