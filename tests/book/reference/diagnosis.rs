//! `diagnosis.json`, in words and as a JSON schema.

use super::fields::Sources;
use quell::diagnosis::Diagnosis;
use schemars::generate::SchemaSettings;

/// Objects of the file, the outermost first.
const OBJECTS: [&str; 14] = [
    "Diagnosis",
    "Finding",
    "FittedParameter",
    "LawCurve",
    "LearnedLaw",
    "NearestLaw",
    "LawParameter",
    "Location",
    "Fit",
    "Quality",
    "Scored",
    "Score",
    "NextMove",
    "ProposedMove",
];

pub fn page() -> String {
    let sources = Sources::of(&[
        "crates/diagnosis/src/document.rs",
        "crates/diagnosis/src/law_curve.rs",
    ]);
    let mut page = format!(
        "# `diagnosis.json`\n\n`quell diagnose --out DIR` writes it, `quell diagnose --json` prints it. \
         [What a verdict means](../guide/verdicts.md) says what to do. [`diagnosis.schema.json`](diagnosis.schema.json) is this page as a JSON schema \
         (2020-12): it checks files, and generators make types of it.\n\n## Verdict\n\n{}",
        sources.variants("Verdict")
    );
    for name in OBJECTS.into_iter().chain(["Candidate"]) {
        page += &format!("## {name}\n\n{}", sources.fields(name));
    }
    page
}

/// The file as it is written: a key that may be absent is not required.
pub fn schema() -> String {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let schema = settings
        .into_generator()
        .into_root_schema_for::<Diagnosis>();
    serde_json::to_string_pretty(&schema).unwrap()
}
