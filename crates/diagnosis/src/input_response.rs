//! What another input does to the residuals.

use super::point::Point;
use super::problem::Problem;
use quell_model::Experiment;

impl Problem<'_> {
    /// Change of the residuals of an experiment, which are `here` at a point, where it is driven as another one.
    pub fn response_to(
        &self,
        (point, here): (&Point, &[Vec<f64>]),
        e: usize,
        other: Experiment,
    ) -> Vec<Vec<f64>> {
        let mut experiments = self.experiments.to_vec();
        experiments[e] = other;
        let moved = Problem {
            experiments: &experiments,
            ..self.clone()
        };
        let there = moved.run(point, e).residuals;
        let less = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        here.iter().zip(&there).map(less).collect()
    }
}
