//! Bounds and typical changes of the unknowns.

use super::point::{Global, Point};
use super::problem::Problem;
use quell_model::Term;
use quell_model::chain::{Linear, MotorSide};
use quell_model::effects::{Place, Quantity};
use std::f64::consts::TAU;

/// Least and greatest inertia with one payload, relative to that with another. A robot carries up to its own
/// weight, at the end of an arm whose own weight is distributed along it.
const HEAVIEST: (f64, f64) = (0.05, 20.0);

impl Problem<'_> {
    /// The places at which effects may act, and the linear part of the model at its believed values, which says
    /// between which bodies they act.
    pub fn places(&self) -> (&'static [Place], Linear) {
        let input = self.experiments[0].input;
        let keys: Vec<f64> = self.beliefs.iter().map(|belief| belief.0).collect();
        ((self.kind.places)(input), (self.kind.linear)(&keys, input))
    }

    /// The effect that ties a part of the damper to the ground, and its share of the damping ratio, `c w / 2`.
    /// The engineer's belief is on how fast a joint rings out, not on what its damper is tied to.
    pub fn damper_to_ground(&self, point: &Point) -> Option<(usize, f64)> {
        let (frequency, _) = self.kind.mode?;
        let input = self.experiments.first()?.input;
        let motor = (self.kind.linear)(&point.keys, input).motor;
        let drag = |term: &Term| term.effect.damps_to_ground();
        let index = point.terms.iter().position(drag)?;
        let half = 0.5 * TAU * point.keys[frequency];
        (motor == MotorSide::Prescribed).then_some((index, half * point.terms[index].size()))
    }

    /// Bounds of an unknown, in its own unit.
    pub fn limits(&self, point: &Point, global: Global) -> (f64, f64) {
        match global {
            Global::Key(key) if self.kind.mode.is_some_and(|mode| mode.1 == key) => {
                let (low, high) = self.bounds[key];
                match self.damper_to_ground(point) {
                    Some(_) => (self.kind.keys[key].range.0.min(low), high),
                    None => (low, high),
                }
            }
            Global::Key(key) => self.bounds[key],
            Global::Parameter(term, parameter) => {
                let physical = point.terms[term].effect.parameters[parameter].bounds;
                let (low, high) = physical(&self.scales);
                match self
                    .given(term, parameter)
                    .filter(|_| term < point.given_terms)
                {
                    Some(given) => given
                        .bounds
                        .unwrap_or((low.min(given.value), high.max(given.value))),
                    None => (low, high),
                }
            }
            Global::Inertia(_) => HEAVIEST,
        }
    }

    /// Typical size of an unknown as the fit sees it.
    pub fn typical(&self, point: &Point, global: Global) -> f64 {
        match global {
            Global::Key(key) => match self.logarithmic(global) {
                true => 1.0,
                false => point.keys[key].abs().max(1e-3),
            },
            Global::Parameter(term, parameter) => {
                let parameter = &point.terms[term].effect.parameters[parameter];
                (parameter.typical)(&self.scales).abs()
            }
            Global::Inertia(_) => 1.0,
        }
    }

    /// Change of an unknown over which the residual is far from linear: its typical size, or a tenth of its
    /// value. For a position it is at most the deformation, for an instant at most a radian of the mode,
    /// wherever the origin lies; for the frequency of what lasts, a radian over the recording.
    pub fn reach(&self, point: &Point, global: Global) -> f64 {
        let typical = self.typical(point, global);
        let (quantity, lasts) = match global {
            Global::Parameter(term, index) => {
                let effect = point.terms[term].effect;
                (effect.parameters[index].quantity, effect.happens())
            }
            _ => (Quantity::NUMBER, false),
        };
        match quantity {
            Quantity::FREQUENCY if lasts => typical.min(self.scales.duration().recip()),
            Quantity::POSITION => typical.min(self.scales.deformation),
            Quantity::TIME => typical.min(self.scales.period() / TAU),
            _ => typical.max(0.1 * self.get(point, global).abs().min(1e3)),
        }
    }
}
