//! The next move in words.

use super::SEPARATES;
use super::ideas::Idea;
use crate::effects::Place;

/// Names of what two explanations do not have in common, joined by ` + `; with their places where the
/// names alone are the same.
pub fn names(one: &[(&str, Place)], other: &[(&str, Place)]) -> [String; 2] {
    let join = |of: &[(&str, Place)], not: &[(&str, Place)], places: bool| -> String {
        let own: Vec<String> = of
            .iter()
            .filter(|effect| !not.contains(effect))
            .map(|(name, place)| match places {
                true => format!("{name} (at the {})", place.name()),
                false => (*name).to_string(),
            })
            .collect();
        own.join(" + ")
    };
    let [a, b] = [join(one, other, false), join(other, one, false)];
    match a == b {
        true => [join(one, other, true), join(other, one, true)],
        false => [a, b],
    }
}

fn plain(name: &str) -> String {
    name.replace('_', " ")
}

/// `34.4 deg`, three digits.
fn told(value: f64, unit: &str) -> String {
    let (value, unit) = match unit.strip_prefix("rad") {
        Some(rest) => (value.to_degrees(), format!("deg{rest}")),
        None => (value, unit.to_string()),
    };
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{value:.*} {unit}", digits as usize)
}

/// What to do, as a command.
fn command(idea: &Idea) -> String {
    let largest = |f: fn(&crate::diagnosis::ProposedMove) -> f64| {
        idea.moves
            .iter()
            .map(f)
            .fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    match idea.moves.first() {
        None => idea.manner.clone(),
        Some(first) => format!(
            "move {} {}, at up to {} ({} moves in {:.1} s)",
            told(largest(|one| one.distance), &first.unit),
            idea.manner,
            told(largest(|one| one.speed), &format!("{}/s", first.unit)),
            idea.moves.len(),
            idea.duration(),
        ),
    }
}

/// The sentence for an experiment that separates.
pub fn separates(idea: &Idea, [one, other]: &[String; 2], score: f64) -> String {
    let [one, other] = [plain(one), plain(other)];
    let command = command(idea);
    let mut characters = command.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string());
    format!(
        "{}{}: if it is {one}, {other} will miss by a chi-squared of at least {score:.0} ({SEPARATES} is very \
         strong evidence).",
        first.unwrap_or_default(),
        characters.as_str(),
    )
}

/// The sentence for a pair that nothing tried separates, and what would.
pub fn inseparable([one, other]: &[String; 2], best: f64, remedy: &str) -> String {
    let [one, other] = [plain(one), plain(other)];
    format!(
        "No motion within the limits of the recordings tells {one} from {other}: the best that was tried makes \
         a chi-squared of {best:.1}, and {SEPARATES} would be very strong evidence. What would tell: {remedy}."
    )
}

/// The further sentence on a pair that the proposed experiment leaves alike.
pub fn besides([one, other]: &[String; 2], remedy: &str) -> String {
    let [one, other] = [plain(one), plain(other)];
    format!(" It does not tell {one} from {other}; what would: {remedy}.")
}

/// The further sentence where a payload makes the difference.
pub fn with_payload(idea: &Idea, score: f64) -> String {
    format!(
        " So would a known payload that makes the link's inertia half as large again, were nothing else to \
         change: to {} then makes {score:.0}.",
        command(idea)
    )
}
