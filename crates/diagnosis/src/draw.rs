//! The series that a report draws.

use super::explanation::Explanation;
use super::locate::Located;
use super::search::Search;
use super::traces::{CoordinateTrace, OutputTrace, SpectrumTrace, Traces};
use super::units::{of_values, over_seconds_squared};
use quell_model::effects::Place;
use quell_model::{Experiment, Output};
use quell_recording::Role;
use quell_signal::{CubicSpline, End, Window, spectrum};
use std::f64::consts::TAU;

/// Series of a report: recorded, before and after, spectra of the residuals, location.
pub fn draw(
    search: &Search,
    before: &Explanation,
    after: &Explanation,
    located: &Located,
) -> Traces {
    let mut outputs = Vec::new();
    for (e, experiment) in search.problem.experiments.iter().enumerate() {
        let residual = |explanation: &Explanation| {
            let point = &explanation.fitted.point;
            search.problem.explained(point, e)
        };
        let (old, new) = (residual(before), residual(after));
        for (k, output) in experiment.outputs.iter().enumerate() {
            let held = search.judge.data.held_out[e][k].iter();
            outputs.push(OutputTrace {
                noise_std: search.problem.noise[e][k].deviation * output.scale,
                held_out: held
                    .map(|r| [output.time[r.start], output.time[r.end - 1]])
                    .collect(),
                ..trace(experiment, output, &old[k], &new[k])
            });
        }
    }
    let experiment = &search.problem.experiments[0];
    let first = &experiment.outputs[0];
    Traces {
        missing_time: first.time.clone(),
        missing: located.missing.clone(),
        missing_std: located.missing_std.clone(),
        missing_unit: over_seconds_squared(&of_values(experiment, first)),
        coordinate: coordinate(experiment, located),
        spectrum: outputs.first().map(spectra).unwrap_or_default(),
        phases: located.phases.clone(),
        outputs,
    }
}

/// The coordinate that the missing part follows, with units. At a sensor the missing part is the residual
/// itself.
fn coordinate(experiment: &Experiment, located: &Located) -> Option<CoordinateTrace> {
    let position = &experiment.position_unit;
    let trace = located.coordinate.clone()?;
    let coordinate_unit = match trace.coordinate.as_str() {
        "time" => "s".into(),
        // A hysteresis state is a number from -1 to 1.
        "hysteresis" => "1".into(),
        "velocity" | "deformation rate" => format!("{position}/s"),
        "acceleration" | "lagged acceleration" => over_seconds_squared(position),
        _ => position.clone(),
    };
    let own = of_values(experiment, &experiment.outputs[0]);
    Some(CoordinateTrace {
        coordinate_unit,
        unit: match located.location.place.as_deref() == Some(Place::Sensor.name()) {
            true => own,
            false => over_seconds_squared(&own),
        },
        ..trace
    })
}

fn trace(experiment: &Experiment, output: &Output, old: &[f64], new: &[f64]) -> OutputTrace {
    let shown = rigid(experiment, output);
    let scale = output.scale;
    let recorded: Vec<f64> = (0..output.values.len())
        .map(|i| (output.values[i] - shown[i]) * scale)
        .collect();
    let model = |residual: &[f64]| -> Vec<f64> {
        recorded
            .iter()
            .zip(residual)
            .map(|(y, r)| y - r * scale)
            .collect()
    };
    OutputTrace {
        name: match shown.iter().any(|u| *u != 0.0) {
            true => "deformation".into(),
            false => output.channel.name().replace('_', " "),
        },
        unit: output.unit.clone(),
        time: output.time.clone(),
        before: model(old),
        after: model(new),
        recorded,
        noise_std: 0.0,
        held_out: Vec::new(),
    }
}

/// An output as it is drawn: a link position as deformation.
pub fn shown(experiment: &Experiment, output: &Output) -> Vec<f64> {
    let rigid = rigid(experiment, output);
    output
        .values
        .iter()
        .zip(rigid)
        .map(|(y, u)| y - u)
        .collect()
}

/// The rigid motion that is subtracted from a link position, so that its deformation is visible.
fn rigid(experiment: &Experiment, output: &Output) -> Vec<f64> {
    let kinematic = matches!(
        experiment.input,
        Role::MotorPosition | Role::CommandPosition
    );
    let still = vec![0.0; output.time.len()];
    if !(kinematic && output.role == Role::LinkPosition) {
        return still;
    }
    let (first, last) = experiment.span();
    let spline = CubicSpline::new(
        &experiment.input_time,
        &experiment.input_values,
        End::NotAKnot,
    );
    spline.map_or(still, |spline| {
        let at = |t: &f64| spline.value((t - output.clock_offset).clamp(first, last));
        output.time.iter().map(at).collect()
    })
}

/// Spectra of the residuals. Uneven stamps are first brought to an even grid of the mean period.
fn spectra(trace: &OutputTrace) -> SpectrumTrace {
    let n = trace.time.len();
    let period = (trace.time[n - 1] - trace.time[0]) / (n.max(2) - 1) as f64;
    let of = |model: &[f64]| {
        let residual: Vec<f64> = trace
            .recorded
            .iter()
            .zip(model)
            .map(|(y, p)| y - p)
            .collect();
        spectrum(&residual, period, Window::Hann, 1).ok()
    };
    match (of(&trace.before), of(&trace.after)) {
        (Some(before), Some(after)) => SpectrumTrace {
            frequency: (0..before.amplitude.len())
                .map(|k| k as f64 * before.resolution / TAU)
                .collect(),
            before: before.amplitude,
            after: after.amplitude,
        },
        _ => SpectrumTrace::default(),
    }
}
