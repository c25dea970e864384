//! The model that a fitted point makes of the given one.

use super::point::Point;
use quell_model::{Model, ModelEffect, Value};

/// The given model plus those findings that belong to the machine, with their fitted parameters.
pub fn better_model(model: &Model, point: &Point) -> Model {
    let mut better = model.clone();
    for (value, fitted) in better.values.iter_mut().zip(&point.keys) {
        value.value = *fitted;
    }
    let (given, found) = point.terms.split_at(point.given_terms);
    for (effect, term) in better.effects.iter_mut().zip(given) {
        for (value, fitted) in effect.parameters.iter_mut().zip(&term.values) {
            value.value = *fitted;
        }
    }
    for term in found.iter().filter(|term| term.recording.is_none()) {
        better.effects.push(ModelEffect {
            effect: term.effect,
            place: term.place,
            parameters: term
                .values
                .iter()
                .map(|value| Value::from(*value))
                .collect(),
        });
    }
    better
}
