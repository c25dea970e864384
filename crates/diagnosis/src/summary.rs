//! The verdict in one sentence.

use super::document::{Diagnosis, Finding, Quality, Verdict};
use super::figure::figure;
use super::found::Found;
use super::search::Search;
use super::tracker_scale::TrackerScale;
use quell_model::effects::Catalogue;
use quell_recording::Preferred;

/// The verdict in one sentence; residuals are in the unit `shown`. `fits_all` is whether the best explanation, fitted to all
/// rows, leaves only noise.
pub fn summary(
    (search, found, fits_all): (&Search, &Found, bool),
    diagnosis: &Diagnosis,
    shown: Preferred,
    scale: Option<&TrackerScale>,
) -> String {
    let catalogue = search.problem.catalogue;
    let held_out = search.judge.data.judged_by.words();
    let (before, after) = (&diagnosis.fit.before, &diagnosis.fit.after);
    let rms = |quality: &Quality| figure(quality.held_out_rms * shown.factor, "");
    let change = format!(
        "on {held_out} the residual falls from {} to {} {} rms, {} to {} times the noise",
        rms(before),
        rms(after),
        shown.unit,
        times(before.held_out_over_noise),
        times(after.held_out_over_noise)
    );
    if let (Some(scale), [_]) = (scale, diagnosis.findings.as_slice()) {
        return scale.sentence();
    }
    let names = || names(&diagnosis.findings, catalogue);
    match diagnosis.verdict {
        Verdict::NoMismatch => {
            let left = format!(
                "{} {} rms, {} times the noise, on {}",
                rms(before),
                shown.unit,
                times(before.held_out_over_noise),
                held_out.trim_end_matches(',')
            );
            match search.leaves_noise(&found.baseline) {
                true => format!(
                    "Nothing is missing: with its parameters refitted the model explains the recording down to \
                     the noise ({left})."
                ),
                false => format!(
                    "Nothing was found to be missing: with its parameters refitted the model leaves {left}. What is \
                     left has no place in the chain, or is as large where nothing moves: it is noise of another colour, \
                     or a mismatch too small to be named."
                ),
            }
        }
        Verdict::Named => format!("The model lacks {}: {change}.", names()),
        Verdict::Ambiguous => ambiguous(diagnosis, catalogue, &change),
        Verdict::PartlyExplained if fits_all => format!(
            "The model lacks something like {}. Fitted to the whole recording it leaves only noise, but it is not confirmed \
             by what it was not fitted to: {change}.",
            names()
        ),
        Verdict::PartlyExplained => format!(
            "The model lacks something like {}, but that is not all: {change}.",
            names()
        ),
        // The sentence was written where this was found.
        Verdict::NotExcited => diagnosis.summary.clone(),
        Verdict::Unexplained => format!(
            "Something is missing that the catalogue does not explain{}: the residual is {} {} rms, {} times \
             the noise, on {}.",
            place(diagnosis),
            rms(before),
            shown.unit,
            times(before.held_out_over_noise),
            held_out.trim_end_matches(',')
        ),
    }
}

/// Odds beyond which no figure is told: so few claims of such certainty were tried that more cannot be confirmed.
const SURE: f64 = 1000.0;

/// Odds in words, of their natural logarithm: `12 to 1`, `1 to 3`, `more than 1000 to 1`.
pub fn odds(log: f64) -> String {
    let ratio = log.abs().exp();
    match (log < 0.0, ratio > SURE) {
        (false, true) => format!("more than {SURE} to 1"),
        (true, true) => format!("less than 1 to {SURE}"),
        (false, false) => format!("{ratio:.0} to 1"),
        (true, false) => format!("1 to {ratio:.0}"),
    }
}

/// A number without decimals, readable at any size.
fn whole(value: f64) -> String {
    match value.abs() < 1e6 {
        true => format!("{value:.0}"),
        false => format!("{value:.1e}"),
    }
}

/// A ratio, readable at any size.
pub fn times(ratio: f64) -> String {
    match ratio {
        ratio if ratio < 10.0 => format!("{ratio:.2}"),
        ratio if ratio < 1e3 => whole(ratio),
        // Three digits, as tables show.
        ratio if ratio < 1e6 => {
            let step = 10f64.powi(ratio.log10().floor() as i32 - 2);
            whole((ratio / step).round() * step)
        }
        ratio => format!("{ratio:.2e}"),
    }
}

/// The sentence for several explanations: other effects in place of a finding, or a finding that may not be
/// needed.
fn ambiguous(diagnosis: &Diagnosis, catalogue: Catalogue, change: &str) -> String {
    let (perhaps, there): (Vec<&Finding>, Vec<_>) = diagnosis
        .findings
        .iter()
        .partition(|finding| diagnosis.may_be_absent(finding, catalogue));
    let both = [there, perhaps].map(|own| names(own, catalogue));
    let lacks = match both.each_ref().map(String::as_str) {
        [own, ""] => own.to_string(),
        ["", own] => format!("perhaps {own}"),
        [own, other] => format!("{own}, and perhaps {other}"),
    };
    format!(
        "The model lacks {lacks}{}: {change}.",
        alternatives(diagnosis, catalogue)
    )
}

fn names<'a>(findings: impl IntoIterator<Item = &'a Finding>, catalogue: Catalogue) -> String {
    let name = |finding: &Finding| {
        let title = finding.title(catalogue);
        match finding.place.as_str() {
            "environment" => title,
            "sensor" => format!("{title} (in the sensor)"),
            "base" => format!("{title} (under the robot)"),
            place => format!("{title} (at the {place})"),
        }
    };
    let names: Vec<String> = findings.into_iter().map(name).collect();
    match names.as_slice() {
        [front @ .., last] if !front.is_empty() => format!("{} and {last}", front.join(", ")),
        names => names.concat(),
    }
}

/// What the recording cannot tell from the findings, from each its own; nothing where there is nothing.
fn alternatives(diagnosis: &Diagnosis, catalogue: Catalogue) -> String {
    let others = |finding: &Finding| {
        let names = finding.alternatives.iter().map(|own| catalogue.title(own));
        names.collect::<Vec<_>>().join(" or ")
    };
    if let [only] = diagnosis.findings.as_slice() {
        return match others(only) {
            none if none.is_empty() => none,
            others => format!(", which this recording cannot tell from {others}"),
        };
    }
    let doubtful = diagnosis
        .findings
        .iter()
        .filter(|finding| !finding.alternatives.is_empty());
    let told =
        doubtful.map(|finding| format!("{} from {}", finding.title(catalogue), others(finding)));
    match told.collect::<Vec<_>>().join(", nor ") {
        none if none.is_empty() => none,
        told => format!(", where this recording cannot tell {told}"),
    }
}

fn place(diagnosis: &Diagnosis) -> String {
    let place = diagnosis.location.place.as_ref();
    place.map_or_else(String::new, |place| {
        format!(" (it seems to sit in the {place})")
    })
}

#[cfg(test)]
mod tests {
    use super::odds;

    #[test]
    fn odds_are_told_in_words() {
        let told = [12f64.ln(), -3f64.ln(), 50.0, -800.0, 0.0].map(odds);
        let expected = [
            "12 to 1",
            "1 to 3",
            "more than 1000 to 1",
            "less than 1 to 1000",
            "1 to 1",
        ];
        assert_eq!(told, expected);
    }
}
