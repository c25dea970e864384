//! Unknowns of a recording's start that no sensor measures.

use super::fit::Fitted;
use super::problem::Problem;
use super::projector::Projector;
use super::thresholds::{LONG, STRONG};
use quell_model::RESONANCES;
use quell_model::StartComponent::{
    Deformation, DeformationRate, Mode, ModeRate, MotorPosition, MotorVelocity,
};
use quell_model::chain::MotorSide;
use quell_model::effects::Scales;
use quell_model::{Departure, Experiment, InputError, Model, StartComponent};

/// Components of the start that are free: a free motor side, for example, has an unmeasured velocity.
pub fn departures(model: &Model, experiments: &[Experiment]) -> Vec<StartComponent> {
    let linear = (model.kind.linear)(&model.keys(), experiments[0].input);
    match (linear.motor, linear.link) {
        (MotorSide::Free { .. }, None) => vec![MotorPosition, MotorVelocity],
        (MotorSide::Free { .. }, Some(_)) => {
            vec![MotorPosition, MotorVelocity, Deformation, DeformationRate]
        }
        // A link whose motion is prescribed starts with that motion.
        (MotorSide::Fixed, _) if linear.link_is_input => Vec::new(),
        (MotorSide::Fixed, _) => vec![Deformation, DeformationRate],
        // A mode starts with the motion of the first samples, and so with their noise; after a gap it may ring.
        (MotorSide::Prescribed, _) => match experiments
            .iter()
            .any(|own| is_noisy(own) || !own.windows.is_empty())
        {
            true => vec![Deformation, DeformationRate],
            false => Vec::new(),
        },
    }
}

fn is_noisy(experiment: &Experiment) -> bool {
    InputError::of(experiment).of_noise().is_some()
}

/// Typical sizes of the unknown components of a start.
pub fn departure_scale(scales: &Scales) -> Departure {
    let mut typical = Departure::default();
    typical[MotorPosition] = 0.01 * scales.travel().max(scales.deformation);
    typical[MotorVelocity] = 0.1 * scales.velocity;
    typical[Deformation] = 0.1 * scales.deformation;
    typical[DeformationRate] = 0.1 * scales.deformation_rate;
    for mode in 0..RESONANCES {
        typical[Mode(mode)] = typical[Deformation];
        typical[ModeRate(mode)] = typical[DeformationRate];
    }
    typical
}

/// Adds a start that already rings, two more unknowns for each experiment, if these are worth their cost.
pub fn ringing(problem: &mut Problem, still: Fitted, projector: &Projector) -> Fitted {
    // A link whose motion is prescribed does not ring beyond it.
    let input = problem.experiments[0].input;
    let held = (problem.kind.linear)(&still.point.keys, input).link_is_input;
    if !problem.departures.is_empty() || held {
        return still;
    }
    problem.departures = vec![Deformation, DeformationRate];
    // The clocks of the other fit may be those of a motion in which the ringing is missing.
    let mut neutral = still.point.clone();
    neutral.locals = problem.neutral_locals();
    let [near, far] = [&still.point, &neutral].map(|from| problem.fit(from, projector, LONG));
    let ringing = if far.cost < near.cost { far } else { near };
    let experiments = problem.experiments;
    let rows = experiments.iter().map(Experiment::samples).sum::<usize>() as f64;
    let unit = (ringing.cost / rows).max(1.0);
    let price = 2.0 * experiments.len() as f64 * rows.ln() + STRONG;
    if (still.cost - ringing.cost) / unit > price {
        return ringing;
    }
    problem.departures.clear();
    still
}
