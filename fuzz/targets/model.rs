//! A model file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::model::{Model, Value};

/// All numbers of a model.
fn values(model: &Model) -> impl Iterator<Item = &Value> {
    let parameters = model.effects.iter().flat_map(|effect| &effect.parameters);
    model.values.iter().chain(parameters)
}

fuzz_target!(|text: &str| {
    let model = match Model::from_toml(text, "model.toml") {
        Ok(model) => model,
        Err(error) => return assert!(error.to_string().starts_with("model.toml:")),
    };
    for value in values(&model) {
        assert!(!value.value.is_nan());
        assert!(value.std.is_none_or(|std| std.is_finite() && std > 0.0));
        assert!(
            value
                .bounds
                .is_none_or(|(low, high)| low <= value.value && value.value <= high)
        );
    }
    assert!(!model.fastest().is_nan());
    let written = model.to_toml();
    let again = Model::from_toml(&written, "written.toml")
        .unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert!(values(&model).eq(values(&again)), "{written}");
    assert_eq!(again.to_toml(), written);
    assert!(again.kind.name == model.kind.name && again.hold == model.hold);
});
