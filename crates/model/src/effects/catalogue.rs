//! A list of effects, with look-up by name.

use super::{EFFECTS, Effect, LEARNED, PLACES, Place};

/// Effects that may be missing from a model.
///
/// Search and reports use only this list; the default holds [`EFFECTS`].
#[derive(Clone, Copy, Debug)]
pub struct Catalogue(pub &'static [&'static Effect]);

impl Default for Catalogue {
    fn default() -> Self {
        Self(EFFECTS)
    }
}

impl Catalogue {
    /// The effect of this name; learned laws are included in every catalogue.
    pub fn effect(self, name: &str) -> Option<&'static Effect> {
        let mut known = self.0.iter().chain(LEARNED).copied();
        known.find(|effect| effect.name == name)
    }

    /// The first effect that meets a condition.
    pub fn find(self, is: impl Fn(&Effect) -> bool) -> Option<&'static Effect> {
        self.0.iter().copied().find(|effect| is(effect))
    }

    /// Title of an effect's name within a sentence. Names joined by ` + ` are handled one by one. A name that
    /// is no effect, such as a key of the model, is split into words.
    ///
    /// # Example
    /// ```
    /// use quell_model::effects::Catalogue;
    /// let title = Catalogue::default().title("coulomb_friction + sensor_lag");
    /// assert_eq!(title, "Coulomb friction + sensor lag");
    /// ```
    pub fn title(self, names: &str) -> String {
        let title = |name| {
            let effect = self.effect(name);
            effect.map_or_else(|| words(name), |effect| effect.title.to_string())
        };
        let titles: Vec<String> = names.split(" + ").map(title).collect();
        titles.join(" + ")
    }

    /// Names of the effects at each place, in the order of the places.
    pub fn by_place(self) -> Vec<(Place, Vec<&'static str>)> {
        let at = |place: Place| {
            let there = self
                .0
                .iter()
                .filter(|effect| effect.places.contains(&place));
            (place, there.map(|effect| effect.name).collect())
        };
        PLACES.iter().map(|entry| at(entry.0)).collect()
    }
}

/// A name of a file in words: `deformation_rate` is `deformation rate`.
pub fn words(name: &str) -> String {
    name.replace('_', " ")
}
