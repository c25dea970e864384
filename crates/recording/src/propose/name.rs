//! Information in the name of a column: a role, an axis, a unit.

use super::super::role::{ROLES, Role};
use super::super::stamp::TimeUnit;
use super::super::unit::Unit;

/// The parts of a name.
#[derive(Clone, Debug, Default)]
pub struct Name {
    /// Its words, in lower case, without the unit.
    pub words: Vec<String>,
    /// Its unit as written, if it has one.
    pub unit: Option<String>,
}

/// Words of roles, in the order of the tests: all of the first and one of the second must be present. The last
/// field tells whether they have no other meaning.
const WORDS: &[(Role, &[&str], &[&str], bool)] = &[
    (
        Role::LinkAcceleration,
        &["link"],
        &["acc", "accel", "acceleration"],
        true,
    ),
    (
        Role::TipAcceleration,
        &[],
        &[
            "acc",
            "accel",
            "acceleration",
            "accelerometer",
            "adxl",
            "beschleunigung",
            "vibration",
        ],
        true,
    ),
    (Role::TipAcceleration, &[], &["ax", "ay", "az"], true),
    (Role::Deformation, &[], &["deformation", "deflection"], true),
    (
        Role::Deformation,
        &[],
        &["strain", "flex", "bending"],
        false,
    ),
    (Role::MotorCurrent, &[], &["current", "amps", "strom"], true),
    (
        Role::MotorVoltage,
        &[],
        &["voltage", "volts", "spannung"],
        true,
    ),
    (
        Role::Torque,
        &[],
        &["torque", "tau", "effort", "drehmoment"],
        true,
    ),
    (Role::Force, &[], &["force", "kraft"], true),
    (
        Role::CommandPosition,
        &[],
        &[
            "command",
            "cmd",
            "commanded",
            "setpoint",
            "target",
            "reference",
            "ref",
            "desired",
            "demand",
            "demanded",
            "soll",
            "sollwert",
            "sollposition",
            // A name in data sets for machine learning.
            "action",
        ],
        false,
    ),
    (
        Role::MotorVelocity,
        &["motor"],
        &["velocity", "vel", "speed", "rpm"],
        true,
    ),
    (
        Role::LinkVelocity,
        &["link"],
        &["velocity", "vel", "speed"],
        true,
    ),
    (
        Role::LinkPosition,
        &["link"],
        &["position", "pos", "angle"],
        true,
    ),
    (Role::LinkPosition, &[], &["link", "load", "arm"], false),
    (
        Role::TipPosition,
        &[],
        &["tip", "tcp", "tool", "ee", "tracker", "laser"],
        false,
    ),
    (
        Role::MotorPosition,
        &["motor"],
        &["position", "pos", "angle", "encoder"],
        true,
    ),
    (
        Role::MotorPosition,
        &[],
        &[
            "motor",
            "encoder",
            "enc",
            "joint",
            "theta",
            "q",
            "position",
            "pos",
            "angle",
            "state",
            "actual",
            "ist",
            "istposition",
            "winkel",
        ],
        false,
    ),
];

/// Words for time, and words for counters.
const TIME: &[&str] = &[
    "time",
    "t",
    "timestamp",
    "stamp",
    "zeit",
    "seconds",
    "millis",
    "micros",
    "date",
    "datetime",
];
const COUNTS: &[&str] = &["sample", "index", "n", "i", "row", "no", "nr", "count"];

/// The parts of a name: `accel_x [mm/s^2]`, `tipY_mm`, `motor_speed_rad_s`.
pub fn parse(name: &str) -> Name {
    let name = name.trim();
    if let Some(at) = index_of(name) {
        let mut list = parse(&name[..at]);
        list.words.push(name[at..].trim_matches(['[', ']']).into());
        return list;
    }
    let bracket = name.find(['[', '(']).filter(|at| *at > 0);
    if let Some(at) = bracket {
        let unit = name[at + 1..].trim_end_matches([')', ']']).trim();
        let words = words(&name[..at])
            .iter()
            .map(|word| word.to_lowercase())
            .collect();
        return Name {
            words,
            unit: Some(unit.into()),
        };
    }
    let parts = words(name);
    // The longest tail that is a unit: `rad_s` is rad/s, and not s.
    for from in 1..parts.len() {
        let tail = parts[from..].join("/");
        let tail = tail
            .replace("s/2", "s2")
            .replace("per/", "")
            .replace("N/m", "N.m");
        if is_unit(&tail) {
            let words = parts[..from]
                .iter()
                .map(|word| word.to_lowercase())
                .collect();
            return Name {
                words,
                unit: Some(tail),
            };
        }
    }
    let words = parts.iter().map(|word| word.to_lowercase()).collect();
    Name { words, unit: None }
}

/// Start of the index of a list element: `state[3]`.
pub fn index_of(name: &str) -> Option<usize> {
    let at = name.rfind('[').filter(|at| *at > 0)?;
    let index = name[at + 1..].strip_suffix(']')?;
    (!index.is_empty() && index.chars().all(|digit| digit.is_ascii_digit())).then_some(at)
}

/// The words of a name, separated by other characters, and at changes from lower to upper case.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in name.chars() {
        let is_hump = before.is_lowercase() && letter.is_uppercase();
        if is_hump || !(letter.is_alphanumeric() || letter == '\u{b0}') {
            words.push(String::new());
        }
        if (letter.is_alphanumeric() || letter == '\u{b0}')
            && let Some(word) = words.last_mut()
        {
            word.push(letter);
        }
        before = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

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
    let plain = text.replace('\u{b2}', "2").replace(' ', "");
    Unit::from_name(&text)
        .or_else(|| Unit::from_name(&plain))
        .or_else(|| Unit::from_name(&plain.to_lowercase()))
}

/// The unit of time that a text means.
pub fn time_unit(text: &str) -> Option<TimeUnit> {
    let plain = text.trim().to_lowercase();
    match plain.as_str() {
        "sec" | "second" | "seconds" => Some(TimeUnit::Seconds),
        "msec" | "millis" | "milliseconds" => Some(TimeUnit::Milliseconds),
        "usec" | "\u{b5}s" | "\u{3bc}s" | "micros" | "microseconds" => Some(TimeUnit::Microseconds),
        "nsec" | "nanos" | "nanoseconds" => Some(TimeUnit::Nanoseconds),
        "minutes" => Some(TimeUnit::Minutes),
        "iso" => None,
        other => TimeUnit::from_name(other),
    }
}

impl Name {
    /// The role of a column with this name, and whether it is certain.
    pub fn role(&self) -> Option<(Role, bool)> {
        let said = self.without_axis().join("_");
        if let Some(entry) = ROLES.iter().find(|entry| entry.name == said) {
            return Some((entry.role, true));
        }
        let has = |word: &&str| {
            self.words
                .iter()
                .any(|own| own.trim_end_matches(char::is_numeric) == *word)
        };
        let holds = |line: &&(Role, &[&str], &[&str], bool)| {
            line.1.iter().all(has) && line.2.iter().any(has)
        };
        let found = WORDS.iter().find(holds)?;
        Some((found.0, found.3))
    }

    /// The axis in the name: 0, 1 or 2 for x, y or z.
    pub fn axis(&self) -> Option<usize> {
        let last = self.words.last()?;
        let ends = ["x", "y", "z"].iter().position(|axis| last == axis);
        let acceleration = ["ax", "ay", "az"].iter().position(|axis| last == axis);
        ends.or(acceleration).or_else(|| {
            ["accx", "accy", "accz"]
                .iter()
                .position(|axis| last == axis)
        })
    }

    fn without_axis(&self) -> &[String] {
        let is_axis = self
            .words
            .last()
            .is_some_and(|last| ["x", "y", "z"].contains(&last.as_str()));
        &self.words[..self.words.len() - usize::from(is_axis)]
    }

    /// Whether the name means time.
    pub fn is_time(&self) -> bool {
        self.words
            .first()
            .is_some_and(|word| TIME.contains(&word.as_str()))
            || (self
                .words
                .last()
                .is_some_and(|word| ["time", "timestamp", "stamp"].contains(&word.as_str())))
            || (self.words.is_empty()
                && self
                    .unit
                    .as_deref()
                    .is_some_and(|unit| time_unit(unit).is_some()))
    }

    /// Whether the name means a counter of rows.
    pub fn is_count(&self) -> bool {
        self.words.len() == 1 && COUNTS.contains(&self.words[0].as_str())
    }
}
