//! Names of effects and places as an engineer says them.

use crate::diagnosis::{Diagnosis, Finding};
use crate::effects::Effect;

/// Words that keep their capital.
const PROPER: &[(&str, &str)] = &[("coulomb", "Coulomb"), ("stribeck", "Stribeck")];

/// Names that are not their words.
const PHRASES: &[(&str, &str)] = &[
    ("pose_dependent_frequency", "pose-dependent frequency"),
    ("sensor_lag_second_order", "second-order sensor lag"),
];

/// What each place is.
const PLACES: &[(&str, &str)] = &[
    ("drive", "command or current to motor side"),
    ("transmission", "motor side to link"),
    ("link", "what the joint carries"),
    ("base", "what the machine stands on"),
    ("sensor", "what is measured of it"),
    ("environment", "outside the machine"),
];

/// `coulomb_friction` as `Coulomb friction`; joined effects one by one.
pub fn effect(name: &str) -> String {
    let words: Vec<_> = name.split(" + ").map(one).collect();
    words.join(" + ")
}

fn one(name: &str) -> String {
    if let Some(entry) = PHRASES.iter().find(|entry| entry.0 == name) {
        return entry.1.into();
    }
    let word = |word: &str| {
        let proper = PROPER.iter().find(|entry| entry.0 == word);
        proper.map_or(word, |entry| entry.1).to_string()
    };
    let words: Vec<_> = name.split(['_', ' ']).map(word).collect();
    words.join(" ")
}

/// With a capital, to begin a sentence.
pub fn capital(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// What a place is, in a few words.
pub fn place(name: &str) -> &'static str {
    let known = PLACES.iter().find(|entry| entry.0 == name);
    known.map_or("", |entry| entry.1)
}

/// `in the transmission`, `from outside the machine`.
pub fn at(name: &str) -> String {
    match name {
        "environment" => "from outside the machine".into(),
        "link" => "at the link".into(),
        name => format!("in the {name}"),
    }
}

/// `a`, `a and b`, `a, b and c`, with any last joint.
pub fn list(items: &[String], joint: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [front @ .., last] => format!("{} {joint} {last}", front.join(", ")),
    }
}

/// The findings' names: `Coulomb friction and sensor lag`.
pub fn findings(findings: &[Finding]) -> String {
    let names: Vec<_> = findings.iter().map(|f| effect(&f.effect)).collect();
    list(&names, "and")
}

/// All effects that a finding may be: itself and its alternatives.
pub fn set(finding: &Finding) -> Vec<String> {
    let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
    names.map(|name| effect(name)).collect()
}

/// The first sentences of the catalogue's paragraph on an effect, without its source.
pub fn physics(name: &str) -> Option<String> {
    let text = Effect::from_name(name)?.physics;
    let text = text.split("Source:").next().unwrap_or(text).trim();
    Some(sentences(text, 240))
}

/// Whole sentences of `text`, the first and as many more as fit into `length` characters.
fn sentences(text: &str, length: usize) -> String {
    let mut kept = 0;
    for (index, _) in text.match_indices(". ") {
        let next = text[index + 2..].chars().next();
        if !next.is_some_and(char::is_uppercase) {
            continue;
        }
        if kept > 0 && index + 1 > length {
            break;
        }
        kept = index + 1;
    }
    let whole = kept == 0 || text.len() <= length;
    text[..if whole { text.len() } else { kept }].into()
}

/// Whether the candidate belongs to what the diagnosis names, or cannot tell from it.
///
/// An explanation by several effects carries its alternatives one by one: a candidate belongs to it
/// where it names an alternative, alone or beside the other findings.
pub fn in_set(diagnosis: &Diagnosis, candidate: &str) -> bool {
    let parts: Vec<&str> = candidate.split(" + ").collect();
    let fits = |part: &&str| {
        let same = |finding: &Finding| {
            finding.effect == *part || finding.alternatives.iter().any(|other| other == part)
        };
        diagnosis.findings.iter().any(same)
    };
    parts.len() == diagnosis.findings.len() && parts.iter().all(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_as_words() {
        assert_eq!(effect("coulomb_friction"), "Coulomb friction");
        assert_eq!(
            effect("sensor_lag + second_mode"),
            "sensor lag + second mode"
        );
        assert_eq!(
            list(&["a".into(), "b".into(), "c".into()], "or"),
            "a, b or c"
        );
    }

    #[test]
    fn sentences_end_where_they_end() {
        let text = "It is F = k (x + k3 x^3). Teeth harden. Buckling parts soften.";
        assert_eq!(
            sentences(text, 40),
            "It is F = k (x + k3 x^3). Teeth harden."
        );
        assert_eq!(sentences(text, 5), "It is F = k (x + k3 x^3).");
        assert_eq!(sentences(text, 200), text);
    }
}
