//! A move of a given number of ticks within a tolerance, if there is one.

use quell_shapers::GridTrain;
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory, Trajectory};

use super::check::{exact_end, keeps_limits};
use super::known::Known;
use super::program::{Axis, Program};
use super::swing::Swing;
use super::{Bounds, Fastest, Moving, Tolerance, ToleranceError};

/// Number of steps in a period of the fastest mode, and in the ramp of the acceleration at the limits. With 48
/// to 128 steps a problem takes 5 to 20 ms.
const PER_PERIOD: f64 = 12.0;
const PER_RAMP: f64 = 3.0;
const STEPS: (f64, f64) = (48.0, 128.0);
/// Greatest lengthening of a move, in periods of the slowest mode: twice the length of ZVDD.
const LONGER: f64 = 3.0;
/// Number of attempts with joints off the path; each reduces the bound at the steps by the excess between them.
const ATTEMPTS: usize = 3;

/// A move, and the allowed residual of each of its joints.
pub struct Search<'a> {
    joints: &'a [Moving],
    known: Vec<Known>,
    /// The path parameter from 0 to 1, as fast as the limits allow, and its limits.
    full: Trajectory,
    path: Limits,
    period: f64,
    /// Allowed deviation of several joints from their path, m.
    deviation: Option<f64>,
}

impl<'a> Search<'a> {
    pub fn new(
        joints: &'a [Moving],
        tolerance: Tolerance,
        period: f64,
    ) -> Result<Self, ToleranceError> {
        let Tolerance {
            residual,
            deviation,
        } = tolerance;
        for (what, value) in [("residual", residual), ("deviation", deviation)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(ToleranceError::Value { what, value });
            }
        }
        if let Some(index) = joints.iter().position(|joint| joint.distance() == 0.0) {
            return Err(ToleranceError::NoWay { index });
        }
        let path = path_limits(joints);
        let ends = [0.0, 1.0].map(AxisState::at_rest);
        let full = Planner::new(1)?.plan(&ends[..1], &ends[1..], &[path])?;
        let known = joints.iter();
        let known = known.map(|joint| Known::new(joint, &full.axes()[0], tolerance));
        Ok(Self {
            known: known.collect(),
            joints,
            full,
            path,
            period,
            deviation: deviation.filter(|_| joints.len() > 1),
        })
    }

    /// The unshaped move, if the tolerance allows it.
    pub fn unshaped(&self) -> Result<Option<Fastest>, ToleranceError> {
        let mut known = self.known.iter();
        if !known.all(|known| known.allowed >= known.unshaped) {
            return Ok(None);
        }
        let worst = |of: fn(&Known) -> f64| self.known.iter().map(of).fold(0.0, f64::max);
        Ok(Some(Fastest {
            plans: self.along(&self.full.sample(self.period)?),
            bounds: Bounds {
                residual: if worst(|known| known.unshaped) > 0.0 {
                    1.0
                } else {
                    0.0
                },
                vibration: worst(|known| known.unshaped * known.lever),
                departure: 0.0,
            },
        }))
    }

    /// The share of the unshaped vibration of the first joint that a train leaves of the plan at the limits.
    pub fn share_left(&self, train: &GridTrain) -> f64 {
        let known = &self.known[0];
        let full = &self.full.axes()[0];
        let left = known.most(self.full.duration(), |swing| {
            let (frequency, ratio) = (swing.frequency(), swing.damping_ratio());
            swing.left_by_plan(full) * train.residual_vibration(frequency, ratio)
        });
        self.joints[0].distance().abs() * left / known.unshaped
    }

    /// Ticks of the unshaped move, and of the longest that is tried.
    pub fn range(&self) -> [usize; 2] {
        let slowest = self.periods().fold(0.0, f64::max);
        let full = self.full.duration();
        [full, full + LONGER * slowest].map(|time| (time / self.period).ceil() as usize)
    }

    /// A move of this number of ticks within the tolerance, if there is one: off the path where that is
    /// allowed, else along it.
    pub fn within(&self, ticks: usize) -> Option<Fastest> {
        let apart = self.deviation.and_then(|most| self.apart(ticks, most));
        apart.or_else(|| self.along_path(ticks))
    }

    /// A move whose joints leave the path by at most a distance (m).
    fn apart(&self, ticks: usize, most: f64) -> Option<Fastest> {
        let axes: Vec<Axis> = self
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| Axis {
                distance: joint.distance(),
                limits: joint.limits,
                modes: self.modes(index, 1.0, ticks),
                lever: joint.lever,
            })
            .collect();
        let mut deviation = most;
        for _ in 0..ATTEMPTS {
            let (jerks, h) = self.solve(&axes, deviation, ticks)?;
            let each = jerks.iter().zip(self.joints);
            let plans = each.map(|(jerks, joint)| self.plan(jerks, h, joint.ends));
            let plans = plans.collect::<Option<Vec<_>>>()?;
            let departure = self.departure(&plans);
            if departure <= most {
                let left = |index: usize| self.left_by(&jerks[index], h, index);
                return self.told(plans, left, departure);
            }
            // The bound holds at the steps; between them the deviation may be larger.
            deviation *= 0.99 * most / departure;
        }
        None
    }

    /// A move with all joints along the path.
    fn along_path(&self, ticks: usize) -> Option<Fastest> {
        let distance = |index: usize| self.joints[index].distance().abs();
        let all =
            (0..self.joints.len()).flat_map(|index| self.modes(index, distance(index), ticks));
        let axis = Axis {
            distance: 1.0,
            limits: self.path,
            modes: all.collect(),
            lever: 0.0,
        };
        let (jerks, h) = self.solve(&[axis], 0.0, ticks)?;
        let path = self.plan(&jerks[0], h, [0.0, 1.0])?;
        let left = |index: usize| distance(index) * self.left_by(&jerks[0], h, index);
        self.told(self.along(&path), left, 0.0)
    }

    /// Jerks of axes with the exact end and within the limits, and the duration of their steps, s.
    fn solve(&self, axes: &[Axis], deviation: f64, ticks: usize) -> Option<(Vec<Vec<f64>>, f64)> {
        let duration = ticks as f64 * self.period;
        let steps = self.steps(duration);
        let h = duration / steps as f64;
        let program = Program {
            axes,
            deviation,
            steps,
        };
        let mut jerks = program.solve(duration)?;
        for (axis, jerks) in axes.iter().zip(&mut jerks) {
            exact_end(jerks, h, axis.distance)?;
            if !keeps_limits(jerks, h, axis.limits) {
                return None;
            }
        }
        Some((jerks, h))
    }

    /// The result, if no joint exceeds its allowed amplitude (rad).
    fn told(
        &self,
        plans: Vec<SampledTrajectory>,
        left: impl Fn(usize) -> f64,
        departure: f64,
    ) -> Option<Fastest> {
        let (mut residual, mut vibration): (f64, f64) = (0.0, 0.0);
        for (index, known) in self.known.iter().enumerate() {
            let left = left(index);
            if left > known.allowed {
                return None;
            }
            if known.unshaped > 0.0 {
                residual = residual.max(left / known.unshaped);
            }
            vibration = vibration.max(left * known.lever);
        }
        let bounds = Bounds {
            residual,
            vibration,
            departure,
        };
        Some(Fastest { plans, bounds })
    }

    fn periods(&self) -> impl Iterator<Item = f64> {
        let modes = self.joints.iter().flat_map(|joint| &joint.modes);
        modes.map(|known| known.mode.damped_period())
    }

    fn steps(&self, duration: f64) -> usize {
        let fastest = self.periods().fold(f64::INFINITY, f64::min);
        let ramp = self.path.acceleration / self.path.jerk;
        let step = (fastest / PER_PERIOD).min(ramp / PER_RAMP);
        (duration / step).clamp(STEPS.0, STEPS.1) as usize
    }

    /// The modes of a joint, whose amplitudes are `factor` times those of its axis, and their weights.
    fn modes(&self, index: usize, factor: f64, ticks: usize) -> Vec<(Swing, f64)> {
        // The level that is minimised is the share of the strictest joint.
        let strictest = self.known.iter().map(Known::share).fold(1.0, f64::min);
        let known = &self.known[index];
        let weight = factor * strictest / known.allowed;
        let nodes = known.nodes(ticks as f64 * self.period);
        nodes.map(|swing| (swing, weight)).collect()
    }

    /// The largest residual amplitude of the modes of a joint after steps of jerk.
    fn left_by(&self, jerks: &[f64], h: f64, index: usize) -> f64 {
        let duration = jerks.len() as f64 * h;
        self.known[index].most(duration, |swing| swing.left_by(jerks, h))
    }

    fn plan(&self, jerks: &[f64], h: f64, ends: [f64; 2]) -> Option<SampledTrajectory> {
        let steps: Vec<(f64, f64)> = jerks.iter().map(|jerk| (h, *jerk)).collect();
        let [from, to] = ends.map(AxisState::at_rest);
        let plan = Trajectory::of_steps(from, to, &steps).ok()?;
        plan.sample(self.period).ok()
    }

    fn along(&self, path: &SampledTrajectory) -> Vec<SampledTrajectory> {
        let each = self.joints.iter();
        each.map(|joint| path.along(joint.ends[0], joint.distance()))
            .collect()
    }

    /// Largest over the ticks of `min_s sum_i r_i |q_i - q_i(s)|`, m: the tip is never farther from the path.
    ///
    /// The sum is piecewise linear in `s`, so that it is least where one of the joints is on the path.
    fn departure(&self, plans: &[SampledTrajectory]) -> f64 {
        let ticks = plans.iter().map(SampledTrajectory::samples).max();
        let at = |tick: usize| {
            let shares = plans.iter().zip(self.joints).map(|(plan, joint)| {
                let state = plan.state(0, tick).unwrap_or_default();
                (state.position - joint.ends[0]) / joint.distance()
            });
            let shares: Vec<f64> = shares.collect();
            let sum = |s: f64| -> f64 {
                let each = shares.iter().zip(self.joints);
                each.map(|(share, joint)| (joint.lever * joint.distance() * (share - s)).abs())
                    .sum()
            };
            shares.iter().map(|s| sum(*s)).fold(f64::INFINITY, f64::min)
        };
        (0..ticks.unwrap_or(0)).map(at).fold(0.0, f64::max)
    }
}

/// Limits of the path parameter, which runs from 0 to 1: those of the most restrictive joint.
fn path_limits(joints: &[Moving]) -> Limits {
    let least = |of: fn(&Limits) -> f64| {
        let each = joints.iter();
        let each = each.map(|joint| of(&joint.limits) / joint.distance().abs());
        each.fold(f64::INFINITY, f64::min)
    };
    Limits {
        velocity: least(|limits| limits.velocity),
        acceleration: least(|limits| limits.acceleration),
        jerk: least(|limits| limits.jerk),
    }
}
