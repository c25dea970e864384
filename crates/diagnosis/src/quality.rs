//! Misfit of an explanation on fitted and held-out data.

use super::document::{Fit, Quality};
use super::point::Point;
use super::problem::{Problem, Rows};
use super::search::Search;

/// Root mean square residuals, in the unit of the first output and relative to the noise of each recording.
pub fn quality(search: &Search, point: &Point) -> Quality {
    let (judge, problem) = (search.judge, search.problem);
    let of = |rows: &[Vec<Rows>]| rms(problem, point, rows);
    let [train, train_over] = of(&problem.rows);
    let [held, held_over] = match judge.data.apart.is_empty() {
        true => of(&judge.data.held_out),
        false => {
            let (apart, own) = judge.apart(problem, point);
            rms(&apart, &own.point, &apart.rows)
        }
    };
    let there = held.is_finite();
    Quality {
        train_rms: train,
        held_out_rms: if there { held } else { train },
        held_out_over_noise: if there { held_over } else { train_over },
    }
}

/// Root mean square residual of the first outputs, in their unit and relative to the noise.
fn rms(problem: &Problem, point: &Point, rows: &[Vec<Rows>]) -> [f64; 2] {
    let (mut sum, mut over, mut count) = (0.0, 0.0, 0);
    for (e, rows) in rows.iter().enumerate() {
        let residual = problem.explained(point, e);
        let scale = problem.experiments[e].outputs[0].scale;
        let noise = &problem.noise[e][0];
        for range in &rows[0] {
            let own = &residual[0][range.clone()];
            let square: f64 = own.iter().map(|r| r * r).sum();
            sum += square * scale * scale;
            over += noise.power(own) * own.len() as f64;
            count += range.len();
        }
    }
    [sum, over].map(|sum| (sum / count as f64).sqrt())
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
        model_alone: None,
        scores: Vec::new(),
    }
}
