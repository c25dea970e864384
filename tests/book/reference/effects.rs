//! The catalogue of effects.

use super::{codes, table};
use quell::effects::{Catalogue, EFFECTS, Effect, LEARNED, Place, Units};

pub fn page() -> String {
    let mut page = String::from(
        "# Effects\n\nWhat a diagnosis can name, and a model file can hold as an `[[effect]]`. \
         [The model file](model.md) says how.\n\n## By place\n\n",
    );
    page += &table(["place", "effects"], by_place(Catalogue::default()));
    page += "## Laws of learned shape, by place\n\n";
    page += &table(["place", "laws"], by_place(Catalogue(LEARNED)));
    page += "Units of parameters are written for a linear axis driven by a force: N and m. On a joint they are N.m and \
             rad; where the model divides forces by its stiffness, a force has the unit of a position.\n\n";
    for effect in EFFECTS {
        page += &section(effect);
    }
    page + "## Learned laws\n\n"
        + &table(["name", "places", "physics"], LEARNED.iter().map(learned))
}

fn by_place(catalogue: Catalogue) -> Vec<[String; 2]> {
    let row = |(place, names): (Place, Vec<&str>)| [place.name().to_string(), codes(names)];
    let places = catalogue.by_place().into_iter();
    places
        .filter(|(_, names)| !names.is_empty())
        .map(row)
        .collect()
}

fn places(effect: &Effect) -> String {
    codes(effect.places.iter().map(|place| place.name()))
}

fn section(effect: &Effect) -> String {
    let units = Units {
        force: "N".into(),
        position: "m".into(),
        input: "N".into(),
        reference: "N".into(),
    };
    let rows = effect.parameters.iter().map(|parameter| {
        let role = format!("{:?}", parameter.role).to_lowercase();
        [
            format!("`{}`", parameter.name),
            parameter.quantity.unit(&units),
            role,
            parameter.neutral.to_string(),
        ]
    });
    format!(
        "## `{}`\n\nPlace: {}.\n\n{}\n\n{}What to do: {}\n\n",
        effect.name,
        places(effect),
        effect.physics,
        table(["parameter", "unit", "role", "neutral value"], rows),
        effect.remedy,
    )
}

fn learned(effect: &&'static Effect) -> [String; 3] {
    [
        format!("`{}`", effect.name),
        places(effect),
        effect.physics.to_string(),
    ]
}
