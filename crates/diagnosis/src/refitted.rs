//! The model refitted to the data, and the noise beside it.

use super::baseline::refit;
use super::fit::Fitted;
use super::problem::Problem;
use super::projector::Projector;
use super::start::ringing;
use super::thresholds::LONG;
use super::weights::measure_noise;
use quell_model::Model;
use std::sync::Arc;

/// The model refitted from a start; the noise is measured from its residual.
pub fn baseline(model: &Model, problem: &mut Problem) -> (Fitted, Projector) {
    let start = problem.start(model);
    if problem.experiments[0].outputs.len() > 1 {
        // The first guess of the weights is the residual of the given model in each output.
        measure_noise(problem, &start);
    }
    let mut projector = Projector::new(problem);
    let mut first = refit(problem, &start, &projector);
    first = ringing(problem, first, &projector);
    // Vibration at the start is fitted first. It would otherwise be taken for noise.
    measure_noise(problem, &first.point);
    problem.rounding_at_rest = Arc::new(problem.responses_to_rounding(&first.point));
    projector = Projector::new(problem);
    (problem.fit(&first.point, &projector, LONG), projector)
}
