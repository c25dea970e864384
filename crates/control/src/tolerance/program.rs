//! The motion of a given duration with the least residual: a convex problem.
//!
//! The duration is divided into steps of constant jerk. Acceleration, velocity and position at their ends
//! are linear in the jerks, and so is the residual of a mode. Minimising the largest amplitude under the limits
//! is a second-order cone problem. Every train of positive impulses on every plan within the limits is one of
//! its candidates, but for the steps.
//!
//! Source: S. Boyd, L. Vandenberghe, Convex Optimization, 2004, ch. 4.4; P. J. Goulart, Y. Chen, Clarabel, 2024 (the solver).

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SupportedConeT,
    ZeroConeT,
};
use quell_trajectories::Limits;

use super::steps::Step;
use super::swing::Swing;

/// Margin to the limits, for the solver's own precision of 1e-8.
const MARGIN: f64 = 1e-6;

/// One axis of a motion.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its displacement, rad.
    pub distance: f64,
    /// Its limits.
    pub limits: Limits,
    /// Modes whose residual is minimised, and the weight of each.
    pub modes: Vec<(Swing, f64)>,
    /// Distance of the tip from the axis, m.
    pub lever: f64,
}

/// A motion of some axes, all from rest to rest.
pub struct Program<'a> {
    /// The axes.
    pub axes: &'a [Axis],
    /// Largest distance of the tip from the straight path, m, where they may leave it.
    pub deviation: f64,
    /// Steps of constant jerk.
    pub steps: &'a [Step],
}

/// Rows `A x + s = b` as triplets.
#[derive(Default)]
struct Rows {
    at: [Vec<usize>; 2],
    values: Vec<f64>,
    right: Vec<f64>,
}

impl Rows {
    fn add(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        for (column, value) in entries {
            self.at[0].push(self.right.len());
            self.at[1].push(column);
            self.values.push(value);
        }
        self.right.push(right);
    }
}

/// Columns of an axis: jerks, then accelerations, velocities and positions between the steps, in the direction of the
/// target, each over its limit or distance.
#[derive(Clone, Copy)]
struct Columns {
    first: usize,
    steps: usize,
}

impl Columns {
    fn jerk(self, k: usize) -> usize {
        self.first + k
    }

    /// The `which`-th derivative between steps; none at the ends, where there is rest.
    fn inner(self, which: usize, k: usize) -> Option<usize> {
        (0 < k && k < self.steps)
            .then(|| self.first + self.steps + which * (self.steps - 1) + k - 1)
    }

    fn count(self) -> usize {
        self.steps + 3 * (self.steps - 1)
    }
}

impl Program<'_> {
    /// Jerks of each axis, rad/s^3, of least residual. The caller must check the result.
    pub fn solve(&self) -> Option<Vec<Vec<f64>>> {
        let count = self.steps.len();
        let columns: Vec<Columns> = self.columns();
        let path = columns.iter().map(|of| of.count()).sum::<usize>();
        let apart = self.axes.len() > 1;
        // Path parameter and departures between the steps.
        let aside = if apart {
            (count - 1) * (1 + self.axes.len())
        } else {
            0
        };
        let level = path + aside;
        let mut rows = Rows::default();
        for (axis, of) in self.axes.iter().zip(&columns) {
            self.motion(&mut rows, axis, *of);
        }
        let zero = rows.right.len();
        for (axis, of) in self.axes.iter().zip(&columns) {
            self.limits(&mut rows, axis, *of);
        }
        if apart {
            self.departure(&mut rows, &columns, path);
        }
        let mut cones = vec![ZeroConeT(zero), NonnegativeConeT(rows.right.len() - zero)];
        for (axis, of) in self.axes.iter().zip(&columns) {
            self.residual(&mut rows, &mut cones, (axis, *of, level));
        }
        let x = least(rows, &cones, level)?;
        let jerks = columns.iter().zip(self.axes).map(|(of, axis)| {
            let unit = axis.limits.jerk * axis.distance.signum();
            let jerks = self.steps.iter().zip(&x[of.first..]);
            jerks
                .map(|(step, x)| if step.without_jerk { 0.0 } else { unit * x })
                .collect()
        });
        Some(jerks.collect())
    }

    fn columns(&self) -> Vec<Columns> {
        let mut first = 0;
        let each = self.axes.iter().map(|_| {
            let of = Columns {
                first,
                steps: self.steps.len(),
            };
            first += of.count();
            of
        });
        each.collect()
    }

    /// From step to step: `a' = a + j h`, `v' = v + h (a + a') / 2`, `q' = q + h (v + v') / 2 - h^2 (a' - a) / 12`.
    fn motion(&self, rows: &mut Rows, axis: &Axis, of: Columns) {
        let Limits {
            velocity,
            acceleration,
            jerk,
        } = axis.limits;
        let per = axis.distance.abs();
        for (k, step) in self.steps.iter().enumerate() {
            let h = step.duration;
            if step.without_jerk {
                rows.add([(of.jerk(k), 1.0)], 0.0);
            }
            let change = |which: usize| {
                let (after, before) = (of.inner(which, k + 1), of.inner(which, k));
                after
                    .map(|c| (c, 1.0))
                    .into_iter()
                    .chain(before.map(|c| (c, -1.0)))
            };
            let both = |which: usize, factor: [f64; 2]| {
                let (before, after) = (of.inner(which, k), of.inner(which, k + 1));
                before
                    .map(|c| (c, factor[0]))
                    .into_iter()
                    .chain(after.map(|c| (c, factor[1])))
            };
            rows.add(
                change(0).chain([(of.jerk(k), -jerk * h / acceleration)]),
                0.0,
            );
            let slope = -0.5 * acceleration * h / velocity;
            rows.add(change(1).chain(both(0, [slope, slope])), 0.0);
            let (slope, bend) = (
                -0.5 * velocity * h / per,
                acceleration * h * h / (12.0 * per),
            );
            // The target is at 1.
            let end = if k + 1 == self.steps.len() { -1.0 } else { 0.0 };
            let position = change(2).chain(both(1, [slope, slope]));
            rows.add(position.chain(both(0, [-bend, bend])), end);
        }
    }

    /// The velocity in a step is a parabola. It lies between its ends and the point where their tangents meet, `v + a h / 2`, and the ends
    /// lie between these points: so the points alone are bounded, and a cruise at the limit is one of the candidates.
    fn limits(&self, rows: &mut Rows, axis: &Axis, of: Columns) {
        let mut within = |entries: &[(usize, f64)]| {
            for sign in [1.0, -1.0] {
                let signed = entries
                    .iter()
                    .map(|(column, value)| (*column, sign * value));
                rows.add(signed, 1.0 - MARGIN);
            }
        };
        let Limits {
            velocity,
            acceleration,
            ..
        } = axis.limits;
        for (k, step) in self.steps.iter().enumerate() {
            within(&[(of.jerk(k), 1.0)]);
            if let (Some(a), Some(v)) = (of.inner(0, k), of.inner(1, k)) {
                within(&[(a, 1.0)]);
                let slope = 0.5 * step.duration * acceleration / velocity;
                within(&[(v, 1.0), (a, slope)]);
            }
        }
    }

    /// The sum over the axes of lever times distance from the path's position is at most the deviation.
    fn departure(&self, rows: &mut Rows, columns: &[Columns], path: usize) {
        let inner = self.steps.len() - 1;
        for k in 1..self.steps.len() {
            let s = path + k - 1;
            let away = |axis: usize| path + (1 + axis) * inner + k - 1;
            for (index, of) in columns.iter().enumerate() {
                let Some(q) = of.inner(2, k) else { continue };
                for sign in [1.0, -1.0] {
                    rows.add([(q, sign), (s, -sign), (away(index), -1.0)], 0.0);
                }
            }
            // Possible departures of the axes, relative to their displacements.
            let reach = self
                .axes
                .iter()
                .map(|axis| axis.lever * axis.distance.abs());
            let sum = reach
                .enumerate()
                .map(|(index, reach)| (away(index), reach / self.deviation));
            rows.add(sum, 1.0);
        }
    }

    /// `|sum_k c_k j_k| w <= level` for every mode.
    fn residual(
        &self,
        rows: &mut Rows,
        cones: &mut Vec<SupportedConeT<f64>>,
        (axis, of, level): (&Axis, Columns, usize),
    ) {
        for (swing, weight) in &axis.modes {
            let answers = swing.of_steps(self.steps);
            let scale = weight * axis.limits.jerk;
            rows.add([(level, -1.0)], 0.0);
            let re = answers.iter().enumerate();
            rows.add(re.map(|(k, c)| (of.jerk(k), -scale * c.re)), 0.0);
            let im = answers.iter().enumerate();
            rows.add(im.map(|(k, c)| (of.jerk(k), -scale * c.im)), 0.0);
            cones.push(SecondOrderConeT(3));
        }
    }
}

/// The point of least `level`.
fn least(rows: Rows, cones: &[SupportedConeT<f64>], level: usize) -> Option<Vec<f64>> {
    let Rows {
        at: [i, j],
        values,
        right,
    } = rows;
    let count = level + 1;
    let matrix = CscMatrix::new_from_triplets(right.len(), count, i, j, values);
    let mut cost = vec![0.0; count];
    cost[level] = 1.0;
    let nothing = CscMatrix::zeros((count, count));
    let settings = DefaultSettings {
        verbose: false,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&nothing, &cost, &matrix, &right, cones, settings).ok()?;
    solver.solve();
    let x = solver.solution.x;
    x.iter().all(|x| x.is_finite()).then_some(x)
}
