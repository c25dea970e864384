//! The score as a page.

use super::kinds::{RATES, SPREADS};
use super::reliability::ENOUGH;
use super::{Bin, Judged, Rate, Score};
use quell_page::{Bars, Cell, Chart, Figure, Page, Table, Verdict, significant};
use std::collections::BTreeSet;

/// Share of right cases from which the page opens with a good sign.
const GOOD: f64 = 95.0;

/// On one line on a narrow page, too.
fn unbroken(text: &str) -> String {
    text.replace(' ', "\u{a0}")
}

impl Score {
    /// A page with the score: what was aimed at, what came out, what was taken for what.
    pub fn page(&self, subtitle: &str) -> Page {
        let judgements = self.cases.iter().map(|case| &case.judgement);
        let right = judgements.fold(Rate::default(), |rate, j| rate.and(j.is_right()));
        let missed = self.missed();
        let sign = match (right.percent() >= GOOD, missed.is_empty()) {
            (true, true) => Verdict::Good,
            (true, false) => Verdict::Plain,
            (false, _) => Verdict::Bad,
        };
        let sentence = format!(
            "Right in {} of {} concealed cases{}. Right means: the family of what is hidden is named, nothing is told where \
             nothing is hidden, and the mismatch is left open where the catalogue does not hold its cause.",
            right.right,
            right.of,
            match missed.as_slice() {
                [] => String::new(),
                own => format!("; missed aim: {}", own.join(", ")),
            }
        );
        let page = Page::new("Diagnosis of concealed cases")
            .subtitle(subtitle)
            .verdict(sign, sentence)
            .figures(self.key_figures())
            .table(self.rates_table())
            .table(self.spreads_table())
            .heading("Kind by kind")
            .table(self.kinds_table())
            .table(self.kind_figures_table())
            .heading("Reliability")
            .chart(self.reliability_chart())
            .table(self.reliability_table())
            .heading("What was taken for what")
            .table(self.confusion_table());
        let page = match self.by_effect().is_empty() {
            true => page,
            false => page
                .heading("Effect by effect")
                .bars(self.effect_bars())
                .table(self.effects_table()),
        };
        let page = self.wrong_table().into_iter().fold(page, Page::table);
        page.footnote(
            "A family is right when the first name (for two effects: each of both) is of the \
             hidden effect's family. Intervals of rates are Wilson's.",
        )
    }

    /// Names of the aims that are missed for certain.
    fn missed(&self) -> Vec<&'static str> {
        let lines = self.lines().into_iter();
        let missed = lines.filter(|line| line.aim.verdict(line.rate) == "missed");
        missed.map(|line| line.name).collect()
    }

    fn key_figures(&self) -> Vec<Figure> {
        let wanted = ["family", "in_set", "false_alarms", "outside_flagged"];
        let lines = self
            .lines()
            .into_iter()
            .filter(|line| wanted.contains(&line.key) && line.rate.of > 0);
        let rates =
            lines.map(|line| Figure::text(line.name, line.rate.share()).note(line.rate.count()));
        let spreads = self.spreads();
        let test = spreads.iter().filter(|entry| entry.0 == "test_over_noise");
        let test = test.map(|(_, name, spread)| {
            Figure::text(*name, significant(spread.median, 3)).note("median")
        });
        rates.chain(test).collect()
    }

    fn rates_table(&self) -> Table {
        let mut table = Table::new("Score")
            .text_column("score")
            .text_column("cases")
            .column("share", "%")
            .text_column("95 % interval")
            .text_column("aim")
            .text_column("met");
        for line in self.lines() {
            let [low, high] = line.rate.interval();
            let interval = if line.rate.of == 0 {
                "\u{2013}".into()
            } else {
                format!("{low:.1} to {high:.1}\u{a0}%")
            };
            table = table.row([
                line.name.into(),
                unbroken(&line.rate.count()).into(),
                line.rate.percent().into(),
                interval.into(),
                unbroken(&line.aim.to_string()).into(),
                line.aim.verdict(line.rate).into(),
            ]);
        }
        table.note(
            "An aim is met or missed where the whole interval says so. Where it says neither there are too few \
             cases to decide.",
        )
    }

    fn spreads_table(&self) -> Table {
        let mut table = Table::new("Figures")
            .text_column("figure")
            .column("mean", "")
            .column("median", "")
            .column("90th percentile", "");
        for (_, name, spread) in self.spreads() {
            let figures = [spread.mean, spread.median, spread.ninth_decile].map(Cell::from);
            table = table.row([name.into()].into_iter().chain(figures));
        }
        table
    }

    fn kinds_table(&self) -> Table {
        let mut table = Table::new("What was found")
            .text_column("kind")
            .column("cases", "");
        for (_, name) in RATES {
            table = table.column(name, "%");
        }
        for score in self.by_kind() {
            let rates = score.rates().map(|rate| Cell::from(rate.percent()));
            let first = [score.kind.name().into(), Cell::from(score.cases)];
            table = table.row(first.into_iter().chain(rates));
        }
        table.note(
            "Families found: of all that are hidden. By slot: the family was not named, but a law was learned on \
             the right coordinate. Spurious: of all findings, those of another family than the truth's; outside the \
             catalogue that is every name.",
        )
    }

    fn kind_figures_table(&self) -> Table {
        let mut table = Table::new("Moves never shown, and time").text_column("kind");
        for (_, name) in SPREADS {
            table = table.column(name, "median").column(name, "90 %");
        }
        for score in self.by_kind() {
            let spreads = score.spreads();
            let figures = spreads.iter().flat_map(|s| [s.median, s.ninth_decile]);
            let first = [score.kind.name().into()];
            table = table.row(first.into_iter().chain(figures.map(Cell::from)));
        }
        table.note("Rms over the noise of the model that came out, and of the true machine.")
    }

    fn reliability_chart(&self) -> Chart {
        let bins = self.reliability();
        let said: Vec<f64> = bins.iter().map(|bin| bin.said).collect();
        let so: Vec<f64> = bins.iter().map(|bin| bin.so.percent()).collect();
        let [low, high] = [0, 1].map(|edge| {
            let edge = |bin: &Bin| bin.so.interval()[edge];
            bins.iter().map(edge).collect::<Vec<_>>()
        });
        let title = "Are the probabilities right?";
        Chart::lines(title, "probability that was told", "%", "findings that are true", "%")
            .series("exactly right", &[0.0, 100.0], &[0.0, 100.0])
            .band("true", "95 % interval", &said, &low, &high)
            .points("true", &said, &so)
            .x_range(0.0, 100.0)
            .y_range(0.0, 100.0)
            .note("Each point stands for a range of probabilities. Above the line the diagnosis is too modest, below it too sure.")
    }

    fn reliability_table(&self) -> Table {
        let mut table = Table::new("Probabilities")
            .text_column("probability")
            .column("claims", "")
            .column("told, mean", "%")
            .column("true", "%")
            .text_column("95 % interval")
            .text_column("within 5 points");
        for bin in self.reliability() {
            let [low, high] = bin.so.interval();
            table = table.row([
                bin.range().into(),
                bin.so.of.into(),
                bin.said.into(),
                bin.so.percent().into(),
                format!("{low:.1} to {high:.1} %").into(),
                bin.verdict().into(),
            ]);
        }
        table.note(format!(
            "A range is judged from {ENOUGH} claims on. A finding is true when its family, or the slot of a learned \
             law, is the truth's."
        ))
    }

    fn confusion_table(&self) -> Table {
        let matrix = self.confusion();
        let said: BTreeSet<&String> = matrix.values().flat_map(|row| row.keys()).collect();
        let table =
            Table::new("Families: hidden in rows, named first in columns").text_column("hidden");
        let mut table = said
            .iter()
            .fold(table, |table, name| table.column(name.as_str(), ""));
        for (hidden, row) in &matrix {
            let cell = |name: &&String| match row.get(*name) {
                Some(count) => Cell::from(*count),
                None => "".into(),
            };
            table = table.row(
                [hidden.as_str().into()]
                    .into_iter()
                    .chain(said.iter().map(cell)),
            );
        }
        table
    }

    fn effect_bars(&self) -> Bars {
        let rows = self.by_effect();
        let right: Vec<f64> = rows.values().map(|rates| rates[1].percent()).collect();
        Bars::new("Right, by what was hidden", "%", rows.keys()).series("right", &right)
    }

    fn effects_table(&self) -> Table {
        let mut table = Table::new("One effect hidden")
            .text_column("hidden")
            .column("cases", "")
            .column("detected", "%")
            .column("right", "%")
            .column("exact name", "%")
            .column("in the set", "%");
        for (effect, rates) in self.by_effect() {
            let shares = rates.map(|rate| Cell::from(rate.percent()));
            let first = [effect.into(), Cell::from(rates[0].of)];
            table = table.row(first.into_iter().chain(shares));
        }
        table
    }

    /// None where all went well.
    fn wrong_table(&self) -> Option<Table> {
        let mut table = Table::new("Cases that went wrong")
            .text_column("case")
            .text_column("hidden")
            .text_column("verdict")
            .text_column("named")
            .column("refit / noise", "")
            .column("test / noise", "");
        let wrong = self.cases.iter().filter(|case| !case.judgement.is_right());
        let mut wrong = wrong.peekable();
        wrong.peek()?;
        for case in wrong {
            table = table.row(wrong_row(case));
        }
        Some(table)
    }
}

fn wrong_row(case: &Judged) -> [Cell; 6] {
    let names: Vec<String> = case
        .verdict
        .findings
        .iter()
        .map(|f| f.set().join(" / "))
        .collect();
    [
        case.name.as_str().into(),
        case.truth.name().into(),
        case.verdict.kind.as_str().into(),
        names.join(" + ").into(),
        case.truth.baseline_residual_over_noise.into(),
        case.verdict.test_rms_over_noise.into(),
    ]
}
