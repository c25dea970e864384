//! Information in the name of a column: a role, an axis, a unit.

use super::super::role::{ROLES, Role};
use super::super::unit::Dimension;
use super::units;
use super::words::{ANGLES, COUNTS, ERRORS, INPUTS, PAYLOADS, TIME, WORDS};

/// The parts of a name.
#[derive(Clone, Debug, Default)]
pub struct Name {
    /// Its words, in lower case, without the unit.
    pub words: Vec<String>,
    /// Its unit, if it has one: as written, unless it is one in brackets that is known by another name.
    pub unit: Option<String>,
    /// How many counts a revolution has, where that is its unit.
    pub per_revolution: Option<f64>,
}

/// The parts of a name: `accel_x [mm/s^2]`, `tipY_mm`, `motor_speed_rad_s`.
pub fn parse(name: &str) -> Name {
    let name = name.trim();
    if let Some(at) = index_of(name) {
        let mut list = parse(&name[..at]);
        list.words.push(name[at..].trim_matches(['[', ']']).into());
        return list;
    }
    if let Some((before, inside, behind)) = bracketed(name) {
        return Name {
            words: spoken(words(before).into_iter().chain(words(behind))),
            unit: Some(units::in_brackets(inside).into()),
            per_revolution: units::per_revolution(inside),
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
        // A number at the end counts joints or sensors; it is not the unit `1`.
        let subscript = tail == "m" && ANGLES.contains(&parts[from - 1].to_lowercase().as_str());
        if units::is_unit(&tail) && tail.parse::<u64>().is_err() && !subscript {
            return Name {
                words: spoken(parts[..from].iter().cloned()),
                unit: Some(tail),
                per_revolution: None,
            };
        }
    }
    Name {
        words: spoken(parts.into_iter()),
        ..Name::default()
    }
}

/// A name before its last brackets, what is in them, and behind them: `r61[0] Actual speed [rpm]`. The last ones that hold a unit
/// count, if some do.
fn bracketed(name: &str) -> Option<(&str, &str, &str)> {
    let group = |(at, _)| {
        let inside = &name[at + 1..];
        let ends = inside.find([']', ')']).unwrap_or(inside.len());
        let behind = inside.get(ends + 1..).unwrap_or_default();
        (&name[..at], inside[..ends].trim(), behind)
    };
    // A number in brackets is an index.
    let is_index = |own: &(&str, &str, &str)| own.1.bytes().all(|letter| letter.is_ascii_digit());
    let groups = name.match_indices(['[', '(']).map(group);
    let groups: Vec<_> = groups.filter(|own| !is_index(own)).collect();
    let holds = |own: &&(&str, &str, &str)| units::is_unit(units::in_brackets(own.1));
    let best = groups.iter().rfind(holds);
    best.or(groups.last()).copied()
}

/// Words in lower case; a German compound of an actual or a commanded value is two: `lage` and `ist` of `Lageistwert`.
fn spoken(words: impl Iterator<Item = String>) -> Vec<String> {
    let mut said = Vec::new();
    for word in words {
        let word = word.to_lowercase();
        let ends = [("istwert", "ist"), ("sollwert", "soll")];
        let compound = ends
            .iter()
            .find_map(|(end, sense)| Some((word.strip_suffix(end)?, *sense)));
        match compound {
            Some((stem, sense)) => {
                let stem = stem.strip_suffix('s').unwrap_or(stem);
                said.extend((!stem.is_empty()).then(|| stem.to_owned()));
                said.push(sense.into());
            }
            None => said.push(word),
        }
    }
    said
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

/// A word without the number at its end.
fn bare(word: &str) -> &str {
    word.trim_end_matches(|letter: char| letter.is_ascii_digit())
}

impl Name {
    /// The role of a column with this name, and whether it is certain.
    pub fn role(&self) -> Option<(Role, bool)> {
        let said: Vec<_> = self.without_axis().iter().map(|word| bare(word)).collect();
        let said = said.join("_").replace("__", "_");
        let said = said.trim_matches('_');
        if let Some(entry) = ROLES.iter().find(|entry| entry.name == said) {
            return Some((entry.role, true));
        }
        let has = |word: &&str| self.words.iter().any(|own| bare(own) == *word);
        let holds = |line: &&(Role, &[&str], &[&str], bool)| {
            line.1.iter().all(has) && line.2.iter().any(has)
        };
        let found = WORDS.iter().find(holds)?;
        Some((found.0, found.3))
    }

    /// Whether a word of it means a speed.
    pub fn is_speed(&self) -> bool {
        let mut speeds = WORDS.iter().filter(|line| line.0 == Role::MotorVelocity);
        let has = |word: &&str| self.words.iter().any(|own| bare(own) == *word);
        speeds.any(|line| line.2.iter().any(has))
    }

    /// Whether a word of it means an error of control: `jErr`, `following_error`, `LagDistance`.
    pub fn is_error(&self) -> bool {
        let mut words = self.words.iter().map(|own| bare(own));
        words.any(|word| ERRORS.contains(&word))
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

    /// The name without its last number, and that number.
    pub fn numbered(&self) -> Option<(String, String)> {
        let place = self.words.iter().rposition(|word| bare(word) != word)?;
        let (stem, number) = self.words[place].split_at(bare(&self.words[place]).len());
        let mut words = self.words.clone();
        words[place] = stem.into();
        Some((words.join(" "), number.into()))
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
            || matches!(&*self.words, [only] if only.len() > 1 && units::time_unit(only).is_some())
            || (self.words.is_empty()
                && self
                    .unit
                    .as_deref()
                    .is_some_and(|unit| units::time_unit(unit).is_some()))
    }

    /// The dimension of its unit.
    pub fn dimension(&self) -> Option<Dimension> {
        let unit = self.unit.as_deref().and_then(units::unit);
        unit.map(|unit| unit.dimension)
    }

    /// Whether the name means a counter of rows; a current is called `i`, too.
    pub fn is_count(&self) -> bool {
        let is_quantity = self.dimension().is_some_and(|own| own != Dimension::Number);
        self.words.len() == 1 && COUNTS.contains(&self.words[0].as_str()) && !is_quantity
    }

    /// Whether the name is that of an input of an instrument, which does not tell its sensor: `CH1`, `Channel 2`, `AI0`.
    pub fn is_input(&self) -> bool {
        let is_counted = |word: &String| bare(word).len() < 2;
        let is_word = |word: &String| INPUTS.contains(&bare(word));
        let last = self.words.last();
        let ends = last.is_some_and(|last| is_word(last) && bare(last) != last);
        let all = self
            .words
            .iter()
            .all(|word| is_counted(word) || is_word(word));
        let is_one = self.words.iter().any(is_word) || self.unit.is_some();
        ends || all
            && is_one
            && last
                .is_some_and(|last| is_word(last) || self.words.len() > 1 || bare(last).is_empty())
    }

    /// Whether it is what the axis carries.
    pub fn is_payload(&self) -> bool {
        let mass =
            |unit: &String| units::unit(unit).is_none_or(|own| own.dimension == Dimension::Mass);
        self.words
            .iter()
            .any(|word| PAYLOADS.contains(&word.as_str()))
            && self.unit.as_ref().is_none_or(mass)
    }
}
