//! How well an explanation fits what it was fitted to, and what was held out.

use super::document::{Fit, Quality};
use super::explanation::Explanation;
use super::fit::Projector;
use super::problem::{Point, Problem, Rows};
use super::search::Search;

/// Root mean square residuals in the unit of the first output.
pub fn quality(search: &Search, explanation: &Explanation) -> Quality {
    let (judge, problem) = (search.judge, search.problem);
    let point = &explanation.fitted.point;
    let of = |rows: &[Vec<Rows>]| rms(search, (problem, search.projector, point), rows);
    let train = of(&problem.rows);
    let held = match judge.data.apart.is_empty() {
        true => of(&judge.data.held_out),
        false => {
            let (apart, projector, own) = judge.apart(problem, point);
            rms(search, (&apart, &projector, &own.point), &apart.rows)
        }
    };
    let held = if held.is_finite() { held } else { train };
    Quality {
        train_rms: train,
        held_out_rms: held,
        held_out_over_noise: held / level(problem).noise_std,
    }
}

fn rms(
    search: &Search,
    (problem, projector, point): (&Problem, &Projector, &Point),
    rows: &[Vec<Rows>],
) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (e, rows) in rows.iter().enumerate() {
        let residual = search.judge.explained(problem, projector, point, e);
        let scale = problem.experiments[e].outputs[0].scale;
        for range in &rows[0] {
            sum += residual[0][range.clone()]
                .iter()
                .map(|r| (r * scale).powi(2))
                .sum::<f64>();
            count += range.len();
        }
    }
    (sum / count as f64).sqrt()
}

/// Noise of the first output.
pub fn level(problem: &Problem) -> Fit {
    let output = &problem.experiments[0].outputs[0];
    let nothing = Quality {
        train_rms: 0.0,
        held_out_rms: 0.0,
        held_out_over_noise: 0.0,
    };
    Fit {
        noise_std: problem.noise[0][0].deviation * output.scale,
        unit: output.unit.clone(),
        before: nothing,
        after: nothing,
    }
}
