//! What a model shows of an experiment.

use quell_model::{Departure, Experiment, Model, Term, simulate};

/// The first output with these effects, from the measured start.
pub fn shown(model: &Model, terms: &[Term], experiment: &Experiment) -> Vec<f64> {
    let start = Departure::default();
    let simulated = simulate(model.kind, &model.keys(), terms, experiment, &start);
    simulated.predict(&experiment.outputs[0], 0.0).values
}
