//! The unit of a channel whose names do not tell one that is known.

use super::super::role::Role;
use super::super::unit::Dimension;
use super::Guess;
use super::content::Content;
use super::drives;
use super::inertial;
use super::robots;

/// Standard acceleration of free fall, m/s^2.
const G_N: f64 = 9.80665;

/// Largest relative difference of an accelerometer's mean at rest from that: its offset, and the tilt of the
/// other axes.
const OFFSET: f64 = 0.05;

/// Why a channel is one of an accelerometer, or in this unit.
pub const GRAVITY: &str = "its mean is the gravity of the earth";

/// The unit of a channel whose names do not contain it.
pub fn of(content: &Content, role: Role, columns: &[usize]) -> Guess<String> {
    let told = content.columns[columns[0]].name.unit.as_ref();
    let no_unit = told.map_or("no unit in its name".into(), |unit| {
        format!("the unit {unit:?} in its name is not known")
    });
    if let Some((_, unit)) = drives::odrive(&content.columns[columns[0]].name) {
        return Guess::guessed(unit.into(), "ODrive tells turns since its firmware 0.5");
    }
    match robots::signal(content, columns[0]) {
        Some(Some((_, unit, true))) => return Guess::known(unit.into()),
        Some(Some((_, unit, false))) => {
            return Guess::guessed(unit.into(), "by the name of the maker's signal");
        }
        _ => {}
    }
    if let Some((_, Some(unit))) = inertial::axis(&content.columns[columns[0]].name) {
        return Guess::known(unit.into());
    }
    if role != Role::TipAcceleration {
        let usual = role.entry().dimensions[0];
        if told.is_some_and(|unit| unit == "%") {
            return Guess::guessed("raw".into(), share(role));
        }
        let raw = Guess::guessed("raw".into(), no_unit);
        if told.is_some() {
            return raw;
        }
        return match usual {
            Dimension::Angle | Dimension::Length => raw,
            dimension => by_role(dimension)
                .map_or(raw, |si| Guess::guessed(si.into(), "no unit in its name")),
        };
    }
    if content.told_rate_hz.is_some() {
        return Guess::known("g".into());
    }
    if content.is_klipper() {
        return Guess::known("mm/s^2".into());
    }
    if let Some(unit) = of_gravity(content, columns) {
        return Guess::guessed(unit.into(), GRAVITY);
    }
    Guess::guessed("raw".into(), no_unit + "; a frequency does not need one")
}

/// The unit in which the mean of these columns is the gravity of the earth.
pub fn of_gravity(content: &Content, columns: &[usize]) -> Option<&'static str> {
    let mean = |index: &usize| {
        let there = content.columns[*index]
            .numbers
            .iter()
            .filter(|value| !value.is_nan());
        there.clone().sum::<f64>() / there.count().max(1) as f64
    };
    let pull = columns
        .iter()
        .map(mean)
        .map(|mean| mean * mean)
        .sum::<f64>()
        .sqrt();
    let units = [
        ("m/s^2", G_N),
        ("g", 1.0),
        ("mm/s^2", 1e3 * G_N),
        ("mg", 1e3),
    ];
    let fits = |own: &&(&str, f64)| (pull / own.1 - 1.0).abs() < OFFSET;
    units.iter().find(fits).map(|own| own.0)
}

/// What to write for a share of a nominal value.
fn share(role: Role) -> String {
    let line = match by_role(role.entry().dimensions[0]) {
        Some(si) => {
            format!("for {si} write unit = \"{si}\" and scale = the nominal value in {si} / 100")
        }
        None => "write its unit and scale = the nominal value / 100".into(),
    };
    format!("% of a nominal value; {line}")
}

fn by_role(dimension: Dimension) -> Option<&'static str> {
    let of = super::super::unit::UNITS
        .iter()
        .find(|unit| unit.dimension == dimension);
    of.map(|unit| unit.si)
}
