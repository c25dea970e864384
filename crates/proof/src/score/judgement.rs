//! One case judged: what was hidden against what was said.

use super::coverage::{Covered, covered};
use crate::families::{NOTHING, family};
use crate::truth::Truth;
use crate::verdict::Verdict;
use serde::Serialize;

/// The kind of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing is hidden.
    Clean,
    /// One effect of the catalogue.
    One,
    /// Two effects of the catalogue.
    Two,
    /// Something outside the catalogue.
    Outside,
}

/// A diagnosis held against the truth.
///
/// - *detected*: something is hidden and the verdict is neither `no_mismatch` nor `not_excited`.
/// - *family*: one effect: the first name is of its family, or one that the truth calls its equivalent;
///   two: each has a name of its family.
/// - *exact*: the same for the names themselves.
/// - *in set*: each truth is among a finding and its alternatives; for one effect, the first finding.
/// - *false alarm*: nothing is hidden and the verdict is neither `no_mismatch` nor `not_excited`.
/// - *flagged*: outside the catalogue, and the verdict doubts (`unexplained`, `partly_explained` or
///   `ambiguous`).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Its kind, by the truth.
    pub kind: Kind,
    /// Whether something hidden was noticed.
    pub detected: bool,
    /// Whether all families are right.
    pub family: bool,
    /// Whether all names are right.
    pub exact: bool,
    /// Whether the truth is within the sets.
    pub in_set: bool,
    /// Names in the first finding's set.
    pub set_size: Option<usize>,
    /// Findings beyond the number of hidden effects.
    pub spurious: usize,
    /// Whether something was said to be missing where nothing is.
    pub false_alarm: bool,
    /// Whether something outside the catalogue was doubted.
    pub flagged: bool,
    /// Parameters whose interval can be held against the truth.
    pub parameters: Vec<Covered>,
    /// Families in the confusion matrix: the truth's and the first name's.
    pub confusion: [String; 2],
}

impl Judgement {
    /// Holds a verdict against the truth.
    pub fn new(truth: &Truth, verdict: &Verdict) -> Self {
        let kind = match truth.effects.len() {
            0 => Kind::Clean,
            _ if !truth.in_catalogue => Kind::Outside,
            1 => Kind::One,
            _ => Kind::Two,
        };
        let known = matches!(kind, Kind::One | Kind::Two);
        let heard = match kind {
            // One effect, one name: what comes second cannot make good a wrong first name.
            Kind::One => &verdict.findings[..verdict.findings.len().min(1)],
            _ => &verdict.findings[..],
        };
        let effects = || truth.effects.iter().map(|effect| effect.effect.as_str());
        let names: Vec<&str> = heard
            .iter()
            .map(|finding| finding.effect.as_str())
            .collect();
        let families = names.iter().map(|name| family(name)).collect();
        let equal = |name: &&str| truth.equivalents.iter().any(|other| other == name);
        let stands_for = kind == Kind::One && names.first().is_some_and(equal);
        let detected = verdict.detects();
        let in_set = |name| heard.iter().any(|finding| finding.set().contains(&name));
        Self {
            kind,
            detected: kind != Kind::Clean && detected,
            family: known && detected && (stands_for || all_in(effects().map(family), families)),
            exact: known && detected && all_in(effects(), names),
            in_set: known && detected && effects().all(in_set),
            set_size: verdict.findings.first().map(|finding| finding.set().len()),
            spurious: verdict.findings.len().saturating_sub(truth.effects.len()),
            false_alarm: kind == Kind::Clean && detected,
            flagged: kind == Kind::Outside && verdict.doubts(),
            parameters: covered(truth, verdict),
            confusion: confusion(truth, verdict),
        }
    }

    /// Whether this is what one would wish for: the family, silence, or a flag.
    pub fn is_right(&self) -> bool {
        match self.kind {
            Kind::Clean => !self.false_alarm,
            Kind::One | Kind::Two => self.family,
            Kind::Outside => self.flagged,
        }
    }
}

/// Whether each wanted one is there, two equal ones twice.
fn all_in<'a>(wanted: impl Iterator<Item = &'a str>, mut there: Vec<&str>) -> bool {
    wanted
        .into_iter()
        .all(|one| match there.iter().position(|other| *other == one) {
            Some(index) => {
                there.swap_remove(index);
                true
            }
            None => false,
        })
}

/// With two hidden, the one that the first name met, else the first.
fn confusion(truth: &Truth, verdict: &Verdict) -> [String; 2] {
    let said = match verdict.first_name() {
        Some(name) if verdict.detects() => family(name),
        _ if ["failed", "not_excited"].contains(&verdict.kind.as_str()) => &verdict.kind,
        _ if verdict.detects() => "unexplained",
        _ => NOTHING,
    };
    let mut hidden = truth.effects.iter().map(|effect| family(&effect.effect));
    let met = hidden.clone().find(|family| *family == said);
    let hidden = met.or_else(|| hidden.next()).unwrap_or(NOTHING);
    [hidden.into(), said.into()]
}
