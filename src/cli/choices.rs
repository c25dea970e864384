//! Tables of the library as choices on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser};
use quell_shapers::{SHAPERS, Shaper};

use crate::estimators::ESTIMATORS;
use crate::plant::Damping;

/// The table of shapers, with what each does.
pub fn shapers() -> PossibleValuesParser {
    let choice = |shaper: &&dyn Shaper| PossibleValue::new(shaper.name()).help(shaper.summary());
    PossibleValuesParser::new(SHAPERS.iter().map(choice))
}

/// The table of estimators, with what each does.
pub fn estimators() -> PossibleValuesParser {
    PossibleValuesParser::new(
        ESTIMATORS
            .iter()
            .map(|entry| PossibleValue::new(entry.name).help(entry.summary)),
    )
}

/// Where a damper can sit.
pub fn dampings() -> PossibleValuesParser {
    PossibleValuesParser::new(["across_joint", "to_ground"])
}

/// The damping convention of that name.
pub fn damping(name: &str) -> Option<Damping> {
    match name {
        "across_joint" => Some(Damping::AcrossJoint),
        "to_ground" => Some(Damping::ToGround),
        _ => None,
    }
}
