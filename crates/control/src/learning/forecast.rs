//! The residual vibration that a train will leave of a move, and the train of least residual.
//!
//! Along the way of a move the frequency of a mode is a function of time, `w(q(t))`. The acceleration `a` of
//! the plan, delayed by `tau`, leaves `h(tau) = sum_k g(t_k + tau) a_k dt`, where `g(s)` is the state at the
//! end after an impulse at `s`, computed backwards from the end. A train leaves `sum A_i h(tau_i)`: linear in
//! its amplitudes however the frequency changes, so that the best train for the whole way is a convex problem.
//!
//! The expectation is over the uncertainty of the modes (sigma points of frequency along the way and damping).
//! The two halves of the move, speeding up and slowing down, count separately, since the train must not rely on
//! their cancellation.
//!
//! The train is one for the whole move, solved before it. Trains that change with the configuration while the robot moves are
//! the subject of US 11,648,666 B2, and are not made here.
//!
//! Source: sigma points, S. J. Julier, J. K. Uhlmann, Proc. IEEE 92 (2004).

use nalgebra::{DMatrix, SMatrix};
use quell_shapers::{GridTrain, ShaperError, Tap};
use quell_trajectories::SampledTrajectory;

use super::path::{NODES, Way};
use super::point::{OF_A_MODE, Point};
use super::response::free_step;
use super::simplex::least_on_simplex;

/// Instants at which an impulse may lie.
const INSTANTS: usize = 64;
/// Shares of a command that are negligible: all together leave less than 1e-5.
const NEGLIGIBLE: f64 = 1e-7;

/// A mode on the way of a move, with its uncertainty.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// Its mean.
    pub point: Point,
    /// Covariance of `ln w` at the nodes, and `xi`.
    pub covariance: SMatrix<f64, OF_A_MODE, OF_A_MODE>,
    /// Its share of the deformation.
    pub share: f64,
}

impl Expected {
    /// The mode at any one place of the way: one frequency, whose uncertainty includes the change along the
    /// way.
    pub fn anywhere(&self) -> Self {
        let nodes = NODES as f64;
        let middle = self.point.log_w.iter().sum::<f64>() / nodes;
        let changes = self.point.log_w.iter().map(|w| (w - middle).powi(2));
        let known = (0..NODES).map(|n| self.covariance[(n, n)]);
        let variance = (changes.sum::<f64>() + known.sum::<f64>()) / nodes;
        let mut covariance = SMatrix::<f64, OF_A_MODE, OF_A_MODE>::zeros();
        covariance
            .fixed_view_mut::<NODES, NODES>(0, 0)
            .fill(variance);
        covariance[(NODES, NODES)] = self.covariance[(NODES, NODES)];
        Self {
            point: Point {
                log_w: [middle; NODES],
                xi: self.point.xi,
            },
            covariance,
            share: self.share,
        }
    }

    /// The mean, and points two standard deviations away in each principal direction, which have the covariance
    /// of the mode.
    pub fn sigma_points(&self) -> Vec<Point> {
        let eigen = self.covariance.symmetric_eigen();
        let reach = (OF_A_MODE as f64).sqrt();
        let mut points = vec![self.point];
        for (value, direction) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            for sign in [-reach, reach] {
                let step = sign * value.max(0.0).sqrt();
                points.push(Point {
                    log_w: core::array::from_fn(|n| self.point.log_w[n] + step * direction[n]),
                    xi: (self.point.xi + step * direction[NODES]).clamp(1e-5, 0.9),
                });
            }
        }
        points
    }
}

/// A plan, and the modes that it excites.
pub struct Forecast<'a> {
    plan: &'a SampledTrajectory,
    way: Way,
    modes: &'a [Expected],
    /// The tick of greatest speed: the plan speeds up before it and slows down after it.
    turn: usize,
}

/// Residuals of some delays: one row for each part, one column for each delay.
pub struct Left {
    rows: DMatrix<f64>,
    /// The delays, ticks, from 0 upwards.
    delays: Vec<usize>,
    unshaped: f64,
}

impl<'a> Forecast<'a> {
    /// A forecast for a plan of one axis.
    pub fn new(plan: &'a SampledTrajectory, way: Way, modes: &'a [Expected]) -> Self {
        let speeds = plan.velocities(0).iter().map(|v| v.abs());
        let turn = speeds
            .enumerate()
            .fold((0, 0.0), |best, (k, v)| match v > best.1 {
                true => (k, v),
                false => best,
            });
        Self {
            plan,
            way,
            modes,
            turn: turn.0,
        }
    }

    /// The same for the move as a whole, whose halves may cancel: this is what will be measured.
    pub fn whole(self) -> Self {
        Self { turn: 0, ..self }
    }

    /// Residuals for trains up to `longest` ticks.
    pub fn left(&self, longest: usize) -> Left {
        let count = longest.clamp(1, INSTANTS - 1);
        let mut delays: Vec<usize> = (0..=count).map(|k| k * longest / count).collect();
        delays.dedup();
        self.left_at(delays)
    }

    /// Residuals at the impulses of these trains.
    pub fn left_of(&self, trains: &[&GridTrain]) -> Left {
        let taps = trains.iter().flat_map(|train| train.taps());
        let mut delays: Vec<usize> = taps.map(|tap| tap.delay as usize).chain([0]).collect();
        delays.sort_unstable();
        delays.dedup();
        self.left_at(delays)
    }

    /// Residuals of delays, the last of which is the longest, in the pose at the end of a train of that length.
    fn left_at(&self, delays: Vec<usize>) -> Left {
        let parts: Vec<Vec<[f64; 2]>> = self
            .modes
            .iter()
            .flat_map(|mode| {
                let points = mode.sigma_points();
                let weight = mode.share.abs() / (points.len() as f64).sqrt();
                points
                    .into_iter()
                    .flat_map(|point| self.of_a_point(&point, weight, &delays))
                    .collect::<Vec<_>>()
            })
            .collect();
        let rows = DMatrix::from_fn(2 * parts.len(), delays.len(), |row, delay| {
            parts[row / 2][delay][row % 2]
        });
        let unshaped = rows.column(0).norm();
        Left {
            rows,
            delays,
            unshaped,
        }
    }

    /// For each half of the move, the weighted state that each delay leaves.
    fn of_a_point(&self, point: &Point, weight: f64, delays: &[usize]) -> [Vec<[f64; 2]>; 2] {
        let longest = delays.last().copied().unwrap_or(0);
        let period = self.plan.period();
        let positions = self.plan.positions(0);
        let ticks = positions.len() + longest;
        let shaped = |tick: usize| {
            let planned = tick.saturating_sub(longest / 2);
            positions[planned.min(positions.len() - 1)]
        };
        let end_w = point.log_w[NODES - 1].exp();
        let root = (1.0 - point.xi * point.xi).sqrt();
        // Converts position and velocity at the end to the two parts of an amplitude.
        let amplitude = |x: f64, v: f64| [x, (v + point.xi * end_w * x) / (end_w * root)];
        let mut answers = vec![[0.0; 2]; ticks + 1];
        let mut whole = [[1.0, 0.0], [0.0, 1.0]];
        for tick in (0..=ticks).rev() {
            answers[tick] = amplitude(-whole[0][1], -whole[1][1]);
            let w = self
                .way
                .value(&point.log_w, shaped(tick.saturating_sub(1)))
                .exp();
            let step = free_step(w, point.xi, period);
            whole = core::array::from_fn(|i| {
                core::array::from_fn(|j| whole[i][0] * step[0][j] + whole[i][1] * step[1][j])
            });
        }
        let accelerations = self.plan.accelerations(0);
        // At the end of the first half it has not decayed yet.
        let undo = (point.xi * end_w * period * (positions.len() - self.turn) as f64).exp();
        let halves = [(0..self.turn, undo), (self.turn..positions.len(), 1.0)];
        halves.map(|(half, factor)| {
            let scale = weight * factor * period;
            let of_delay = |delay: usize| {
                let mut sum = [0.0; 2];
                for k in half.clone() {
                    let [x, y] = answers[k + delay];
                    sum[0] += x * accelerations[k];
                    sum[1] += y * accelerations[k];
                }
                sum.map(|value| value * scale)
            };
            delays.iter().copied().map(of_delay).collect()
        })
    }

    /// Each mode's share of the unshaped vibration.
    pub fn contributions(&self) -> Vec<f64> {
        let each = self.modes.iter().map(|mode| {
            let one = [*mode];
            let alone = Forecast {
                modes: &one,
                ..*self
            };
            alone.left(0).unshaped
        });
        let sizes: Vec<f64> = each.collect();
        let all = sizes.iter().map(|x| x * x).sum::<f64>().sqrt();
        sizes
            .iter()
            .map(|x| x / all.max(f64::MIN_POSITIVE))
            .collect()
    }
}

impl Left {
    /// The expected share of the unshaped vibration that a train of these delays leaves.
    pub fn by(&self, train: &GridTrain) -> f64 {
        let mut sum = nalgebra::DVector::zeros(self.rows.nrows());
        for tap in train.taps() {
            let at = self.delays.binary_search(&(tap.delay as usize));
            let column = at.unwrap_or_else(|next| next.min(self.delays.len() - 1));
            sum += self.rows.column(column) * tap.amplitude;
        }
        sum.norm() / self.unshaped.max(f64::MIN_POSITIVE)
    }

    /// The unshaped vibration, rad.
    pub fn unshaped(&self) -> f64 {
        self.unshaped
    }

    /// The train of positive impulses at these delays with the least residual.
    ///
    /// # Errors
    /// [`ShaperError`] where the period is none.
    pub fn best(&self, period: f64) -> Result<GridTrain, ShaperError> {
        let amplitudes = least_on_simplex(&self.rows.tr_mul(&self.rows));
        let ticks = self.delays.iter().copied();
        let kept: Vec<(usize, f64)> = ticks
            .zip(amplitudes.iter().copied())
            .filter(|(tick, amplitude)| *amplitude > NEGLIGIBLE || *tick == 0)
            .collect();
        let sum: f64 = kept.iter().map(|tap| tap.1).sum();
        let taps: Vec<Tap> = kept
            .into_iter()
            .map(|(tick, amplitude)| Tap {
                delay: tick as u32,
                amplitude: amplitude / sum,
            })
            .collect();
        GridTrain::from_taps(&taps, period)
    }
}
