//! The score as text.

use super::kinds::{RATES, SPREADS};
use super::{Judged, Rate, Score};
use comfy_table::{CellAlignment, Table, presets};
use quell_page::number;
use std::collections::BTreeSet;

impl Score {
    /// The score, its confusion matrix and the cases that went wrong, as tables.
    pub fn to_text(&self) -> String {
        let mut parts = vec![
            self.rates_text(),
            self.spreads_text(),
            self.kinds_text(),
            self.kind_figures_text(),
            self.reliability_text(),
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
                line.aim.to_string(),
                line.aim.verdict(line.rate).into(),
            ]
        };
        let rows = self.lines().into_iter().map(row);
        table(1, &["score", "cases", "share", "95 %", "aim", "met"], rows)
    }

    fn spreads_text(&self) -> String {
        let rows = self.spreads().into_iter().map(|(_, name, spread)| {
            let figures = [spread.mean, spread.median, spread.ninth_decile].map(number);
            [name.to_string()].into_iter().chain(figures)
        });
        table(1, &["figure", "mean", "median", "90th percentile"], rows)
    }

    fn kinds_text(&self) -> String {
        let header: Vec<&str> = ["kind", "cases"]
            .into_iter()
            .chain(RATES.map(|(_, name)| name))
            .collect();
        let rows = self.by_kind().into_iter().map(|score| {
            let first = [score.kind.name().to_string(), score.cases.to_string()];
            first.into_iter().chain(score.rates().map(Rate::share))
        });
        table(1, &header, rows)
    }

    fn kind_figures_text(&self) -> String {
        let names = SPREADS.iter().flat_map(|(_, name)| [*name, "90 %"]);
        let header: Vec<&str> = ["kind, medians"].into_iter().chain(names).collect();
        let rows = self.by_kind().into_iter().map(|score| {
            let figures = score.spreads().into_iter();
            let figures = figures.flat_map(|s| [number(s.median), number(s.ninth_decile)]);
            let first = [score.kind.name().to_string()];
            first.into_iter().chain(figures).collect::<Vec<_>>()
        });
        table(1, &header, rows)
    }

    fn reliability_text(&self) -> String {
        let bins = self.reliability();
        let rows = bins.iter().map(|bin| {
            let [low, high] = bin.so.interval();
            [
                bin.range(),
                bin.so.of.to_string(),
                format!("{:.1} %", bin.said),
                bin.so.share(),
                format!("{low:.0}-{high:.0} %"),
                bin.verdict().into(),
            ]
        });
        let header = [
            "probability",
            "said",
            "mean",
            "so",
            "95 %",
            "within 5 points",
        ];
        table(1, &header, rows)
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
