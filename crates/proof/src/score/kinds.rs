//! The score kind by kind.

use super::{Judged, Rate, Score, Spread};
use crate::kind::Kind;
use serde_json::{Value, json};

/// Keys of the rates in JSON, and their names in tables.
pub(super) const RATES: [(&str, &str); 7] = [
    ("detected", "detected"),
    ("right", "right"),
    ("all_families", "all families"),
    ("families", "families found"),
    ("by_slot", "by slot"),
    ("spurious", "spurious findings"),
    ("spurious_cases", "cases with one"),
];
/// The same of the figures.
pub(super) const SPREADS: [(&str, &str); 3] = [
    ("test_over_noise", "test / noise"),
    ("oracle_over_noise", "true machine"),
    ("seconds", "seconds"),
];

/// What came out for the cases of one kind.
#[derive(Clone, Copy, Debug)]
pub struct KindScore {
    /// The kind.
    pub kind: Kind,
    /// How many cases.
    pub cases: usize,
    /// Cases in which something was said to be missing; of clean ones they are false alarms.
    pub detected: Rate,
    /// Cases that are as one would wish.
    pub right: Rate,
    /// Cases with all true families among the findings.
    pub all_families: Rate,
    /// True families that are among the findings, of all true ones.
    pub families: Rate,
    /// True effects of which only the slot was found, by a learned law.
    pub by_slot: Rate,
    /// Findings that are not in the truth, of all findings.
    pub spurious: Rate,
    /// Cases with such a finding.
    pub spurious_cases: Rate,
    /// Rms over the noise on moves never shown.
    pub test: Spread,
    /// The same of the true machine.
    pub oracle: Spread,
    /// Seconds of a diagnosis.
    pub seconds: Spread,
}

impl Score {
    /// The score of each kind that there is.
    pub fn by_kind(&self) -> Vec<KindScore> {
        let cases = |kind| {
            let these = self.cases.iter().filter(move |c| c.judgement.kind == kind);
            these.collect::<Vec<_>>()
        };
        let kinds = Kind::ALL.into_iter().map(|kind| (kind, cases(kind)));
        let kinds = kinds.filter(|(_, cases)| !cases.is_empty());
        kinds
            .map(|(kind, cases)| KindScore::of(kind, &cases))
            .collect()
    }
}

impl KindScore {
    fn of(kind: Kind, cases: &[&Judged]) -> Self {
        let rate = |so: fn(&Judged) -> bool| {
            let each = cases.iter();
            each.fold(Rate::default(), |rate, case| rate.and(so(case)))
        };
        let sum = |part: fn(&Judged) -> Rate| {
            let each = cases.iter();
            each.fold(Rate::default(), |rate, case| rate.with(part(case)))
        };
        let spread = |figure: fn(&Judged) -> f64| Spread::of(cases.iter().map(|case| figure(case)));
        Self {
            kind,
            cases: cases.len(),
            detected: rate(|c| c.judgement.detected || c.judgement.false_alarm),
            right: rate(|c| c.judgement.is_right()),
            all_families: match kind {
                Kind::Clean | Kind::Outside => Rate::default(),
                _ => rate(|c| c.judgement.families.is_all()),
            },
            families: sum(|c| c.judgement.families),
            by_slot: sum(|c| c.judgement.by_slot),
            spurious: sum(|c| Rate {
                right: c.judgement.spurious,
                of: c.verdict.findings.len(),
            }),
            spurious_cases: rate(|c| c.judgement.spurious > 0),
            test: spread(|c| c.verdict.test_rms_over_noise),
            oracle: spread(|c| c.oracle.unwrap_or(f64::NAN)),
            seconds: spread(|c| c.verdict.seconds),
        }
    }

    /// The rates, in the order of [`RATES`].
    pub(super) fn rates(&self) -> [Rate; 7] {
        [
            self.detected,
            self.right,
            self.all_families,
            self.families,
            self.by_slot,
            self.spurious,
            self.spurious_cases,
        ]
    }

    /// The figures, in the order of [`SPREADS`].
    pub(super) fn spreads(&self) -> [Spread; 3] {
        [self.test, self.oracle, self.seconds]
    }

    pub(super) fn to_json(self) -> Value {
        let rates = RATES.iter().zip(self.rates());
        let rates = rates.map(|((key, _), rate)| (*key, rate.to_json()));
        let spreads = SPREADS.iter().zip(self.spreads());
        let spreads = spreads.map(|((key, _), spread)| (*key, spread.to_json()));
        let cases = [("cases", json!(self.cases))];
        let all = cases.into_iter().chain(rates).chain(spreads);
        Value::Object(all.map(|(key, value)| (key.to_string(), value)).collect())
    }
}
