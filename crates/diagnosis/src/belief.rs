//! The engineer's beliefs as rows of the fit: departures from the given values in standard deviations.

use super::curves;
use super::point::{Global, Point};
use super::problem::Problem;
use std::f64::consts::TAU;

/// A departure from what is believed, in standard deviations, and its derivatives to the unknowns.
pub struct Belief {
    /// Standard deviations.
    pub departure: f64,
    /// Unknowns and derivatives.
    pub slopes: Vec<(Global, f64)>,
}

impl Problem<'_> {
    /// Cost of the beliefs.
    pub fn disbelief(&self, point: &Point) -> f64 {
        let beliefs = self.beliefs_of_model(point);
        let of_model: f64 = beliefs.iter().map(|b| b.departure * b.departure).sum();
        let terms = point.terms.iter();
        of_model
            + terms
                .map(|term| curves::cost(&self.scales, term))
                .sum::<f64>()
    }

    /// Beliefs on keys, on the effects of the given model, and on the curves of learned laws.
    pub fn beliefs_at(&self, point: &Point) -> Vec<Belief> {
        let terms = point.terms.iter().enumerate();
        let curves = terms.flat_map(|(index, term)| curves::beliefs(&self.scales, index, term));
        let belief = |(departure, slopes)| Belief { departure, slopes };
        let mut all = self.beliefs_of_model(point);
        all.extend(curves.map(belief));
        all
    }

    /// Beliefs on keys and on the effects of the given model.
    fn beliefs_of_model(&self, point: &Point) -> Vec<Belief> {
        let keys = self.free.iter().filter_map(|&key| self.belief(point, key));
        let effects = self.given.iter().enumerate().flat_map(|(term, values)| {
            let parameters = values.iter().enumerate();
            parameters.filter_map(move |(parameter, value)| {
                let std = value.std.filter(|_| !value.fixed)?;
                let global = Global::Parameter(term, parameter);
                Some(Belief {
                    departure: (self.get(point, global) - value.value) / std,
                    slopes: vec![(global, 1.0 / std)],
                })
            })
        });
        keys.chain(effects).collect()
    }

    /// The belief on a key. For a damping ratio it is on the damper across the joint and the damper to ground
    /// together.
    fn belief(&self, point: &Point, key: usize) -> Option<Belief> {
        let (value, std) = self.beliefs[key];
        if !std.is_finite() {
            return None;
        }
        let global = Global::Key(key);
        if self.kind.keys[key].range.0 <= 0.0 {
            let departure = (point.keys[key] - value) / std;
            return Some(Belief {
                departure,
                slopes: vec![(global, 1.0 / std)],
            });
        }
        let ground = match self.kind.mode {
            Some((_, damping)) if damping == key => self.damper_to_ground(point),
            _ => None,
        };
        let own = point.keys[key];
        let (term, share) = ground.unwrap_or((usize::MAX, 0.0));
        let total = own + share;
        let mut slopes = vec![(global, own / total / std)];
        if let Some((frequency, _)) = self.kind.mode.filter(|_| ground.is_some()) {
            let half = 0.5 * TAU * point.keys[frequency];
            slopes.push((Global::Parameter(term, 0), half / total / std));
        }
        Some(Belief {
            departure: (total / value).ln() / std,
            slopes,
        })
    }
}
