//! Prior probabilities of parameters and of structures.
//!
//! A parameter enters the marginal likelihood by the width of its prior at the fitted value, `w = 1 / (sqrt(2
//! pi) p(theta))`: the standard deviation of the normal density with the same maximum. Data that know the
//! parameter to a standard deviation `s` much less than `w` cost the effect `ln(w / s)`; data without
//! information cost nothing.

use super::held::held_within;
use super::point::{EffectAt, Global, Point};
use super::problem::Problem;
use super::screen::{Table, candidates};
use quell_model::StartComponent;
use quell_model::effects::ParameterRole;
use quell_recording::Role;
use std::f64::consts::{PI, TAU};

/// Log of the odds of one more effect: each further effect is half as likely as the one before.
const ONE_MORE: f64 = -std::f64::consts::LN_2;

/// Log of the prior odds, one in twenty, of a law that a sensor of this kind cannot have physically.
const NOT_BY_ITSELF: f64 = -3.0;

/// Width of the prior of a recording's own unknowns (a clock's offset, its start), in typical sizes.
const LOCAL: f64 = 10.0;

/// Whether a parameter is as likely in one octave of its range as in another.
pub fn is_logarithmic(role: ParameterRole, (low, high): (f64, f64)) -> bool {
    let is_rate = matches!(role, ParameterRole::Frequency | ParameterRole::Order);
    low > 0.0 && (is_rate || high > 10.0 * low)
}

impl Problem<'_> {
    /// Width of the prior of an unknown, as the fit sees it, at its value in a point.
    ///
    /// Sizes have a Cauchy density about the neutral value with the typical size as scale, so that larger
    /// orders of magnitude stay possible. Times, positions and phases are uniform; frequencies and orders
    /// uniform in their logarithm, and so is the part of the motion that a border cuts off, from the deformation on;
    /// shapes uniform within their bounds, in the logarithm where these span a decade. Keys have the width of their belief.
    pub fn prior_width(&self, point: &Point, global: Global) -> f64 {
        let root = TAU.sqrt();
        let Global::Parameter(term, index) = global else {
            return match global {
                Global::Key(key) if self.beliefs[key].1.is_finite() => {
                    let (value, std) = self.beliefs[key];
                    match self.logarithmic(global) {
                        // The width is that at the believed value: a damper that vanishes is not thereby
                        // unknown.
                        true => std * value / point.keys[key],
                        false => std,
                    }
                }
                _ => self.typical(point, global),
            };
        };
        if let Some(std) = self.given(term, index).and_then(|value| value.std) {
            return std;
        }
        let own = &point.terms[term];
        let parameter = &own.effect.parameters[index];
        let value = own.values[index];
        let (low, high) = (parameter.bounds)(&self.scales);
        let typical = self.typical(point, global);
        let decades = |value: f64| value.abs().max(1e-3 * typical) * (high / low).ln() / root;
        match parameter.role {
            ParameterRole::Size => {
                let ratio = (value - parameter.neutral) / typical;
                typical * PI * (1.0 + ratio * ratio) / root
            }
            // At any time of any recording.
            ParameterRole::Time => {
                let each = self.experiments.iter().map(|own| own.span());
                each.map(|(from, to)| to - from).sum::<f64>() / root
            }
            ParameterRole::Position => self.scales.travel().max(typical) / root,
            ParameterRole::Border => {
                let (first, last) = self.scales.position;
                let cut_off = (value - first).min(last - value).max(0.0);
                let least = self.scales.deformation;
                (least + cut_off) * (self.scales.travel() / least).ln_1p() / root
            }
            ParameterRole::Phase => TAU / root,
            // The prior of the curve as a whole is in [`super::curves`].
            ParameterRole::Ordinate | ParameterRole::Range => typical,
            role if is_logarithmic(role, (low, high)) => decades(value),
            _ => (high - low) / root,
        }
    }

    /// Widths of the priors of every recording's own unknowns, its start and the clocks of its sensors.
    ///
    /// The deformation at which friction alone holds a link is uniform within what that friction deforms. With any other
    /// width a law that sticks would cost more than one that creeps.
    pub fn own_widths(&self, point: &Point, globals: &[Global]) -> Vec<f64> {
        let of = |e: usize| {
            let sizes = self.sizes(point, globals, e);
            let own = sizes.iter().skip(globals.len()).map(|size| LOCAL * size);
            let mut widths: Vec<f64> = own.collect();
            // Where the start is free without friction, it is not for friction.
            if !self.departures.contains(&StartComponent::Deformation) {
                let experiment = &self.experiments[e];
                let linear = (self.kind.linear)(&self.keys(point, e), experiment.input);
                let held = held_within(&linear, &point.terms, experiment.initial[0]);
                let starts = widths.iter_mut().zip(self.starts(point, e));
                let held_ones = starts.filter(|own| own.1.1 == StartComponent::Deformation);
                held_ones.for_each(|(width, _)| *width = 2.0 * held / TAU.sqrt());
            }
            widths
        };
        (0..self.experiments.len()).flat_map(of).collect()
    }

    /// Log of the prior probability of a structure, relative to that of the given model: each effect could be
    /// any of the candidates.
    pub fn log_prior(&self, point: &Point) -> f64 {
        let each = self.log_prior_of_one();
        let terms = point.terms[point.given_terms..].iter();
        let of = |term: &quell_model::Term| {
            let (effect, _): EffectAt = term.identity();
            // Two laws that are reported as one still count as two.
            let laws = if effect.parts(&term.values).is_some() {
                2.0
            } else {
                1.0
            };
            let odd = effect.is_of_deformation_only() && self.sees_positions();
            laws * each + if odd { NOT_BY_ITSELF } else { 0.0 }
        };
        terms.map(of).sum()
    }

    /// Log of the prior odds of one effect.
    pub fn log_prior_of_one(&self) -> f64 {
        let count = [Table::Named, Table::Learned].map(|table| candidates(self, table).len());
        -(count.iter().sum::<usize>().max(1) as f64).ln() + ONE_MORE
    }

    /// Whether no output is a deformation.
    fn sees_positions(&self) -> bool {
        let outputs = &self.experiments[0].outputs;
        outputs
            .iter()
            .all(|output| output.role != Role::Deformation)
    }
}
