//! The search, by the noise that the best explanation leaves: what is not smooth in a mismatch passes for noise
//! until the mismatch is explained.

use super::candidate::Known;
use super::criteria::Search;
use super::explanation::{Explanation, Judge};
use super::fit::Projector;
use super::found::{Found, Trial};
use super::outcome::Progress;
use super::problem::Problem;
use super::weights::measured_again;

/// What a refitted model lacks.
pub fn settled(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    baseline: Explanation,
    told: (&Known, Progress),
) -> Found {
    let (baseline, trials) = singles(problem, projector, judge, baseline, told);
    let found = search(problem, projector, judge, told).run(baseline, trials);
    with_noise_of_best(problem, projector, judge, found, told.1)
}

/// The refitted model and the single effects that it may lack, by the noise that the best of these leaves.
fn singles(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    baseline: Explanation,
    told: (&Known, Progress),
) -> (Explanation, Vec<Trial>) {
    let first = search(problem, projector, judge, told);
    let trials = first.extend(&baseline);
    let best = first.simplest(&trials, &baseline);
    let again = best.and_then(|best| measured_again(problem, &best.fitted.point));
    let Some(again) = again else {
        return (baseline, trials);
    };
    (problem.noise, problem.whitening) = again;
    *projector = Projector::new(problem);
    let search = search(problem, projector, judge, told);
    let baseline = search.refitted(&baseline.fitted.point);
    let trials = search.again(&baseline, trials);
    (baseline, trials)
}

/// What was found, looked at again where several effects together leave another noise than one of them.
fn with_noise_of_best(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    found: Found,
    progress: Progress,
) -> Found {
    let best = &found.best;
    let several = best.effects().len() > 1;
    let again = several.then(|| measured_again(problem, &best.fitted.point));
    let Some(again) = again.flatten() else {
        return found;
    };
    (problem.noise, problem.whitening) = again;
    *projector = Projector::new(problem);
    let known = Known {
        points: found.further,
        alone: true,
    };
    let search = search(problem, projector, judge, (&known, progress));
    let baseline = search.refitted(&found.baseline.fitted.point);
    let trials = search.again(&baseline, found.trials);
    search.run(baseline, trials)
}

/// A search by the noise as it is known.
pub fn search<'a>(
    problem: &'a Problem<'a>,
    projector: &'a Projector,
    judge: &'a Judge<'a>,
    (known, progress): (&'a Known, Progress<'a>),
) -> Search<'a> {
    Search {
        problem,
        projector,
        judge,
        known,
        progress,
    }
}
