//! A predicted experiment: the sensor readings of an explanation, without noise.

use super::programme::positions;
use super::seen::Seen;
use crate::document::ProposedMove;
use crate::point::{Local, Point};
use quell_model::{Experiment, Grid, Kind, Known, Output, simulate_windows};
use quell_recording::Role;

/// Time between the recordings and the proposed experiment, s. Events of the recordings (a payload was gripped,
/// an impact) are over by then, and drift has gone on.
const LATER: f64 = 1.0;

/// An experiment with the explanation's predictions in place of measured values.
pub fn explained(kind: &Kind, point: &Point, experiment: &Experiment, local: &Local) -> Experiment {
    let mut explained = experiment.clone();
    let simulated = simulate_windows(
        kind,
        &point.keys,
        &point.terms,
        experiment,
        &local.departures,
    );
    for (output, &clock) in explained.outputs.iter_mut().zip(&local.clocks) {
        let values = simulated.predict(output, clock).values;
        *output = output.showing(output.time.clone(), values);
    }
    explained
}

/// The experiment for these moves, after `lead` seconds of rest.
pub fn moved(
    base: &Experiment,
    moves: &[ProposedMove],
    seen: &Seen,
    lead: f64,
) -> Option<Experiment> {
    let (_, last) = base.span();
    let period = base.mean_interval();
    let values = positions(moves, seen.start, lead, period).ok()?;
    let start = last + LATER;
    let time: Vec<f64> = (0..values.len())
        .map(|k| start + k as f64 * period)
        .collect();
    let end = time[time.len() - 1];
    let stamps = |output: &Output| -> Vec<f64> {
        let own = &output.time;
        let period = (own[own.len() - 1] - own[0]) / (own.len() - 1).max(1) as f64;
        let count = ((end - start) / period) as usize;
        (0..=count).map(|k| start + k as f64 * period).collect()
    };
    replaced(base, time, values, stamps)
}

/// The recorded experiment, repeated with the input scaled by a share.
pub fn repeated(base: &Experiment, share: f64) -> Option<Experiment> {
    let (first, last) = base.span();
    let shift = last - first + LATER;
    let later = |time: &[f64]| -> Vec<f64> { time.iter().map(|t| t + shift).collect() };
    // A position is scaled about its start; a force, a torque or a current about zero.
    let zero = match base.input.is_position() {
        true => base.input_values[0],
        false => 0.0,
    };
    let values = base.input_values.iter();
    let values = values.map(|v| zero + share * (v - zero)).collect();
    replaced(base, later(&base.input_time), values, |output| {
        later(&output.time)
    })
}

fn replaced(
    base: &Experiment,
    time: Vec<f64>,
    values: Vec<f64>,
    stamps: impl Fn(&Output) -> Vec<f64>,
) -> Option<Experiment> {
    let steps = base.grid.time.windows(2).map(|w| w[1] - w[0]);
    let step = steps.fold(0.0, f64::max) * (1.0 + 1e-9);
    let grid = Grid::new(&time, &values, base.hold, step).ok()?;
    let outputs = base.outputs.iter().map(|output| {
        let time = stamps(output);
        let values = vec![0.0; time.len()];
        output.showing(time, values)
    });
    let position = match base.input {
        Role::CommandPosition => values[0],
        _ => base.initial[0],
    };
    Some(Experiment {
        outputs: outputs.collect(),
        input_smoothed: base.input_smoothed.clone(),
        initial: [position, 0.0, 0.0, 0.0],
        grid,
        windows: Vec::new(),
        coupling: None,
        input_time: time,
        input_values: values,
        position_unit: base.position_unit.clone(),
        input_unit: base.input_unit.clone(),
        force_unit: base.force_unit.clone(),
        payload: base.payload.clone(),
        // Known values of the recorded motion do not hold for this one.
        known: Known::default(),
        ..*base
    })
}
