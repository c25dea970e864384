//! The score over many cases.

mod aim;
mod coverage;
mod judgement;
mod kinds;
mod page;
mod print;
mod rate;
mod read;
mod reliability;

pub use aim::Aim;
pub use coverage::Covered;
pub use judgement::Judgement;
pub use kinds::KindScore;
pub use rate::{Rate, Spread};
pub use read::ScoreError;
pub use reliability::Bin;

use super::kind::Kind;
use super::truth::Truth;
use super::verdict::Verdict;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A case after its seal was broken.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// The truth.
    pub truth: Truth,
    /// The answer.
    pub verdict: Verdict,
    /// Rms over the noise on the test with the true machine; absent where the generator is not ours.
    pub oracle: Option<f64>,
    /// The comparison of the two.
    pub judgement: Judgement,
}

impl Judged {
    /// Breaks the seal of a case.
    pub fn new(name: String, truth: Truth, verdict: Verdict, oracle: Option<f64>) -> Self {
        let judgement = Judgement::new(&truth, &verdict);
        Self {
            name,
            truth,
            verdict,
            oracle,
            judgement,
        }
    }
}

/// All cases together.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// The cases.
    pub cases: Vec<Judged>,
}

/// One line of the score.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in JSON.
    pub key: &'static str,
    /// The counter.
    pub name: &'static str,
    /// How often it was so.
    pub rate: Rate,
    /// The aim.
    pub aim: Aim,
}

impl Score {
    /// Of the cases that pass `among`, how many are `right`.
    fn rate(&self, among: impl Fn(&Judgement) -> bool, right: impl Fn(&Judgement) -> bool) -> Rate {
        let judgements = self.cases.iter().map(|case| &case.judgement);
        let these = judgements.filter(|j| among(j));
        these.fold(Rate::default(), |rate, j| rate.and(right(j)))
    }

    /// The rates, each with what is aimed at.
    pub fn lines(&self) -> Vec<Line> {
        let lines = self.known_lines().into_iter();
        lines.chain(self.other_lines()).collect()
    }

    /// Effects of the catalogue.
    fn known_lines(&self) -> [Line; 8] {
        let known = |j: &Judgement| j.kind.is_one_name() || j.kind.is_several();
        let of = |kind: Kind, right: fn(&Judgement) -> bool| {
            self.rate(|j| j.kind == kind && j.detected, right)
        };
        let found = |right| of(Kind::Single, right);
        let detected = self.rate(known, |j| j.detected);
        let pairs = self.rate(|j| j.kind == Kind::Pair, |j| j.family);
        let more = |j: &Judgement| j.kind.effects() > 2;
        let more = self.rate(more, |j| j.family);
        let shaped = of(Kind::Shaped, |j| j.family);
        [
            line("detected", "detected", detected, Aim::None),
            line(
                "family",
                "family, once detected",
                found(|j| j.family),
                Aim::AtLeast(98.0),
            ),
            line(
                "exact",
                "exact name, once detected",
                found(|j| j.exact),
                Aim::AtLeast(92.0),
            ),
            line(
                "in_set",
                "truth in the set",
                found(|j| j.in_set),
                Aim::AtLeast(97.0),
            ),
            line(
                "two_families",
                "two effects, both families",
                pairs,
                Aim::AtLeast(94.0),
            ),
            line(
                "more_families",
                "three effects or more, all families",
                more,
                Aim::AtLeast(85.0),
            ),
            line(
                "shaped_family",
                "another shape, family once detected",
                shaped,
                Aim::None,
            ),
            line(
                "spurious",
                "spurious findings",
                self.spurious(),
                Aim::AtMost(2.0),
            ),
        ]
    }

    /// Findings that are not in the truth, where a catalogue holds all of it.
    fn spurious(&self) -> Rate {
        let known = self.cases.iter().filter(|case| case.truth.in_catalogue);
        known.fold(Rate::default(), |rate, case| {
            rate.with(Rate {
                right: case.judgement.spurious,
                of: case.verdict.findings.len(),
            })
        })
    }

    /// Clean cases, cases outside the catalogue, and parameters.
    fn other_lines(&self) -> [Line; 5] {
        let outside = |right: fn(&Judgement) -> bool| self.rate(|j| j.kind == Kind::Outside, right);
        let alarms = self.rate(|j| j.kind == Kind::Clean, |j| j.false_alarm);
        let parameters = self
            .cases
            .iter()
            .flat_map(|case| &case.judgement.parameters);
        let coverage = parameters.fold(Rate::default(), |rate, p| rate.and(p.inside));
        [
            line("false_alarms", "false alarms", alarms, Aim::AtMost(1.0)),
            line(
                "outside_noticed",
                "outside the catalogue, noticed",
                outside(|j| j.detected),
                Aim::None,
            ),
            line(
                "outside_flagged",
                "outside the catalogue, flagged",
                outside(|j| j.flagged),
                Aim::AtLeast(85.0),
            ),
            line(
                "outside_learned",
                "outside the catalogue, learned in its slot",
                outside(|j| j.learned),
                Aim::None,
            ),
            line(
                "coverage",
                "95 % intervals that hold the truth",
                coverage,
                Aim::Within([90.0, 98.0]),
            ),
        ]
    }

    /// Names in the set of a single effect that was detected.
    pub fn set_sizes(&self) -> Spread {
        let single = self
            .cases
            .iter()
            .filter(|case| case.judgement.kind == Kind::Single);
        Spread::of(
            single
                .filter_map(|case| case.judgement.set_size)
                .map(|size| size as f64),
        )
    }

    /// Median and 90th percentile of a figure of the verdicts.
    pub fn spread(&self, figure: impl Fn(&Judged) -> f64) -> Spread {
        Spread::of(self.cases.iter().map(figure))
    }

    /// The measured sizes: name and spread.
    pub fn spreads(&self) -> Vec<(&'static str, &'static str, Spread)> {
        let known = |case: &Judged| case.judgement.kind != Kind::Outside;
        let test = |case: &Judged| {
            if known(case) {
                case.verdict.test_rms_over_noise
            } else {
                f64::NAN
            }
        };
        vec![
            (
                "before_over_noise",
                "held-out rms / noise before",
                self.spread(|c| c.verdict.before_over_noise),
            ),
            (
                "after_over_noise",
                "held-out rms / noise after",
                self.spread(|c| c.verdict.after_over_noise),
            ),
            (
                "test_over_noise",
                "rms / noise on moves never shown",
                self.spread(test),
            ),
            (
                "oracle_over_noise",
                "the same, of the true machine",
                self.spread(|c| c.oracle.unwrap_or(f64::NAN)),
            ),
            ("set_size", "names in the set, one effect", self.set_sizes()),
            (
                "seconds",
                "seconds a case",
                self.spread(|c| c.verdict.seconds),
            ),
        ]
    }

    /// How often each family was taken for each: truth, then named.
    pub fn confusion(&self) -> BTreeMap<String, BTreeMap<String, usize>> {
        let mut matrix: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for case in &self.cases {
            let [hidden, said] = case.judgement.confusion.clone();
            *matrix.entry(hidden).or_default().entry(said).or_default() += 1;
        }
        matrix
    }

    /// Per hidden effect (alone): how often its family, its name and its set were right.
    pub fn by_effect(&self) -> BTreeMap<String, [Rate; 4]> {
        let mut rows: BTreeMap<String, [Rate; 4]> = BTreeMap::new();
        for case in self
            .cases
            .iter()
            .filter(|case| case.truth.effects.len() < 2)
        {
            let j = &case.judgement;
            let detected = if j.kind == Kind::Clean {
                !j.false_alarm
            } else {
                j.detected
            };
            let right = [detected, j.is_right(), j.exact, j.in_set];
            let row = rows.entry(case.truth.name()).or_default();
            // A clean case, or one outside the catalogue, has no name to be right about.
            let asked = match j.kind {
                Kind::Clean | Kind::Outside => 2,
                _ => 4,
            };
            for (rate, right) in row.iter_mut().zip(right).take(asked) {
                *rate = rate.and(right);
            }
        }
        rows
    }

    /// The whole score for `--json`.
    pub fn to_json(&self) -> Value {
        let rates = self
            .lines()
            .into_iter()
            .map(|line| (line.key.to_string(), line.rate.to_json()));
        let spreads = self.spreads().into_iter();
        let spreads = spreads.map(|(key, _, spread)| (key.to_string(), spread.to_json()));
        let kinds = self.by_kind().into_iter();
        let kinds = kinds.map(|score| (score.kind.name().to_string(), score.to_json()));
        let bins = self.reliability().into_iter().map(Bin::to_json);
        let cases = self.cases.iter().map(|case| {
            json!({
                "case": case.name,
                "truth": case.truth.to_json(),
                "verdict": case.verdict,
                "oracle_over_noise": case.oracle,
                "judgement": case.judgement,
            })
        });
        json!({
            "cases": self.cases.len(),
            "rates": rates.collect::<serde_json::Map<_, _>>(),
            "figures": spreads.collect::<serde_json::Map<_, _>>(),
            "kinds": kinds.collect::<serde_json::Map<_, _>>(),
            "reliability": bins.collect::<Vec<_>>(),
            "confusion": self.confusion(),
            "each": cases.collect::<Vec<_>>(),
        })
    }
}

fn line(key: &'static str, name: &'static str, rate: Rate, aim: Aim) -> Line {
    Line {
        key,
        name,
        rate,
        aim,
    }
}
