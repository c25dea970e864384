//! The effects that may stand in the place of a finding.

use super::found::is_or_contains;
use super::point::EffectAt;
use quell_model::effects::Effect;

/// The effects in the place of `effect`, from the explanations that fit as well as `best`. An explanation counts if it
/// keeps all other effects of the best one, or laws that have them as limits: what differs beside those stands in the
/// place of this effect alone.
pub fn alternatives(
    effect: EffectAt,
    best: &[EffectAt],
    equals: &[Vec<EffectAt>],
) -> Vec<&'static Effect> {
    let has =
        |equal: &[EffectAt], simple: &EffectAt| equal.iter().any(|law| is_or_contains(law, simple));
    let mut found: Vec<&'static Effect> = Vec::new();
    for equal in equals {
        let mut others = best.iter().filter(|own| **own != effect);
        if has(equal, &effect) || !others.all(|other| has(equal, other)) {
            continue;
        }
        let kept = |law: &EffectAt| best.iter().any(|own| is_or_contains(law, own));
        for (other, _) in equal.iter().filter(|law| !kept(law)) {
            if !found.contains(other) {
                found.push(other);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_model::effects::EFFECTS;

    fn at_first_place(name: &str) -> EffectAt {
        let effect = EFFECTS.iter().find(|effect| effect.name == name);
        let effect = effect.unwrap_or_else(|| panic!("no effect {name}"));
        (effect, effect.places[0])
    }

    fn all(names: &[&str]) -> Vec<EffectAt> {
        names.iter().map(|name| at_first_place(name)).collect()
    }

    fn names(effect: &str, best: &[&str], equals: &[&[&str]]) -> Vec<&'static str> {
        let equals: Vec<_> = equals.iter().map(|equal| all(equal)).collect();
        let found = alternatives(at_first_place(effect), &all(best), &equals);
        found.into_iter().map(|effect| effect.name).collect()
    }

    /// Of a pair each finding has the alternatives of its own place; one that replaces both belongs to neither.
    #[test]
    fn each_finding_has_what_takes_its_own_place() {
        let best = ["gravity_load", "cubic_stiffness"];
        let equals: [&[&str]; 3] = [
            &["misalignment", "cubic_stiffness"],
            &["gravity_load", "backlash"],
            &["sensor_lag", "sensor_delay"],
        ];
        assert_eq!(names("gravity_load", &best, &equals), ["misalignment"]);
        assert_eq!(names("cubic_stiffness", &best, &equals), ["backlash"]);
        // Of a single finding all that stands for it together is its alternative.
        let equals: [&[&str]; 1] = [&["sensor_lag", "sensor_delay"]];
        let found = names("gravity_load", &["gravity_load"], &equals);
        assert_eq!(found, ["sensor_lag", "sensor_delay"]);
        // A law that holds the other finding as its limit keeps it.
        let best = ["gravity_load", "coulomb_friction"];
        let equals: [&[&str]; 1] = [&["misalignment", "stribeck_friction"]];
        assert_eq!(names("gravity_load", &best, &equals), ["misalignment"]);
        assert!(names("coulomb_friction", &best, &equals).is_empty());
    }
}
