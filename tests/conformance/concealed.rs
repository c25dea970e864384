//! A recording with one effect in it that the model lacks.

use crate::machines::Machine;
use nalgebra::{DMatrix, DVector};
use quell::effects::{Effect, Place};
use quell::model::{Experiment, Term, simulate};
use quell::recording::{Recording, Role};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What no refit of the model explains, in times the noise.
const VISIBLE: f64 = 5.0;
/// Largest noise of the first output, as a share of the deformation (or of the travel).
const LOUDEST: f64 = 0.02;
/// Step of an encoder with 20 bits, rad.
const COUNT: f64 = std::f64::consts::TAU / 1048576.0;
/// How much the clock of a sensor with its own reads too much, s.
const CLOCK: f64 = 0.0073;

/// A recording, and what is in it.
pub struct Concealed {
    pub recording: Recording,
    pub values: Vec<f64>,
    /// Rms of what no refit explains, over the noise.
    pub residual: f64,
    /// Noise of the last output.
    pub noise: f64,
}

/// Simulates the machine with the effect at this many times its typical size, and adds noise.
pub fn conceal(machine: &Machine, effect: &'static Effect, place: Place, factor: f64, seed: u64) -> Concealed {
    let model = &machine.model;
    let experiment = Experiment::new(model, &machine.blank).unwrap();
    let experiments = [experiment];
    let scales = quell::diagnosis::scales(model.kind, &model.keys(), &experiments, model);
    let [experiment] = experiments;
    let mut values: Vec<f64> = effect.parameters.iter().map(|p| (p.typical)(&scales)).collect();
    values[0] = effect.parameters[0].neutral + factor * (values[0] - effect.parameters[0].neutral);
    let seen = |keys: &[f64], terms: &[Term], clock: f64, departure: &[f64; 8]| -> Vec<f64> {
        let simulated = simulate(model.kind, keys, terms, &experiment, departure);
        let clock = |own: bool| if own { CLOCK + clock } else { 0.0 };
        let outputs = experiment.outputs.iter().zip(machine.noise);
        outputs.flat_map(|(o, noise)| simulated.predict(o, clock(o.own_clock)).values.into_iter().map(move |v| v / noise)).collect()
    };
    let still = [0.0; 8];
    let keys = model.keys();
    let before = seen(&keys, &[], 0.0, &still);
    let term = Term { effect, place, values: values.clone() };
    let after = seen(&keys, &[term], 0.0, &still);
    // What the model's own parameters, clock, start and offsets can do.
    let free: Vec<usize> = (0..keys.len()).filter(|&k| model.given[k]).collect();
    let moving = experiment.input != Role::MotorPosition && experiment.input != Role::CommandPosition;
    let count = free.len() + 1 + if moving { 4 } else { 0 };
    let at = |unknowns: &[f64]| {
        let (mut keys, mut departure) = (keys.clone(), still);
        free.iter().zip(unknowns).for_each(|(&k, u)| keys[k] *= u.exp());
        unknowns[free.len() + 1..].iter().zip(&mut departure).for_each(|(u, d)| *d = *u);
        DVector::from_vec(seen(&keys, &[], unknowns[free.len()], &departure))
    };
    let mut offsets = Vec::new();
    let mut first = 0;
    for length in experiment.outputs.iter().map(|o| o.values.len()) {
        offsets.push(DVector::from_fn(before.len(), |k, _| f64::from((first..first + length).contains(&k))));
        first += length;
    }
    let target = DVector::from_vec(after.clone());
    let mut unknowns = vec![0.0; count];
    let mut left = f64::INFINITY;
    for _ in 0..5 {
        let here = at(&unknowns);
        let mut columns: Vec<DVector<f64>> = (0..count).map(|k| {
            let mut moved = unknowns.clone();
            moved[k] += 1e-5;
            (at(&moved) - &here) / 1e-5
        }).collect();
        columns.extend(offsets.iter().cloned());
        let (solved, rest) = solve(&(&target - &here), &columns);
        left = left.min(rest);
        unknowns.iter_mut().zip(solved.iter()).for_each(|(u, s)| *u += s);
    }
    let rms = left / (before.len() as f64).sqrt();
    let size = if scales.deformation > 1e-9 { scales.deformation } else { scales.travel() };
    let level = (rms / VISIBLE).min(LOUDEST * size);
    // The record.
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut recording = machine.blank.clone();
    let mut next = after.iter();
    let mut noise = level;
    let count = experiment.outputs.len();
    for (k, (output, relative)) in experiment.outputs.iter().zip(machine.noise).enumerate() {
        let channel = recording.channels.iter_mut().find(|c| c.role == output.channel).unwrap();
        noise = level * relative;
        for value in &mut channel.columns[0] {
            let white: f64 = StandardNormal.sample(&mut random);
            *value = next.next().unwrap() * relative + noise * white;
            if count > 1 && k == 0 { *value = rounded(*value, COUNT); }
        }
    }
    let input = &mut recording.channels[0];
    if input.role == Role::MotorPosition {
        input.columns[0].iter_mut().for_each(|value| *value = rounded(*value, COUNT));
    }
    let residual = if rms < 1e-6 * size { 0.0 } else { rms / level };
    Concealed { recording, values, residual, noise }
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// Coefficients of the columns that make most of the vector, and the length of what is left.
fn solve(vector: &DVector<f64>, columns: &[DVector<f64>]) -> (DVector<f64>, f64) {
    let norms: Vec<f64> = columns.iter().map(|c| c.norm().max(1e-300)).collect();
    let scaled: Vec<DVector<f64>> = columns.iter().zip(&norms).map(|(c, n)| c / *n).collect();
    let matrix = DMatrix::from_columns(&scaled);
    let solved = matrix.clone().svd(true, true).solve(vector, 1e-9).unwrap();
    let left = (vector - &matrix * &solved).norm();
    (DVector::from_fn(solved.len(), |k, _| solved[k] / norms[k]), left)
}
