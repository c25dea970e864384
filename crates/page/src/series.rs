//! The content of a chart: its axes and its series, and their data for the script.

use super::colour::{COLOURS, dash};
use super::html::{json_number, json_numbers, json_string};
use super::thin::thinned;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) logarithmic: bool,
    pub(super) range: Option<(f64, f64)>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    /// Whose colour it has.
    pub(super) name: String,
    /// The name in the legend.
    pub(super) label: String,
    pub(super) kind: &'static str,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) low: Vec<f64>,
}

impl Axis {
    pub(super) fn json(&self) -> String {
        let (from, to) = self.range.unwrap_or((f64::NAN, f64::NAN));
        format!(
            "{{\"name\":{},\"unit\":{},\"log\":{},\"from\":{},\"to\":{}}}",
            json_string(&self.name),
            json_string(&self.unit),
            self.logarithmic,
            json_number(from, 10),
            json_number(to, 10),
        )
    }
}

impl Series {
    /// The first sample that has a place on the axis: a logarithmic one begins above 0.
    fn first(&self, x: &Axis) -> usize {
        if x.logarithmic {
            self.x.partition_point(|&x| x <= 0.0)
        } else {
            0
        }
    }

    /// Indices of what is drawn.
    fn drawn(&self, x: &Axis) -> Vec<usize> {
        let first = self.first(x);
        let thin = |y: &[f64]| thinned(&self.x[first..], &y[first..], x.logarithmic);
        let mut drawn = thin(&self.y);
        if self.kind == "band" {
            drawn.extend(thin(&self.low));
            drawn.sort_unstable();
            drawn.dedup();
        }
        drawn.iter_mut().for_each(|index| *index += first);
        drawn
    }

    /// The number of samples of which not all are drawn.
    pub(super) fn thinned_from(&self, x: &Axis) -> Option<usize> {
        let all = self.x.len() - self.first(x);
        (self.drawn(x).len() < all).then_some(all)
    }

    pub(super) fn json(&self, x: &Axis, y: &Axis, colour: usize) -> String {
        let drawn = self.drawn(x);
        let places = json_numbers(drawn.iter().map(|&index| self.x[index]), 10);
        let ordinates = |values: &[f64]| {
            let hidden = |value: &f64| y.logarithmic && *value <= 0.0;
            let shown = |&index: &usize| Some(values[index]).filter(|value| !hidden(value));
            json_numbers(
                drawn.iter().map(|index| shown(index).unwrap_or(f64::NAN)),
                6,
            )
        };
        let low = if self.kind == "band" {
            ordinates(&self.low)
        } else {
            "[]".into()
        };
        format!(
            "{{\"name\":{},\"kind\":\"{}\",\"colour\":{},\"dash\":{},\"x\":{places},\"y\":{},\"low\":{low}}}",
            json_string(&self.label),
            self.kind,
            colour % COLOURS,
            dash(colour),
            ordinates(&self.y),
        )
    }
}
