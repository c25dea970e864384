//! A change of payload: the link's inertia times a known factor.

use crate::point::Point;
use crate::problem::Problem;

/// The link's inertia times a factor; 1 for the machine as it was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload(pub f64);

impl Payload {
    /// The machine as it was recorded.
    pub const NONE: Self = Self(1.0);
    /// A payload that an axis can carry and that shifts a mode by a fifth.
    pub const HALF_MORE: Self = Self(1.5);

    /// Adds the payload. With the same stiffness and damper, natural frequency and damping ratio change by `1 /
    /// sqrt(factor)`. Since these unknowns are fitted by their logarithms, a step means the same with and
    /// without it.
    pub fn load(self, problem: &mut Problem, point: &mut Point) {
        for (key, factor) in self.factors(problem) {
            point.keys[key] *= factor;
            let (low, high) = &mut problem.bounds[key];
            (*low, *high) = (*low * factor, *high * factor);
        }
    }

    /// Whether the model has a link whose inertia it can change.
    pub fn changes(self, problem: &Problem) -> bool {
        !self.factors(problem).is_empty()
    }

    /// Keys that the payload changes, and by which factor.
    fn factors(self, problem: &Problem) -> Vec<(usize, f64)> {
        let kind = problem.kind;
        if let Some((frequency, damping)) = kind.mode {
            let factor = 1.0 / self.0.sqrt();
            return vec![(frequency, factor), (damping, factor)];
        }
        let inertia = kind.key("link_inertia").or_else(|| kind.key("mass"));
        inertia.map(|key| (key, self.0)).into_iter().collect()
    }
}
