//! The ways to register a tip sensor, compared on one recording.

use serde_json::{Value, json};

use super::prior;
use crate::identification::{
    Identification, IdentificationError, NominalModel, OffLine, Series, identify, prepare,
};
use crate::page::{Table, columns, fixed, significant};
use crate::recording::Recording;
use crate::signal::{ArcRegistration, TipRegistration};

const TAU: f64 = core::f64::consts::TAU;

/// One way, and its result.
pub struct Registered {
    way: TipRegistration,
    outcome: Result<Outcome, IdentificationError>,
}

struct Outcome {
    registration: ArcRegistration,
    fit: Option<OffLine>,
}

impl Outcome {
    /// `None` if the recording has no tip sensor in its own frame.
    fn of(series: &Series, found: &Identification) -> Option<Self> {
        Some(Self {
            registration: series.registration.clone()?,
            fit: found.reference().batch().cloned(),
        })
    }

    /// Root mean square distance of the tip from the arc, m.
    fn residual(&self) -> f64 {
        let ArcRegistration {
            normal_rms,
            radial_rms,
            ..
        } = self.registration;
        normal_rms.hypot(radial_rms)
    }
}

/// All ways, with the result of the `chosen` one from `found`; empty if there is nothing to register.
pub fn all(
    recording: &Recording,
    model: Option<&NominalModel>,
    chosen: TipRegistration,
    (series, found): (&Series, &Identification),
) -> Vec<Registered> {
    if series.registration.is_none() {
        return Vec::new();
    }
    let ways = TipRegistration::ALL.iter().filter_map(|&way| {
        let outcome = match way == chosen {
            true => Ok(Outcome::of(series, found)),
            false => other(recording, model, way),
        };
        Some(Registered {
            way,
            outcome: outcome.transpose()?,
        })
    });
    ways.collect()
}

fn other(
    recording: &Recording,
    model: Option<&NominalModel>,
    way: TipRegistration,
) -> Result<Option<Outcome>, IdentificationError> {
    let series = prepare(recording.clone(), model, way)?;
    let found = identify(&series.samples, prior(model, &series))?;
    Ok(Outcome::of(&series, &found))
}

/// The JSON for `--json`.
pub fn document(registered: &[Registered]) -> Value {
    let one = |registered: &Registered| {
        let outcome = registered.outcome.as_ref().ok();
        let registration = outcome.map(|outcome| &outcome.registration);
        let fit = outcome.and_then(|outcome| outcome.fit.as_ref());
        json!({
            "method": registered.way.name(),
            "residual_mm": outcome.map(|outcome| 1e3 * outcome.residual()),
            "angle_error_mrad": registration.map(|r| 1e3 * r.angle_error),
            "clock_offset_ms": registration.map(|r| 1e3 * r.clock.offset),
            "clock_offset_std_ms": registration.map(|r| 1e3 * r.clock_offset_std),
            "frequency_hz": fit.map(|fit| fit.mode.hertz()),
            "frequency_std_hz": fit.and_then(|fit| Some(fit.natural_frequency_std? / TAU)),
            "damping_ratio": fit.map(|fit| fit.mode.damping_ratio()),
            "damping_std": fit.and_then(|fit| fit.damping_ratio_std),
            "refused": registered.outcome.as_ref().err().map(ToString::to_string),
        })
    };
    registered.iter().map(one).collect()
}

/// The text for the terminal; empty if there is nothing to compare.
pub fn text(registered: &[Registered]) -> String {
    if registered.is_empty() {
        return String::new();
    }
    let rows = registered.iter().map(|one| {
        let figure = |of: &dyn Fn(&Outcome) -> Option<f64>, digits| {
            let value = one.outcome.as_ref().ok().and_then(of);
            value.map_or("-".into(), |value| fixed(value, digits))
        };
        [
            one.way.name().to_string(),
            figure(&|outcome| Some(1e6 * outcome.residual()), 2),
            figure(&|outcome| Some(1e3 * outcome.registration.angle_error), 4),
            figure(&|outcome| Some(1e3 * outcome.registration.clock.offset), 3),
            figure(&|outcome| Some(outcome.fit.as_ref()?.mode.hertz()), 3),
            figure(
                &|outcome| Some(outcome.fit.as_ref()?.mode.damping_ratio()),
                4,
            ),
        ]
    });
    let heads = [
        "registration",
        "residual_um",
        "angle_error_mrad",
        "clock_ms",
        "f_hz",
        "xi",
    ];
    columns(heads, rows)
}

/// The table for the report; `None` if there is nothing to compare.
pub fn table(registered: &[Registered]) -> Option<Table> {
    if registered.is_empty() {
        return None;
    }
    let mut table = Table::new("The frame of the tip sensor, by two registrations")
        .text_column("registration")
        .column("residual", "um")
        .column("angle error", "mrad")
        .column("clock", "ms")
        .column("frequency", "Hz")
        .column("damping ratio", "")
        .note(
            "Residual: root mean square distance of the tip from its arc. Angle error: how far the tip \
             seems ahead of the motor side while nothing deforms the joint. Frequency and damping ratio are \
             those of the batch fit.",
        );
    for one in registered {
        let figure =
            |of: &dyn Fn(&Outcome) -> Option<f64>| one.outcome.as_ref().ok().and_then(of).into();
        let four = |of: &dyn Fn(&Outcome) -> Option<f64>| {
            let value = one.outcome.as_ref().ok().and_then(of);
            significant(value.unwrap_or(f64::NAN), 4).into()
        };
        table = table.row([
            one.way.name().into(),
            figure(&|outcome| Some(1e6 * outcome.residual())),
            figure(&|outcome| Some(1e3 * outcome.registration.angle_error)),
            figure(&|outcome| Some(1e3 * outcome.registration.clock.offset)),
            four(&|outcome| Some(outcome.fit.as_ref()?.mode.hertz())),
            four(&|outcome| Some(outcome.fit.as_ref()?.mode.damping_ratio())),
        ]);
    }
    Some(table)
}

/// The errors of the ways that failed.
pub fn remarks(registered: &[Registered]) -> impl Iterator<Item = String> {
    registered.iter().filter_map(|one| {
        let error = one.outcome.as_ref().err()?;
        Some(format!("Registration by {}: {error}.", one.way.name()))
    })
}
