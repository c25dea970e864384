//! A table over several diagnoses, of a robot's joints or a batch's recordings, with the worst first.

use crate::diagnosis::{Diagnosis, Verdict};
use crate::effects::Catalogue;
use crate::page::{self, Cell, Table, columns, digits, number};

/// One diagnosis of several, or the reason why it is absent.
pub struct Line {
    /// The joint or the recording.
    pub name: String,
    /// Link from the page to its report; `None` without one.
    pub report: Option<String>,
    /// The result, or the reason for no diagnosis in words.
    pub told: Result<Told, String>,
}

/// A diagnosis in short.
pub struct Told {
    /// Its verdict.
    pub verdict: Verdict,
    /// Its answer in a sentence.
    pub summary: String,
    /// Titles of the physics that is missing, each with what the recording cannot tell from it; what is in doubt
    /// says so.
    pub missing: Vec<String>,
    /// The misfit of the model as given, with its parameters refitted, over the noise; NaN if it is not known.
    pub before: f64,
    /// The same with the findings.
    pub after: f64,
}

impl Told {
    /// The short form of a diagnosis.
    pub fn of(diagnosis: &Diagnosis) -> Self {
        let catalogue = Catalogue::default();
        let titles = diagnosis.findings.iter().map(|own| {
            let others = own.alternatives.iter().map(|name| catalogue.title(name));
            let all: Vec<String> = std::iter::once(own.title(catalogue))
                .chain(others)
                .collect();
            let perhaps = if own.is_certain() { "" } else { "perhaps " };
            format!("{perhaps}{}", all.join(" or "))
        });
        Self {
            verdict: diagnosis.verdict,
            summary: diagnosis.summary.clone(),
            missing: titles.collect(),
            before: diagnosis.fit.before.held_out_over_noise,
            after: diagnosis.fit.after.held_out_over_noise,
        }
    }

    /// Whether it has no statement on the model, whose misfit then has no meaning.
    fn is_silent(&self) -> bool {
        self.verdict == Verdict::NotExcited
    }

    /// The missing physics, or the answer without any, as short as a cell of a table: its report has the figures.
    fn found(&self) -> String {
        match (self.missing.as_slice(), self.verdict) {
            ([], Verdict::NoMismatch) => "nothing".into(),
            ([], _) => self.summary.split(": ").next().unwrap_or_default().into(),
            (own, _) => own.join(" + "),
        }
    }

    /// A misfit to three digits; none where it has no meaning.
    fn misfit(&self, value: f64) -> f64 {
        match self.is_silent() {
            true => f64::NAN,
            false => digits(value, 3),
        }
    }

    fn lacks(&self) -> bool {
        !matches!(self.verdict, Verdict::NoMismatch | Verdict::NotExcited)
    }
}

/// Several diagnoses.
pub struct Overview {
    /// The kind of its items: `joint`, `recording`.
    noun: &'static str,
    /// Largest misfit first, then those without a statement on the model, and last those without a diagnosis.
    pub lines: Vec<Line>,
}

impl Overview {
    /// Puts the worst first.
    pub fn new(noun: &'static str, mut lines: Vec<Line>) -> Self {
        let misfit = |line: &Line| match &line.told {
            Ok(told) if told.is_silent() => -1.0,
            Ok(told) if told.before.is_nan() => 0.0,
            Ok(told) => told.before,
            Err(_) => -2.0,
        };
        lines.sort_by(|a, b| misfit(b).total_cmp(&misfit(a)));
        Self { noun, lines }
    }

    /// The answer for all.
    pub fn sentence(&self) -> (page::Verdict, String) {
        let count = |is: &dyn Fn(&Line) -> bool| self.lines.iter().filter(|line| is(line)).count();
        let lacking = |line: &Line| line.told.as_ref().is_ok_and(Told::lacks);
        let lines = self.lines.iter().filter(|line| lacking(line));
        let names: Vec<&str> = lines.map(|line| &*line.name).take(LISTED).collect();
        let (noun, of, some) = (self.noun, self.lines.len(), count(&lacking));
        let silent = count(&|line| line.told.as_ref().is_ok_and(Told::is_silent));
        let aside = count(&|line| line.told.is_err());
        let (verdict, mut sentence) = match some {
            0 if silent + aside == of => (
                page::Verdict::Bad,
                format!("None of {of} {noun}s says anything about the model."),
            ),
            0 => (
                page::Verdict::Good,
                format!(
                    "Nothing is missing in {} of {of} {noun}s.",
                    of - silent - aside
                ),
            ),
            _ => {
                let more = match some.saturating_sub(LISTED) {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
                let names = names.join(", ");
                (
                    page::Verdict::Bad,
                    format!(
                        "Physics is missing in {some} of {of} {noun}s, the worst first: {names}{more}."
                    ),
                )
            }
        };
        if silent > 0 {
            sentence += &format!(" {silent} say nothing about the model.");
        }
        if aside > 0 {
            sentence += &format!(" {aside} could not be diagnosed.");
        }
        (verdict, sentence)
    }

    /// The table for a terminal, followed by the reasons for missing diagnoses.
    pub fn text(&self) -> String {
        let header = [self.noun, "verdict", "missing", "misfit", "with it"];
        let dash = || "-".to_string();
        let rows = self.lines.iter().map(|line| match &line.told {
            Ok(told) => {
                let quiet = told.is_silent();
                let figure = |value: f64| {
                    if quiet || value.is_nan() {
                        dash()
                    } else {
                        number(value)
                    }
                };
                let missing = told.missing.join(" + ");
                [
                    line.name.clone(),
                    told.verdict.name().into(),
                    if missing.is_empty() { dash() } else { missing },
                    figure(told.before),
                    figure(told.after),
                ]
            }
            Err(_) => [
                line.name.clone(),
                "set aside".into(),
                dash(),
                dash(),
                dash(),
            ],
        });
        let table = columns(header, rows);
        let aside = self.lines.iter().filter_map(|line| {
            let why = line.told.as_ref().err()?;
            Some(format!("{}: {why}\n", line.name))
        });
        let aside: String = aside.collect();
        let gap = if aside.is_empty() { "" } else { "\n" };
        format!("{table}{gap}{aside}")
    }

    /// The table of a page, with a link to each report.
    pub fn table(&self) -> Table {
        let mut table = Table::new(format!("{}s", capital(self.noun)))
            .text_column(self.noun)
            .text_column("verdict")
            .text_column("missing")
            .column("misfit", "times the noise")
            .column("with it", "times the noise");
        for line in &self.lines {
            let name = match &line.report {
                Some(file) => Cell::Link {
                    text: line.name.clone(),
                    file: file.clone(),
                },
                None => line.name.clone().into(),
            };
            table = match &line.told {
                Ok(told) => table.row([
                    name,
                    told.verdict.name().replace('_', " ").into(),
                    told.found().into(),
                    told.misfit(told.before).into(),
                    told.misfit(told.after).into(),
                ]),
                Err(why) => table.row([name, "set aside".into(), why.clone().into()]),
            };
        }
        table
    }
}

/// Names in the answer for all; the table has the rest.
const LISTED: usize = 5;

/// The word with a capital letter.
fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(name: &str, verdict: Verdict, before: f64) -> Line {
        Line {
            name: name.into(),
            report: None,
            told: Ok(Told {
                verdict,
                summary: String::new(),
                missing: Vec::new(),
                before,
                after: 1.0,
            }),
        }
    }

    #[test]
    fn the_worst_is_first_and_what_says_nothing_last() {
        let aside = Line {
            name: "broken".into(),
            report: None,
            told: Err("no file".into()),
        };
        let lines = vec![
            aside,
            line("still", Verdict::NotExcited, 50.0),
            line("fine", Verdict::NoMismatch, 1.0),
            line("worst", Verdict::Named, 9.0),
            line("bad", Verdict::Unexplained, 3.0),
        ];
        let overview = Overview::new("recording", lines);
        let names: Vec<&str> = overview.lines.iter().map(|line| &*line.name).collect();
        assert_eq!(names, ["worst", "bad", "fine", "still", "broken"]);
        assert_eq!(
            overview.sentence().1,
            "Physics is missing in 2 of 5 recordings, the worst first: worst, bad. 1 say nothing about the model. 1 could not be \
             diagnosed."
        );
    }
}
