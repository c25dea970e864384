//! What another input does to the residuals.

use super::point::Point;
use super::problem::Problem;
use quell_model::Experiment;

impl Problem<'_> {
    /// Changes of the residuals of an experiment, which are `here` at a point, by an error of what drives it; `driven` is the
    /// experiment with the error, of this sign.
    ///
    /// A law that switches, such as an end stop, may be met with an error of one sign and missed with the other. That jump
    /// does not grow with the error and is no response to it, so of each output the smaller change of both is taken.
    pub fn response_to(
        &self,
        (point, here): (&Point, &[Vec<f64>]),
        e: usize,
        driven: impl Fn(f64) -> Experiment,
    ) -> Vec<Vec<f64>> {
        let mut experiments = self.experiments.to_vec();
        let [positive, negative] = [1.0, -1.0].map(|sign| {
            experiments[e] = driven(sign);
            let moved = Problem {
                experiments: &experiments,
                ..self.clone()
            };
            let there = moved.run(point, e).residuals;
            let changes = here.iter().zip(&there).map(|(here, there)| {
                let each = here.iter().zip(there);
                each.map(|(a, b)| sign * (a - b)).collect()
            });
            changes.collect::<Vec<Vec<f64>>>()
        });
        let power = |own: &[f64]| own.iter().map(|x| x * x).sum::<f64>();
        let smaller = |(a, b): (Vec<f64>, Vec<f64>)| match power(&b) < power(&a) {
            true => b,
            false => a,
        };
        positive.into_iter().zip(negative).map(smaller).collect()
    }
}
