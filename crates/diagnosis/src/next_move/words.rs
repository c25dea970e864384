//! The next move in words.

use super::ideas::Idea;
use super::{ENOUGH, SEPARATES};
use crate::point::EffectAt;
use quell_model::effects::Effect;

/// Effects that two explanations do not share.
pub fn apart(one: &[EffectAt], other: &[EffectAt]) -> [Vec<EffectAt>; 2] {
    let only = |of: &[EffectAt], not: &[EffectAt]| {
        let own = of.iter().filter(|effect| !not.contains(effect));
        own.copied().collect()
    };
    [only(one, other), only(other, one)]
}

/// Names of effects, joined by ` + `, with their places where the names alone are equal.
pub fn called(
    one: &[EffectAt],
    other: &[EffectAt],
    name: impl Fn(&Effect) -> &'static str,
) -> [String; 2] {
    let join = |of: &[EffectAt], places: bool| -> String {
        let name = |&(effect, place): &EffectAt| match places {
            true => format!("{} (at the {})", name(effect), place.name()),
            false => name(effect).to_string(),
        };
        match of.is_empty() {
            true => "nothing more".into(),
            false => of.iter().map(name).collect::<Vec<_>>().join(" + "),
        }
    };
    let [a, b] = [one, other].map(|side| join(side, false));
    match a == b {
        true => [one, other].map(|side| join(side, true)),
        false => [a, b],
    }
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

/// A chi-squared rounded down to two digits, its accuracy.
fn rounded(score: f64) -> f64 {
    let unit = 10f64.powf(score.max(1.0).log10().floor() - 1.0);
    (score / unit).floor() * unit
}

/// What to do.
fn command(idea: &Idea) -> String {
    let Some(first) = idea.moves.first() else {
        return match idea.share {
            1.0 => "repeat the recorded input as it is".into(),
            share => format!("repeat the recorded input at {share} of its size"),
        };
    };
    let sizes = idea.moves.iter().map(|one| one.distance.abs());
    let speeds = || idea.moves.iter().map(|one| one.speed);
    let (slowest, fastest) = (
        speeds().fold(f64::INFINITY, f64::min),
        speeds().fold(0.0, f64::max),
    );
    let rate = format!("{}/s", first.unit);
    let speed = match fastest < 1.1 * slowest {
        true => format!("at {}", told(fastest, &rate)),
        false => format!("at {} to {}", told(slowest, &rate), told(fastest, &rate)),
    };
    format!(
        "make {} moves of up to {} {speed}, {:.1} s in all",
        idea.moves.len(),
        told(sizes.fold(0.0, f64::max), &first.unit),
        idea.duration(),
    )
}

/// The sentence for an experiment that separates. `reversed` if the second explanation is the one that it would
/// confirm.
pub fn separates(idea: &Idea, [one, other]: &[String; 2], score: f64, reversed: bool) -> String {
    let (right, wrong) = if reversed { (other, one) } else { (one, other) };
    let command = command(idea);
    let mut letters = command.chars();
    let first: String = letters
        .next()
        .into_iter()
        .flat_map(char::to_uppercase)
        .collect();
    let (times, each) = match score < ENOUGH {
        true => (
            format!(", {} times over", (ENOUGH / score).ceil()),
            " each time",
        ),
        false => (String::new(), ""),
    };
    format!(
        "{first}{}{times}. If \"{right}\" is right, \"{wrong}\" will miss by a chi-squared of at least {}{each} \
         ({SEPARATES} is very strong evidence).",
        letters.as_str(),
        rounded(score)
    )
}

/// The sentence for a pair that no tried experiment separates, and the remedy.
pub fn inseparable([one, other]: &[String; 2], best: f64, remedy: &str) -> String {
    format!(
        "No motion within the limits of the recordings tells {one} from {other}. The best that was tried \
         makes a chi-squared of {best:.1}; {SEPARATES} would be very strong evidence. What would tell: {remedy}."
    )
}

/// The further sentence on a pair that the proposed experiment does not separate.
pub fn besides([one, other]: &[String; 2], remedy: &str) -> String {
    format!(" It does not tell {one} from {other}. What would: {remedy}.")
}

/// The further sentence where a payload separates them.
pub fn with_payload(idea: &Idea, score: f64) -> String {
    format!(
        " A known payload would tell, too. With the link's inertia half as large again, and nothing else changed, to \
         {} makes a chi-squared of {}.",
        command(idea),
        rounded(score)
    )
}
