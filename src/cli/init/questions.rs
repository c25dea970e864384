//! The questions of a proposed manifest, line by line.

use crate::cli::CliError;
use crate::recording::{GUESSED, NO_RATE, ROLES, Role, TimeUnit, UNITS, one_of};
use std::collections::BTreeMap;
use std::io::{BufRead, Write};

/// The head of a block that is still a comment, and the mark of each of its lines.
const COMMENTED: &str = "# [[channel]]";
const MARK: &str = "# ";

/// What was answered.
#[derive(Clone)]
enum Answer {
    Said(String),
    /// An empty line.
    Empty,
    /// Nobody is there.
    Nobody,
}

/// Asks on one side, hears on the other.
pub struct Questions<I, O> {
    answers: I,
    asked: O,
    /// Answers by the line that was asked for, as several channels have one clock.
    known: BTreeMap<String, Answer>,
}

impl<I: BufRead, O: Write> Questions<I, O> {
    pub fn new(answers: I, asked: O) -> Self {
        let known = BTreeMap::new();
        Self {
            answers,
            asked,
            known,
        }
    }

    /// The manifest with the answers.
    ///
    /// # Errors
    /// [`CliError::Input`] where an answer is needed and there is none.
    pub fn answered(&mut self, manifest: &str) -> Result<String, CliError> {
        let lines: Vec<&str> = manifest.lines().collect();
        let (mut text, mut at) = (String::new(), 0);
        while let Some(line) = lines.get(at) {
            if *line == COMMENTED {
                let block = &lines[at..];
                let ends = |own: &&str| !own.starts_with(MARK);
                let length = 1 + block[1..]
                    .iter()
                    .position(|own| ends(own) || *own == COMMENTED)
                    .unwrap_or(block.len() - 1);
                text += &self.block(&block[..length])?;
                at += length;
                continue;
            }
            if let Some(line) = self.line(line)? {
                text += &line;
                text.push('\n');
            }
            at += 1;
        }
        Ok(text)
    }

    /// A block that was a comment, with its role and unit; as it is where nobody knows them.
    fn block(&mut self, lines: &[&str]) -> Result<String, CliError> {
        let bare: Vec<&str> = lines
            .iter()
            .map(|own| own.trim_start_matches(MARK))
            .collect();
        let column = bare.iter().find_map(|own| own.strip_prefix("column = "));
        let column = column.unwrap_or("its column");
        let question = format!("Role of column {column} (empty: it is not used)");
        let Answer::Said(role) = self.ask(&question, "role")? else {
            return Ok(lines.join("\n") + "\n");
        };
        let mut text = String::new();
        for line in bare {
            let line = match line.split_once(" = ").map(|own| own.0) {
                Some("role") => Some(format!("role = {role:?}")),
                Some("unit") if line.starts_with("unit = \"\"") => {
                    let unit = self.needed(&format!("Unit of {role}"), "unit")?;
                    Some(format!("unit = {unit:?}"))
                }
                // `rate_hz` of a block is a comment twice.
                _ => self.line(line)?,
            };
            text += &line.map_or_else(String::new, |line| line + "\n");
        }
        Ok(text)
    }

    /// A line with its answer; `None` where it is to be left out.
    fn line(&mut self, line: &str) -> Result<Option<String>, CliError> {
        let rate = line.trim_start_matches(MARK);
        if rate.starts_with(NO_RATE.trim_start_matches(MARK)) && !rate.contains(char::is_numeric) {
            let rate = self.needed("Samples a second, Hz", "rate_hz")?;
            return Ok(Some(format!("rate_hz = {rate}")));
        }
        let parts = line.split_once(GUESSED);
        let Some(((key, value), why)) =
            parts.and_then(|(own, why)| own.split_once(" = ").zip(Some(why)))
        else {
            return Ok(Some(line.into()));
        };
        let is_text = value.starts_with('"');
        if !is_text && value.parse::<f64>().is_err() {
            return Ok(Some(line.into()));
        }
        let question = format!("{key} = {value}, as {why} (empty: yes)");
        Ok(match self.ask(&question, key)? {
            Answer::Nobody => Some(line.into()),
            Answer::Empty => Some(format!("{key} = {value}")),
            Answer::Said(answer) if answer == "none" => None,
            Answer::Said(answer) if is_text => Some(format!("{key} = {answer:?}")),
            Answer::Said(answer) => Some(format!("{key} = {answer}")),
        })
    }

    fn needed(&mut self, question: &str, key: &'static str) -> Result<String, CliError> {
        match self.ask(question, key)? {
            Answer::Said(answer) => Ok(answer),
            Answer::Empty | Answer::Nobody => Err(CliError::input(format!(
                "{key}: nothing in the file says it, and there was no answer"
            ))),
        }
    }

    /// An answer that the key can have.
    fn ask(&mut self, question: &str, key: &str) -> Result<Answer, CliError> {
        if let Some(known) = self.known.get(question) {
            return Ok(known.clone());
        }
        let answer = loop {
            // Nobody may read the questions.
            let _ = write!(self.asked, "{question}: ").and_then(|()| self.asked.flush());
            let mut line = String::new();
            if self.answers.read_line(&mut line)? == 0 {
                let _ = writeln!(self.asked);
                break Answer::Nobody;
            }
            let line = line.trim();
            match refused(key, line) {
                _ if line.is_empty() => break Answer::Empty,
                None => break Answer::Said(line.to_owned()),
                Some(why) => {
                    let _ = writeln!(self.asked, "{why}");
                }
            }
        };
        self.known.insert(question.into(), answer.clone());
        Ok(answer)
    }
}

/// Why a key cannot have this value; `None` where it can.
fn refused(key: &str, answer: &str) -> Option<String> {
    let roles = || ROLES.iter().map(|entry| entry.name);
    let units = || UNITS.iter().flat_map(|unit| unit.names.iter().copied());
    match key {
        "role" if Role::from_name(answer).is_none() => {
            Some(format!("No role {answer:?}: {}", one_of(answer, roles())))
        }
        "unit" if !units().any(|own| own == answer) => {
            Some(format!("No unit {answer:?}: {}", one_of(answer, units())))
        }
        "time_unit" if TimeUnit::from_name(answer).is_none() => Some(format!(
            "No unit of time {answer:?}: such as s, ms, us, ns, iso"
        )),
        "wrap" | "time_wrap" | "scale" | "offset" if answer == "none" => None,
        "rate_hz" | "wrap" | "time_wrap" | "scale" | "offset" => {
            let number = answer.parse::<f64>().ok().filter(|own| own.is_finite());
            let is_one = number.is_some_and(|own| own > 0.0 || ["scale", "offset"].contains(&key));
            (!is_one).then(|| format!("{answer:?} is no such number"))
        }
        _ => None,
    }
}
