//! `diagnosis.json`.

use super::fields::Sources;

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
         [What a verdict means](../guide/verdicts.md) says what to do.\n\n## Verdict\n\n{}",
        sources.variants("Verdict")
    );
    for name in OBJECTS.into_iter().chain(["Candidate"]) {
        page += &format!("## {name}\n\n{}", sources.fields(name));
    }
    page
}
