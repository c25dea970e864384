//! The score as text.

use super::{Judged, Score};
use comfy_table::{CellAlignment, Table, presets};
use quell_page::number;
use std::collections::BTreeSet;

impl Score {
    /// The score, its confusion matrix and the cases that went wrong, as tables.
    pub fn to_text(&self) -> String {
        let mut parts = vec![
            self.rates_text(),
            self.spreads_text(),
            self.confusion_text(),
        ];
        let wrong: Vec<&Judged> = self
            .cases
            .iter()
            .filter(|case| !case.judgement.is_right())
            .collect();
        if !wrong.is_empty() {
            parts.push(wrong_text(&wrong));
        }
        parts.join("\n")
    }

    fn rates_text(&self) -> String {
        let row = |line: super::Line| {
            let [low, high] = line.rate.interval();
            let interval = if line.rate.of == 0 {
                "-".into()
            } else {
                format!("{low:.0}-{high:.0} %")
            };
            [
                line.name.into(),
                line.rate.count(),
                line.rate.share(),
                interval,
                line.aim.into(),
            ]
        };
        let rows = self.lines().into_iter().map(row);
        table(1, &["score", "cases", "share", "95 %", "aim"], rows)
    }

    fn spreads_text(&self) -> String {
        let rows = self.spreads().into_iter().map(|(_, name, spread)| {
            let figures = [spread.mean, spread.median, spread.ninth_decile].map(number);
            [name.to_string()].into_iter().chain(figures)
        });
        table(1, &["figure", "mean", "median", "90th percentile"], rows)
    }

    fn confusion_text(&self) -> String {
        let matrix = self.confusion();
        let said: BTreeSet<&String> = matrix.values().flat_map(|row| row.keys()).collect();
        let letters: Vec<String> = (1..=said.len()).map(|k| format!("{k}")).collect();
        let mut header = vec!["hidden \\ named"];
        header.extend(letters.iter().map(String::as_str));
        let rows = matrix.iter().map(|(hidden, row)| {
            let cell = |name: &&String| row.get(*name).map_or(".".into(), usize::to_string);
            [hidden.clone()]
                .into_iter()
                .chain(said.iter().map(cell))
                .collect::<Vec<_>>()
        });
        let key: Vec<String> = said
            .iter()
            .zip(&letters)
            .map(|(name, letter)| format!("{letter} {name}"))
            .collect();
        format!("{}{}\n", table(1, &header, rows), key.join(", "))
    }
}

fn wrong_text(cases: &[&Judged]) -> String {
    let rows = cases.iter().map(|case| {
        let names: Vec<String> = case
            .verdict
            .findings
            .iter()
            .map(|f| f.set().join("/"))
            .collect();
        let residual = case.truth.baseline_residual_over_noise.unwrap_or(f64::NAN);
        [
            case.name.clone(),
            case.truth.name(),
            case.verdict.kind.clone(),
            names.join(" + "),
            number(residual),
            number(case.verdict.test_rms_over_noise),
        ]
    });
    let header = [
        "not right",
        "hidden",
        "verdict",
        "named",
        "refit / noise",
        "test / noise",
    ];
    table(4, &header, rows)
}

/// Columns set apart by two spaces; so many with words to the left, figures to the right.
fn table<R>(words: usize, header: &[&str], rows: impl IntoIterator<Item = R>) -> String
where
    R: IntoIterator<Item = String>,
{
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_header(header);
    for row in rows {
        table.add_row(row.into_iter().collect::<Vec<_>>());
    }
    for column in table.column_iter_mut() {
        let (first, word) = (column.index == 0, column.index < words);
        column.set_padding((if first { 0 } else { 2 }, 0));
        column.set_cell_alignment(if word {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        });
    }
    table.trim_fmt() + "\n"
}
