//! Several modes during a move: their fit to the samples so far, and the train to go on with.

use super::forecast::{Expected, Forecast};
use super::listening::{Explanation, FEWEST, in_order};
use super::path::Way;
use super::prescription::{Hold, ModeOnWay, Prescription};
use super::{Learner, Surroundings};
use crate::estimators::Sample;
use quell_shapers::GridTrain;
use quell_trajectories::SampledTrajectory;

impl Learner {
    /// The train to go on with in a move whose train was not solved for it, from its samples so far; nothing is
    /// stored.
    ///
    /// `None` where the samples show fewer than two modes: one mode is handled at the tick. Also `None` if the
    /// modes leave more unexplained than the train in force leaves of them: another train would remove less
    /// than the unexplained part.
    pub fn along(
        &self,
        heard: &[Sample],
        plan: &SampledTrajectory,
        surroundings: &Surroundings,
        in_force: &GridTrain,
    ) -> Option<Prescription> {
        let samples = in_order(heard);
        let way = Way::of(plan);
        if samples.len() < FEWEST {
            return None;
        }
        let places = self.places(&way, surroundings);
        let Explanation { fit, .. } = self.explain(&samples, way, &places)?;
        let expected: Vec<Expected> = fit.modes.iter().map(Expected::from).collect();
        let modes = self.modes_on_way(plan, way, &expected);
        if self.hold(&modes) != Some(Hold::SeveralModes) {
            return None;
        }
        let on_way = expected.iter().zip(&modes);
        let shaped = on_way.filter(|(_, mode)| mode.shaped);
        let shaped: Vec<Expected> = shaped.map(|(mode, _)| *mode).collect();
        let unshaped = Forecast::new(plan, way, &expected)
            .whole()
            .left(0)
            .unshaped();
        let unexplained = (2.0 * fit.unexplained()).sqrt() / unshaped.max(f64::MIN_POSITIVE);
        let forecast = Forecast::new(plan, way, &shaped);
        if unexplained > forecast.left_of(&[in_force]).by(in_force) {
            return None;
        }
        let (train, expected) = self.choose(&forecast, &shaped, in_force, plan.period());
        Some(Prescription {
            train: train.or_else(|| Some(in_force.clone())),
            known: ModeOnWay::strongest(&modes).map(|mode| mode.known),
            modes,
            expected: Some(expected),
            hold: Some(Hold::SeveralModes),
        })
    }
}
