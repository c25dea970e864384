//! Units as files write them: in words, in other languages, as counts a revolution.

use super::super::stamp::TimeUnit;
use super::super::unit::Unit;

/// Words for the steps of an encoder or of a converter.
const STEPS: &[&str] = &[
    "cnt",
    "cnts",
    "counts",
    "inc",
    "incr",
    "increments",
    "inkremente",
    "ticks",
    "pulses",
    "impulses",
];

/// Units as they are spoken, with their signs.
const SPELLED: &[(&str, &str)] = &[
    ("volt", "V"),
    ("volts", "V"),
    ("ampere", "A"),
    ("amperes", "A"),
    ("amp", "A"),
    ("newton", "N"),
    ("degree", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("meter", "m"),
    ("metre", "m"),
    ("ms2", "m/s^2"),
    ("ms-2", "m/s^2"),
    ("ms^-2", "m/s^2"),
    ("m s^-2", "m/s^2"),
];

/// Units that are such only in brackets or in a row of units: in a name `1_min` may count.
const IN_BRACKETS: &[(&str, &str)] = &[
    // Degrees in German; the gon is no unit of a drive.
    ("grad", "deg"),
    ("grd", "deg"),
    ("grad/s", "deg/s"),
    ("grd/s", "deg/s"),
    ("1/min", "rpm"),
    ("min-1", "rpm"),
    ("min^-1", "rpm"),
    ("u/min", "rpm"),
    ("r/min", "rpm"),
    ("rev/min", "rpm"),
    ("tr/min", "rpm"),
    ("umdr", "rev"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("turn/s", "rev/s"),
    ("turns/s", "rev/s"),
];

/// Words for a revolution, below a number of counts.
const REVOLUTIONS: [&str; 6] = ["rev", "revolution", "turn", "u", "umdr", "tr"];

/// Whether a text is a unit of values or of time.
pub fn is_unit(text: &str) -> bool {
    unit(text).is_some() || time_unit(text).is_some()
}

/// The unit that a text means, in any spelling.
pub fn unit(text: &str) -> Option<&'static Unit> {
    let text = text
        .replace("sec", "s")
        .replace("**", "^")
        .replace("degrees", "deg");
    if let Some((_, name)) = SPELLED.iter().find(|own| own.0 == text.to_lowercase()) {
        return Unit::from_name(name);
    }
    let plain = text.replace('\u{b2}', "2").replace(' ', "");
    let steps = plain.to_lowercase();
    if STEPS.contains(&steps.as_str()) {
        return Unit::from_name("count");
    }
    if steps
        .strip_suffix("/s")
        .is_some_and(|steps| STEPS.contains(&steps))
    {
        return Unit::from_name("count/s");
    }
    Unit::from_name(&text)
        .or_else(|| Unit::from_name(&plain))
        .or_else(|| Unit::from_name(&plain.to_lowercase()))
}

/// The unit of time that a text means.
pub fn time_unit(text: &str) -> Option<TimeUnit> {
    TimeUnit::from_word(text)
}

/// The name of the unit that a text in brackets means; the text where that is none.
pub fn in_brackets(text: &str) -> &str {
    let plain = text.to_lowercase().replace(' ', "");
    let known = IN_BRACKETS.iter().find(|own| own.0 == plain);
    match (known, per_revolution(text)) {
        (Some((_, name)), _) => name,
        (_, Some(_)) => "rev",
        // The range of an accelerometer of enDAQ stands before its unit: `X (100g)`.
        _ if text.trim_start_matches(|own: char| own.is_ascii_digit()) == "g" => "g",
        _ => text,
    }
}

/// How many counts a revolution has, of `4096/rev` or `4096 counts/rev`.
pub fn per_revolution(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    let digits = above.trim().bytes().take_while(u8::is_ascii_digit).count();
    let (number, rest) = above.trim().split_at(digits);
    let is_steps = rest.trim().is_empty() || STEPS.contains(&rest.trim().to_lowercase().as_str());
    let is_turn = REVOLUTIONS.contains(&below.trim().to_lowercase().as_str());
    let counts: f64 = number.parse().ok()?;
    (is_steps && is_turn && counts > 1.0).then_some(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_hold_units_of_other_languages_and_counts_of_a_revolution() {
        for (text, name) in [
            ("Grad", "deg"),
            ("1/min", "rpm"),
            ("U/min", "rpm"),
            ("4096/rev", "rev"),
            ("131072 inc/U", "rev"),
            ("mm", "mm"),
            ("1/rev", "1/rev"),
            ("100g", "g"),
            ("kg/rev", "kg/rev"),
        ] {
            assert_eq!(in_brackets(text), name, "{text}");
        }
        assert_eq!(per_revolution("131072 inc/U"), Some(131_072.0));
    }

    #[test]
    fn steps_of_an_encoder_and_their_number_in_a_second_are_units() {
        let name = |text| unit(text).map(|own| own.names[0]);
        for text in ["cnt/sec", "counts/s", "Counts / sec", "inc/s", "ticks/s"] {
            assert_eq!(name(text), Some("count/s"), "{text}");
        }
        assert_eq!(name("cnt"), Some("count"));
        assert_eq!(name("cnt/min"), None);
    }
}
