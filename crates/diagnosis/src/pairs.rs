//! Pairs of effects that explain a residual only together.
//!
//! Each of two effects alone may promise little: what the other one leaves masks it. In first order their changes of
//! the residual `r` add. With the parts `D = [d_1 d_2]` of these changes that the model itself cannot produce, the sizes
//!
//! ```text
//! x = -(D' D)^-1 D' r
//! ```
//!
//! lower chi-squared by `-x' D' r`. So all pairs are screened with one simulation for each effect and size. Pairs that
//! need a negative factor on a size are none: a law's own grid has both signs where it can act both ways.

use super::descent::Descent;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::point::Point;
use super::problem::Problem;
use super::projector::Projector;
use super::screen::{Screen, Start, Table};
use super::search::Search;
use super::successive_halving::HALF;
use super::thresholds::{LONG, SHORT};
use nalgebra::{DVector, Matrix2, Vector2};
use rayon::prelude::*;

/// Sizes of an effect that take part.
const SIZES: usize = 3;
/// Pairs whose fits are begun: a few more than candidates of one effect, since first order ranks two effects less well. Of
/// these as many are carried to their end as of one effect.
const BEGUN: usize = 12;
/// Most values of all changes together: 160 MB.
const ROOM: usize = 20_000_000;

/// An effect at a size, with what it changes.
struct Part {
    start: Start,
    change: DVector<f64>,
    /// `d' r`.
    product: f64,
}

impl Search<'_> {
    /// The pairs of named effects that explain most of what an explanation leaves, fitted and judged.
    pub fn pairs(&self, from: &Explanation) -> Vec<Explanation> {
        let mut problem = self.problem.clone();
        problem.locate_again(from);
        let (point, projector) = (&from.fitted.point, self.projector);
        let linear = problem.linearise(point, projector);
        let begun = points(&problem, point, &linear, projector);
        let begun = begun.into_par_iter().map(|point| {
            let mut descent = Descent::new(&problem, projector, &point, None);
            descent.run(SHORT);
            descent
        });
        let mut begun: Vec<Descent> = begun.collect();
        begun.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        begun.truncate(HALF);
        let finished = begun.into_par_iter().map(|mut descent| {
            descent.run(LONG);
            self.judge.judge(&problem, projector, descent.end())
        });
        finished.collect()
    }
}

/// A point with two effects more, for each of the best pairs.
fn points(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
) -> Vec<Point> {
    let screen = Screen::new(problem, point, linear, projector);
    let mut starts = screen.scored(Table::Named, SIZES);
    starts.truncate(ROOM / screen.residual().len().max(1));
    let parts: Vec<Part> = starts
        .into_par_iter()
        .filter(|_| !problem.is_cut())
        .map(|start| {
            let change = screen.own_change(&point.with(start.term.clone()));
            let product = change.dot(screen.residual());
            Part {
                start,
                change,
                product,
            }
        })
        .collect();
    let pairs = (0..parts.len()).into_par_iter().flat_map_iter(|one| {
        let parts = &parts;
        (0..one).filter_map(move |other| joint([&parts[other], &parts[one]]))
    });
    let mut pairs: Vec<(f64, [&Part; 2], Vector2<f64>)> = pairs.collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut found: Vec<Point> = Vec::new();
    for (_, pair, sizes) in pairs {
        if found.len() == BEGUN {
            break;
        }
        let [first, second] = pair.map(|part| &part.start.term);
        if !point.with(first.clone()).has_room_for(second.identity()) {
            continue;
        }
        let mut both = point.clone();
        for (part, size) in pair.into_iter().zip(sizes.iter()) {
            both = both.with(part.start.resized(problem, *size));
        }
        if !found.iter().any(|own| own.structure() == both.structure()) {
            found.push(both);
        }
    }
    found
}

/// Fall of chi-squared by two effects together, with factors on their sizes. `None` for sizes of one effect, and where a
/// factor is not positive.
fn joint(pair: [&Part; 2]) -> Option<(f64, [&Part; 2], Vector2<f64>)> {
    let [a, b] = pair;
    if a.start.term.identity() == b.start.term.identity() {
        return None;
    }
    let common = a.change.dot(&b.change);
    let normal = Matrix2::new(
        a.change.norm_squared(),
        common,
        common,
        b.change.norm_squared(),
    );
    let products = Vector2::new(a.product, b.product);
    let sizes = -normal.cholesky()?.solve(&products);
    let fall = -sizes.dot(&products);
    let is_pair = sizes.min() > 0.0 && fall.is_finite();
    is_pair.then_some((fall, pair, sizes))
}
