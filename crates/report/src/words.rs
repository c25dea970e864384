//! Names of effects and places in plain words.

use super::case::Case;
use super::shown::Shown;
use quell_diagnosis::{Finding, FittedParameter};
pub use quell_model::effects::words as plain;
use quell_model::effects::{ParameterRole, Place, Quantity};

/// What a force in the unit of a position is: the model has no scale of force, only frequencies.
const FORCES_TOLD: &str =
    "A force is told as the deflection of the joint that it causes: the force over the stiffness.";

/// Whether a quantity is a force that is told in the unit of a position.
fn is_deflection(quantity: Quantity, unit: &str) -> bool {
    quantity == Quantity::FORCE && matches!(unit, "rad" | "m")
}

/// Force per position.
const STIFFNESS: Quantity = Quantity::new(1, -1, 0);

/// What a stiffness is told in by a model that has no scale of force.
const STIFFNESS_TOLD: &str = "times the joint's";

/// Size below which a number is shown in parts per million.
const PER_MILLION: f64 = 1e-3;

/// With a capital letter, for the start of a sentence.
pub fn capital(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// A place, in a few words.
pub fn place(place: Place) -> &'static str {
    match place {
        Place::Drive => "command or current to motor side",
        Place::Transmission => "motor side to link",
        Place::Link => "what the joint carries",
        Place::Base => "what the machine stands on",
        Place::Sensor => "what is measured of it",
        Place::Environment => "outside the machine",
    }
}

/// Where to look for an unnamed mismatch at this place.
pub fn look(place: &str) -> Option<&'static str> {
    Some(match Place::from_name(place)? {
        Place::Drive => "Look between the command and the motor side: amplifier, motor, bearings.",
        Place::Transmission => "Look between motor side and link: gear, belt, coupling, joint.",
        Place::Link => "Look at what the joint carries: link, tool, payload, cables.",
        Place::Base => "Look at how the machine is fixed to the ground.",
        Place::Sensor => "Look at the sensor: its scale, filter, clock and mounting.",
        Place::Environment => "Look for what acts on the machine from outside.",
    })
}

/// `in the transmission`, `from outside the machine`.
pub fn at(name: &str) -> String {
    match name {
        "environment" => "from outside the machine".into(),
        "link" => "at the link".into(),
        name => format!("in the {name}"),
    }
}

/// `a`, `a and b`, `a, b and c`, with this last conjunction.
pub fn list(items: &[String], joint: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [front @ .., last] => format!("{} {joint} {last}", front.join(", ")),
    }
}

impl Case<'_> {
    /// The title of an effect, of joined effects one by one.
    pub(crate) fn title(&self, names: &str) -> String {
        self.catalogue.title(names)
    }

    /// The findings' titles: `Coulomb friction and sensor lag`.
    pub(crate) fn findings(&self) -> String {
        let findings = self.diagnosis.findings.iter();
        let titles: Vec<_> = findings.map(|f| self.title(&f.effect)).collect();
        list(&titles, "and")
    }

    /// Titles of all effects that a finding may be: itself and its alternatives.
    pub(crate) fn set(&self, finding: &Finding) -> Vec<String> {
        let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
        names.map(|name| self.title(name)).collect()
    }

    /// Whether it is credible that nothing stands in the place of a finding.
    pub(crate) fn may_be_absent(&self, finding: &Finding) -> bool {
        self.diagnosis.may_be_absent(finding, self.catalogue)
    }

    /// The title of a finding, marked if it is uncertain.
    pub(crate) fn told(&self, finding: &Finding) -> String {
        let title = self.title(&finding.effect);
        match finding.is_certain() {
            true => title,
            false => format!("perhaps {title}"),
        }
    }

    /// A parameter of a finding in words.
    pub(crate) fn parameter(&self, finding: &Finding, name: &str) -> String {
        self.parameter_of(&finding.effect, name)
    }

    /// A sentence if forces of the findings are told as deflections: where their unit is that of a position.
    pub(crate) fn forces_told(&self) -> Option<&'static str> {
        let findings = self.diagnosis.findings.iter();
        let mut parameters = findings.flat_map(|own| numbers(own).iter().map(move |p| (own, p)));
        let told = parameters.any(|(own, p)| {
            let known = self.catalogue.effect(&own.effect);
            let mut known = known.into_iter().flat_map(|effect| effect.parameters);
            known.any(|known| known.name == p.name && is_deflection(known.quantity, &p.unit))
        });
        told.then_some(FORCES_TOLD)
    }

    /// The same for the law of a finding.
    pub(crate) fn force_of_law_told(&self, finding: &Finding) -> Option<&'static str> {
        let slot = self.catalogue.effect(&finding.effect)?.slot()?;
        let unit = &finding.curve.as_ref()?.unit;
        is_deflection(slot.quantities()[1], unit).then_some(FORCES_TOLD)
    }

    /// A parameter of an effect in words.
    pub(crate) fn parameter_of(&self, effect: &str, name: &str) -> String {
        let effect = self.catalogue.effect(effect);
        effect.map_or_else(|| plain(name), |effect| effect.parameter_title(name))
    }

    /// The unit of a displayed parameter: a phase is an angle, a stiffness without a unit a multiple of the joint's, a
    /// small number is in parts per million.
    pub(crate) fn shown(&self, effect: &str, parameter: &FittedParameter) -> Shown {
        let FittedParameter {
            name, value, unit, ..
        } = parameter;
        let of = self.catalogue.effect(effect);
        let role = of.and_then(|effect| effect.parameters.iter().find(|own| own.name == name));
        match role.map(|own| (own.role, own.quantity)) {
            Some((ParameterRole::Phase, _)) => Shown::of("rad", *value),
            Some((_, STIFFNESS)) if unit == "1" => Shown {
                factor: 1.0,
                unit: STIFFNESS_TOLD.into(),
            },
            _ if unit == "1" && value.abs() > 0.0 && value.abs() < PER_MILLION => Shown {
                factor: 1e6,
                unit: "ppm".into(),
            },
            _ => Shown::of(unit, *value),
        }
    }

    /// The parameter that gives the size of a finding.
    pub(crate) fn size<'f>(&self, finding: &'f Finding) -> Option<&'f FittedParameter> {
        let effect = self.catalogue.effect(&finding.effect)?;
        let size = effect.parameters[effect.size()].name;
        finding.parameters.iter().find(|own| own.name == size)
    }

    /// The first sentences of the catalogue's paragraph on an effect, without its source.
    pub(crate) fn physics(&self, name: &str) -> Option<String> {
        let text = self.catalogue.effect(name)?.physics;
        let text = text.split("Source:").next().unwrap_or(text).trim();
        Some(sentences(text, 240))
    }

    /// The remedy of an effect.
    pub(crate) fn remedy(&self, name: &str) -> Option<&'static str> {
        Some(self.catalogue.effect(name)?.remedy)
    }
}

/// The listed parameters of a finding; a learned law is shown as a curve instead.
pub fn numbers(finding: &Finding) -> &[FittedParameter] {
    match finding.learned() {
        Some(_) => &[],
        None => &finding.parameters,
    }
}

/// A probability in percent; a value that rounds to 100 or 0 is not shown as certain.
pub fn percent(probability: f64) -> String {
    match 100.0 * probability {
        p if p > 99.0 => "> 99".into(),
        p if p < 1.0 => "< 1".into(),
        p => format!("{p:.0}"),
    }
}

/// Whole sentences of `text`: the first, and as many more as fit into `length` characters.
pub fn sentences(text: &str, length: usize) -> String {
    let mut kept = 0;
    for (index, _) in text.match_indices(". ") {
        let next = text[index + 2..].chars().next();
        if !next.is_some_and(char::is_uppercase) {
            continue;
        }
        if kept > 0 && index + 1 > length {
            break;
        }
        kept = index + 1;
    }
    let whole = kept == 0 || text.len() <= length;
    text[..if whole { text.len() } else { kept }].into()
}

/// Whether a candidate belongs to the diagnosis: it is named, or cannot be distinguished from what is named.
///
/// With several findings an explanation lists its alternatives one by one: a candidate belongs to it if it
/// names an alternative, alone or with the other findings.
pub fn in_set(case: &Case, candidate: &str) -> bool {
    let parts: Vec<&str> = candidate.split(" + ").collect();
    let is = |finding: &Finding, part: &str| {
        finding.effect == part || finding.alternatives.iter().any(|other| other == part)
    };
    let findings = &case.diagnosis.findings;
    let known = |part: &&str| findings.iter().any(|finding| is(finding, part));
    let held = |finding: &Finding| parts.iter().any(|part| is(finding, part));
    let complete = findings
        .iter()
        .all(|finding| held(finding) || case.may_be_absent(finding));
    parts.len() <= findings.len() && parts.iter().all(known) && complete
}

/// The missing quantity, by its unit.
pub fn missing_name(unit: &str) -> &'static str {
    match unit.ends_with("/s^2") {
        true => "missing acceleration",
        false => "missing force",
    }
}

/// Its name beside an axis, where the title says that it is missing.
pub fn short(missing: &'static str) -> &'static str {
    missing.trim_start_matches("missing ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_read_as_words() {
        assert_eq!(
            list(&["a".into(), "b".into(), "c".into()], "or"),
            "a, b or c"
        );
    }

    #[test]
    fn sentences_end_where_they_end() {
        let text = "It is F = k (x + k3 x^3). Teeth harden. Buckling parts soften.";
        assert_eq!(
            sentences(text, 40),
            "It is F = k (x + k3 x^3). Teeth harden."
        );
        assert_eq!(sentences(text, 5), "It is F = k (x + k3 x^3).");
        assert_eq!(sentences(text, 200), text);
    }
}
