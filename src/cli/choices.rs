//! Tables of the library as choices on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use quell_shapers::{SHAPERS, Shaper, shaper_by_name};

use crate::estimators::{ESTIMATORS, EstimatorEntry, estimator};
use crate::plant::Damping;
use crate::proof::Kind;
use crate::signal::TipRegistration;

/// The table of shapers, with what each does.
pub fn shapers() -> impl TypedValueParser<Value = &'static dyn Shaper> {
    let choice = |shaper: &&dyn Shaper| PossibleValue::new(shaper.name()).help(shaper.summary());
    PossibleValuesParser::new(SHAPERS.iter().map(choice))
        .try_map(|name| shaper_by_name(&name).ok_or("there is no such shaper"))
}

/// The table of estimators, with what each does.
pub fn estimators() -> impl TypedValueParser<Value = &'static EstimatorEntry> {
    let choice = |entry: &EstimatorEntry| PossibleValue::new(entry.name).help(entry.summary);
    PossibleValuesParser::new(ESTIMATORS.iter().map(choice))
        .try_map(|name| estimator(&name).ok_or("there is no such estimator"))
}

/// The ways to register a tip sensor, with what each does.
pub fn registrations() -> impl TypedValueParser<Value = TipRegistration> {
    let ways = TipRegistration::ALL;
    let choice = |way: &TipRegistration| PossibleValue::new(way.name()).help(way.summary());
    PossibleValuesParser::new(ways.iter().map(choice)).try_map(|name| {
        let found = ways.iter().find(|way| way.name() == name);
        found.copied().ok_or("there is no such registration")
    })
}

/// The kinds of concealed cases, with what each hides.
pub fn kinds() -> impl TypedValueParser<Value = Kind> {
    let choice = |kind: Kind| PossibleValue::new(kind.name()).help(kind.summary());
    PossibleValuesParser::new(Kind::ALL.map(choice)).try_map(|name| name.parse::<Kind>())
}

/// The possible places of a damper.
pub fn dampings() -> impl TypedValueParser<Value = Damping> {
    let choices = [
        PossibleValue::new("across_joint").help("between motor side and link"),
        PossibleValue::new("to_ground").help("between link and ground"),
    ];
    PossibleValuesParser::new(choices).map(|name| match name.as_str() {
        "to_ground" => Damping::ToGround,
        _ => Damping::AcrossJoint,
    })
}
