//! A recording with one effect in it that the model lacks.

use crate::machines::Machine;
use nalgebra::{DMatrix, DVector};
use quell::effects::{Effect, Place, Scales};
use quell::model::StartComponent::{Deformation, DeformationRate, MotorPosition, MotorVelocity};
use quell::model::{Departure, Experiment, Term, simulate};
use quell::recording::{Recording, Role};
use quell::signal::SingularValues;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// The misfit that no refit of the model explains, in times the noise.
const VISIBLE: f64 = 5.0;
/// Largest noise, as a share of the deformation (of the travel where nothing bends).
const LOUDEST: f64 = 0.02;
/// Step of an encoder with 20 bits, rad.
const COUNT: f64 = TAU / 1048576.0;
/// How much the clock of a sensor with its own reads too much, s.
const CLOCK: f64 = 0.0073;

/// A recording, and the noise of its last output.
pub struct Concealed {
    pub recording: Recording,
    pub noise: f64,
}

/// The effect as it is typical of this machine, its size times a factor.
pub fn typical(machine: &Machine, effect: &'static Effect, place: Place, factor: f64) -> Term {
    let scales = scales(machine);
    let typical = effect.parameters.iter().map(|p| (p.typical)(&scales));
    let mut values: Vec<f64> = typical.collect();
    let size = effect.size();
    let neutral = effect.parameters[size].neutral;
    values[size] = neutral + factor * (values[size] - neutral);
    Term::new(effect, place, values)
}

/// A learned law over the whole of what this machine visits; `curve` gives its ordinates over 0 to 1.
pub fn learned(machine: &Machine, name: &str, curve: impl Fn(f64) -> f64) -> Term {
    let effect = Effect::from_name(name).unwrap();
    let place = effect.places[0];
    let mut values = effect.starts_at(place, &scales(machine)).remove(0);
    let knots = values.len() - 2;
    for (k, value) in values[..knots].iter_mut().enumerate() {
        *value = curve(k as f64 / (knots - 1) as f64);
    }
    Term::new(effect, place, values)
}

fn experiment(machine: &Machine) -> Experiment {
    let mut experiment = Experiment::new(&machine.model, &machine.blank).unwrap();
    // A machine moves in one piece.
    experiment.windows.clear();
    experiment
}

fn scales(machine: &Machine) -> Scales {
    let model = &machine.model;
    quell::diagnosis::scales(model.kind, &model.keys(), &[experiment(machine)], model)
}

/// Simulates the machine with the effect, and adds noise of such a size that the effect is seen.
pub fn conceal(machine: &Machine, term: Term, seed: u64) -> Concealed {
    conceal_all(machine, &[term], seed)
}

/// The same with several effects.
pub fn conceal_all(machine: &Machine, terms: &[Term], seed: u64) -> Concealed {
    let experiment = experiment(machine);
    let keys = machine.model.keys();
    let after = seen(
        machine,
        &experiment,
        &keys,
        terms,
        0.0,
        &Departure::default(),
    );
    let scales = scales(machine);
    let rigid = (machine.model.kind.linear)(&keys, experiment.input);
    let size = match rigid.link {
        Some(_) => scales.deformation,
        None => scales.travel(),
    };
    let level = (left(machine, &experiment, &after) / VISIBLE).min(LOUDEST * size);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut recording = machine.blank.clone();
    let mut values = after.iter();
    let mut noise = level;
    for (output, relative) in experiment.outputs.iter().zip(machine.noise) {
        noise = level * relative;
        let mut channels = recording.channels.iter_mut();
        let channel = channels.find(|c| c.role == output.channel).unwrap();
        for (value, true_one) in channel.columns[0].iter_mut().zip(values.by_ref()) {
            let white: f64 = StandardNormal.sample(&mut random);
            *value = true_one * relative + noise * white;
        }
    }
    for channel in &mut recording.channels {
        if channel.role == Role::MotorPosition && channel.unit == "rad" {
            let counted = |value: &mut f64| *value = (*value / COUNT).round() * COUNT;
            channel.columns[0].iter_mut().for_each(counted);
        }
    }
    Concealed { recording, noise }
}

/// All outputs, each in units of its relative noise.
fn seen(
    machine: &Machine,
    experiment: &Experiment,
    keys: &[f64],
    terms: &[Term],
    clock: f64,
    departure: &Departure,
) -> Vec<f64> {
    let simulated = simulate(machine.model.kind, keys, terms, experiment, departure);
    let outputs = experiment.outputs.iter().zip(machine.noise);
    outputs
        .flat_map(|(output, noise)| {
            let clock = if output.own_clock { CLOCK + clock } else { 0.0 };
            let values = simulated.predict(output, clock).values;
            values.into_iter().map(move |value| value / noise)
        })
        .collect()
}

/// Root mean square of what the model's own keys, clock, start and offsets cannot make of the values.
fn left(machine: &Machine, experiment: &Experiment, values: &[f64]) -> f64 {
    let keys = machine.model.keys();
    let given = &machine.model.given;
    let free: Vec<usize> = (0..keys.len()).filter(|&k| given[k]).collect();
    let position = [Role::MotorPosition, Role::CommandPosition];
    let starts = match position.contains(&experiment.input) {
        true => &[][..],
        false => &[MotorPosition, MotorVelocity, Deformation, DeformationRate],
    };
    let at = |unknowns: &[f64]| {
        let (mut keys, mut departure) = (keys.clone(), Departure::default());
        free.iter()
            .zip(unknowns)
            .for_each(|(&k, u)| keys[k] *= u.exp());
        for (component, own) in starts.iter().zip(&unknowns[free.len() + 1..]) {
            departure[*component] = *own;
        }
        let clock = unknowns[free.len()];
        DVector::from_vec(seen(machine, experiment, &keys, &[], clock, &departure))
    };
    let target = DVector::from_column_slice(values);
    let mut unknowns = vec![0.0; free.len() + 1 + starts.len()];
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let here = at(&unknowns);
        let slope = |k: usize| {
            let mut moved = unknowns.clone();
            moved[k] += 1e-5;
            (at(&moved) - &here) / 1e-5
        };
        let mut columns: Vec<DVector<f64>> = (0..unknowns.len()).map(slope).collect();
        columns.extend(offsets(experiment));
        if columns.iter().any(|column| !column.norm().is_finite()) {
            break;
        }
        let (step, rest) = solve(&(&target - &here), &columns);
        least = least.min(rest);
        let moved = unknowns.iter_mut().zip(step.iter());
        moved.for_each(|(u, s)| *u += s.clamp(-0.1, 0.1));
    }
    least / (values.len() as f64).sqrt()
}

/// A column of ones for each output.
fn offsets(experiment: &Experiment) -> Vec<DVector<f64>> {
    let all = experiment.samples();
    let mut first = 0;
    let column = |output: &quell::model::Output| {
        let own = first..first + output.values.len();
        first = own.end;
        DVector::from_fn(all, |k, _| f64::from(u8::from(own.contains(&k))))
    };
    experiment.outputs.iter().map(column).collect()
}

/// Coefficients of the columns that make most of the vector, and the length of what is left.
fn solve(vector: &DVector<f64>, columns: &[DVector<f64>]) -> (DVector<f64>, f64) {
    let norms: Vec<f64> = columns.iter().map(|c| c.norm().max(1e-300)).collect();
    let scaled: Vec<DVector<f64>> = columns.iter().zip(&norms).map(|(c, n)| c / *n).collect();
    let matrix = DMatrix::from_columns(&scaled);
    let solved = SingularValues::of(&matrix).unwrap().solve(vector, 1e-9);
    let left = (vector - &matrix * &solved).norm();
    let own = |k: usize, _| solved[k] / norms[k];
    (DVector::from_fn(solved.len(), own), left)
}
