//! The judgement of one case: the truth against the verdict.

use super::Rate;
use super::coverage::{Covered, covered};
use crate::families::{LEARNED, NOTHING, OUTSIDE, family};
use crate::kind::Kind;
use crate::slots::{is_learned, is_learned_in_slot_of};
use crate::truth::Truth;
use crate::verdict::Verdict;
use serde::Serialize;

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
/// - *learned*: outside the catalogue, and a law was learned in its slot.
/// - *by slot*: of effects of the catalogue, those whose family no finding has, but a law was learned in their slot.
/// - *spurious*: findings of another family than the truth's that are no laws learned in its slot. Outside the
///   catalogue every name is one.
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
    /// True families among all findings, of all of the catalogue.
    pub families: Rate,
    /// Effects of which only the slot is right.
    pub by_slot: Rate,
    /// Findings that are not in the truth.
    pub spurious: usize,
    /// Whether a law was learned in the slot of one outside the catalogue.
    pub learned: bool,
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
        let kind = Kind::of(truth);
        let known = kind.is_one_name() || kind.is_several();
        let heard = match kind.is_one_name() {
            // One effect, one name: a second finding cannot correct a wrong first name.
            true => &verdict.findings[..verdict.findings.len().min(1)],
            false => &verdict.findings[..],
        };
        let effects = || truth.effects.iter().map(|effect| effect.effect.as_str());
        let names: Vec<&str> = heard
            .iter()
            .map(|finding| finding.effect.as_str())
            .collect();
        let families = names.iter().map(|name| family(name)).collect();
        let equal = |name: &&str| truth.equivalents.iter().any(|other| other == name);
        let stands_for = kind.is_one_name() && names.first().is_some_and(equal);
        let detected = verdict.detects();
        let [found, by_slot] = match known {
            true => found(truth, verdict),
            false => Default::default(),
        };
        let learned = || {
            let findings = verdict.findings.iter();
            findings.flat_map(|f| effects().map(|name| is_learned_in_slot_of(&f.effect, name)))
        };
        let in_set = |name| heard.iter().any(|finding| finding.set().contains(&name));
        Self {
            kind,
            detected: kind != Kind::Clean && detected,
            family: known && detected && (stands_for || all_in(effects().map(family), families)),
            exact: known && detected && all_in(effects(), names),
            in_set: known && detected && effects().all(in_set),
            set_size: verdict.findings.first().map(|finding| finding.set().len()),
            families: found,
            by_slot,
            spurious: verdict
                .findings
                .iter()
                .filter(|f| !is_true(&f.effect, truth))
                .count(),
            learned: kind == Kind::Outside && learned().any(|slot| slot),
            false_alarm: kind == Kind::Clean && detected,
            flagged: kind == Kind::Outside && verdict.doubts(),
            parameters: covered(truth, verdict),
            confusion: confusion(truth, verdict),
        }
    }

    /// Whether this is the desired result: the family, silence, or a flag.
    pub fn is_right(&self) -> bool {
        match self.kind {
            Kind::Clean => !self.false_alarm,
            Kind::Outside => self.flagged || self.learned,
            _ => self.family,
        }
    }
}

/// Whether an effect is of the truth's: of the family of a hidden one, or of one that no motion tells from it, or
/// learned in its slot.
pub(super) fn is_true(effect: &str, truth: &Truth) -> bool {
    let own = family(effect);
    let mut hidden = truth.effects.iter().map(|hidden| hidden.effect.as_str());
    let met = |name: &str| family(name) == own && own != OUTSIDE;
    truth.equivalents.iter().any(|name| name == effect)
        || hidden.any(|name| met(name) || is_learned_in_slot_of(effect, name))
}

/// How many of the hidden effects have their family among the findings, each finding counted once, and how many
/// of the others a law learned in their slot.
fn found(truth: &Truth, verdict: &Verdict) -> [Rate; 2] {
    let mut findings: Vec<&str> = verdict.findings.iter().map(|f| f.effect.as_str()).collect();
    let mut take = |wanted: &dyn Fn(&str) -> bool| {
        let found = findings.iter().position(|name| wanted(name));
        found.map(|index| findings.swap_remove(index)).is_some()
    };
    let hidden: Vec<&str> = truth.effects.iter().map(|e| e.effect.as_str()).collect();
    let alone = hidden.len() == 1;
    let equal = |name: &str| alone && truth.equivalents.iter().any(|other| other == name);
    let named: Vec<bool> = hidden
        .iter()
        .map(|own| take(&|name| family(name) == family(own) || equal(name)))
        .collect();
    let by_slot = hidden
        .iter()
        .zip(&named)
        .map(|(own, named)| !named && take(&|name| is_learned_in_slot_of(name, own)));
    let by_slot = by_slot.fold(Rate::default(), Rate::and);
    [named.into_iter().fold(Rate::default(), Rate::and), by_slot]
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
        Some(name) if verdict.detects() && is_learned(name) => LEARNED,
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
