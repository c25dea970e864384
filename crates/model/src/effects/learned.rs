//! Common parts of learned laws: ordinates at equally spaced knots, and the range of these.

use super::{Parameter, ParameterRole, Quantity, Scales, Spline};

/// Number of ordinates of a learned law.
pub const KNOTS: usize = 12;

/// Its parameters: the ordinates, in the order of their knots, and the two ends of the range.
pub(super) const PARAMETERS: usize = KNOTS + 2;

/// Parameters of a law with [finer knots](super::Property::Finer): the spaces between the knots in thirds.
pub(super) const FINER: usize = 3 * (KNOTS - 1) + 1 + 2;

/// Names of ordinates in a table of parameters; a file contains them as one list.
const NAMES: [&str; FINER - 2] = [
    "y0", "y1", "y2", "y3", "y4", "y5", "y6", "y7", "y8", "y9", "y10", "y11", "y12", "y13", "y14",
    "y15", "y16", "y17", "y18", "y19", "y20", "y21", "y22", "y23", "y24", "y25", "y26", "y27",
    "y28", "y29", "y30", "y31", "y32", "y33",
];

/// An ordinate of a law; [`parameters`] sets its name.
pub(super) const fn ordinate(
    quantity: Quantity,
    bounds: fn(&Scales) -> (f64, f64),
    typical: fn(&Scales) -> f64,
) -> Parameter {
    Parameter {
        name: NAMES[0],
        role: ParameterRole::Ordinate,
        quantity,
        bounds,
        neutral: 0.0,
        typical,
    }
}

/// The ordinates, and the range of the coordinate over which they lie.
pub(super) const fn parameters<const PARAMETERS: usize>(
    ordinate: Parameter,
    coordinate: Quantity,
) -> [Parameter; PARAMETERS] {
    let mut parameters = [ordinate; PARAMETERS];
    let ordinates = PARAMETERS - 2;
    let mut k = 0;
    while k < ordinates {
        parameters[k].name = NAMES[k];
        k += 1;
    }
    parameters[ordinates] = end("from", coordinate, |_| -1.0);
    parameters[ordinates + 1] = end("to", coordinate, |_| 1.0);
    parameters
}

/// An end of a range. It is never fitted, so that `typical` is not used as a step.
const fn end(name: &'static str, quantity: Quantity, typical: fn(&Scales) -> f64) -> Parameter {
    Parameter {
        name,
        role: ParameterRole::Range,
        quantity,
        bounds: |_| (f64::MIN, f64::MAX),
        neutral: 0.0,
        typical,
    }
}

/// The neutral law over a range.
pub(super) fn start<const PARAMETERS: usize>((from, to): (f64, f64)) -> Vec<f64> {
    let mut values = vec![0.0; PARAMETERS];
    values[PARAMETERS - 2..].copy_from_slice(&[from, to]);
    values
}

/// The neutral laws over the position of the drive and of the link.
pub(super) fn over_position<const PARAMETERS: usize>(scales: &Scales) -> Vec<Vec<f64>> {
    [scales.visited_motor_position(), scales.visited_position()]
        .map(start::<PARAMETERS>)
        .to_vec()
}

/// Ordinates, and the ends of the range.
pub(super) fn split(values: &[f64]) -> (&[f64], f64, f64) {
    match values {
        [ordinates @ .., from, to] => (ordinates, *from, *to),
        _ => (&[], 0.0, 0.0),
    }
}

/// The law through the ordinates among the values of the parameters.
pub(super) fn spline(values: &[f64]) -> Spline {
    let (ordinates, from, to) = split(values);
    Spline::new(from, to, ordinates)
}
