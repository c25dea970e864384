//! The uncertain shape of named laws.
//!
//! No law of a catalogue has exactly the shape of reality: real friction is more regular, contacts are
//! compliant, a ripple has harmonics. So a static law is taken to be right up to a smooth, unknown curve over
//! its slot, with an expected effect of a tenth of the law's. The curve is marginalised like a nuisance: what
//! it explains is no evidence for a further effect.
//!
//! Source: Kennedy and O'Hagan, J. Royal Statistical Society B 63 (2001), on the discrepancy of a model; Rasmussen
//! and Williams, Gaussian Processes for Machine Learning (2006), chapter 4, for the prior of the curve.

use super::curves::{ordinates, root};
use super::point::Point;
use super::problem::Problem;
use super::views::{Both, Views, joined};
use nalgebra::{DMatrix, DVector};
use quell_model::Term;
use quell_model::effects::{Effect, LEARNED};

/// Ratio of the correction's amplitude to the law's.
const TENTH: f64 = 0.1;
/// Step of a derivative by an ordinate, as a share of its typical size.
const STEP: f64 = 1e-2;

/// The corrections of the laws of a point.
pub struct Corrections {
    each: Vec<Correction>,
    /// Derivatives by all of them, in units of their prior standard deviations.
    pub columns: Vec<Both>,
}

/// The correction of one law.
struct Correction {
    /// The learned law of its slot, at its neutral values.
    neutral: Term,
    ordinates: Vec<usize>,
    /// Root of the prior covariance of the ordinates.
    root: DMatrix<f64>,
}

impl Corrections {
    /// Corrections of all static laws of a point; `here` are the rows at the point.
    pub fn new(problem: &Problem, views: &Views, point: &Point, here: &Both) -> Self {
        let mut all = Self {
            each: Vec::new(),
            columns: Vec::new(),
        };
        for (index, term) in point.terms.iter().enumerate() {
            let Some(effect) = learned(term) else {
                continue;
            };
            // Over the speeds of the axis also where two sides slip: a friction that changes within the speeds of a slip is
            // another law.
            let neutral = Term {
                effect,
                values: (effect.starts)(&problem.scales).swap_remove(0),
                ..term.clone()
            };
            let mut own = Correction {
                ordinates: ordinates(effect),
                root: root(effect),
                neutral,
            };
            let columns = own.columns(problem, views, point, here);
            let size = TENTH * share(views, point, here, (index, &columns));
            if size.is_finite() {
                own.root *= size;
                let scaled = columns.into_iter().map(|both| both.map(|rows| rows * size));
                all.columns.extend(scaled);
                all.each.push(own);
            }
        }
        all
    }

    /// The point with corrections of these sizes, in prior standard deviations.
    pub fn applied(&self, point: &Point, sizes: &DVector<f64>) -> Point {
        let mut corrected = point.clone();
        let mut first = 0;
        for own in &self.each {
            let count = own.ordinates.len();
            let values = &own.root * sizes.rows(first, count);
            let mut term = own.neutral.clone();
            for (&index, value) in own.ordinates.iter().zip(values.iter()) {
                term.values[index] = *value;
            }
            corrected.terms.push(term);
            first += count;
        }
        corrected
    }
}

impl Correction {
    /// Derivatives by the ordinates, mixed according to their prior correlation.
    fn columns(&self, problem: &Problem, views: &Views, point: &Point, here: &Both) -> Vec<Both> {
        let neutral = &self.neutral;
        let slope = |&index: &usize| {
            let step = STEP * (neutral.effect.parameters[index].typical)(&problem.scales);
            let mut moved = neutral.clone();
            moved.values[index] += step;
            views.slope(here, &point.with(moved), step)
        };
        let slopes: Vec<Both> = self.ordinates.iter().map(slope).collect();
        let slopes = joined(&slopes, here).map(|slopes| slopes * &self.root);
        let column = |k: usize| [0, 1].map(|part| slopes[part].column(k).into_owned());
        (0..self.ordinates.len()).map(column).collect()
    }
}

/// The learned law of a named law's slot, if it can be at the same place.
fn learned(term: &Term) -> Option<&'static Effect> {
    let slot = term.effect.slot().filter(|_| !term.effect.is_learned())?;
    let all = LEARNED.iter().copied();
    all.filter(|other| other.places.contains(&term.place))
        .find(|other| other.slot() == Some(slot))
}

/// Size of a law's effect on the rows, relative to the expected effect of a curve of standard deviation 1.
fn share(views: &Views, point: &Point, here: &Both, (term, columns): (usize, &[Both])) -> f64 {
    let mut without = point.clone();
    let own = &mut without.terms[term];
    own.values = own.effect.neutral();
    let law = views.slope(here, &without, 1.0);
    let energy = |both: &Both| both[0].norm_squared() + both[1].norm_squared();
    let expected: f64 = columns.iter().map(energy).sum();
    (energy(&law) / expected).sqrt()
}
