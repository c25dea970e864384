//! What is written keeps to the schema in the book.

use super::fixtures::all;
use serde_json::Value;

/// Fails where a `diagnosis.json` does not keep to the schema.
pub fn check(diagnosis: &Value) {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/docs/src/reference/diagnosis.schema.json"
    );
    let schema = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors = validator.iter_errors(diagnosis);
    let errors: Vec<_> = errors
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(errors.is_empty(), "{errors:#?}");
    // A schema that takes anything is none.
    let mut without = diagnosis.clone();
    without.as_object_mut().unwrap().remove("verdict");
    assert!(!validator.is_valid(&without));
}

#[test]
fn every_diagnosis_keeps_to_the_schema() {
    for one in all() {
        check(&serde_json::to_value(&one.outcome.diagnosis).unwrap());
    }
}
