//! Moves that are tried, and what they leave: by trains, and of a given number of ticks by the convex problem.

use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory, Trajectory};

use super::check::{exact_end, keeps_limits};
use super::known::Known;
use super::left::{Left, Tried, least};
use super::program::{Axis, Program};
use super::steps::{Step, steps};
use super::swing::Swing;
use super::trains::Trains;
use super::{Bounds, Fastest, Moving, Tolerance, ToleranceError};

/// Number of steps in a period of the fastest mode, and in the ramp of the acceleration at the limits.
const PER_PERIOD: f64 = 12.0;
const PER_RAMP: f64 = 3.0;
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

    /// The share of the unshaped vibration of the first joint that trains leave of the plan at the limits.
    pub fn share_left(&self, trains: &Trains) -> f64 {
        self.left_by_trains(trains, 0) / self.known[0].unshaped
    }

    /// The shortest move by the trains of a shaper that is within the tolerance, else what the best of them leaves.
    pub fn by_trains(&self) -> Tried {
        let modes = self.joints.iter().flat_map(|joint| &joint.modes);
        let mut best = None;
        for trains in Trains::of_catalogue(modes, self.period) {
            let left = self.left(|index| self.left_by_trains(&trains, index), 0.0);
            let path = || trains.shaped(&self.full)?.sample(self.period).ok();
            match left.within(|| Some(self.along(&path()?))) {
                Ok(found) => return Ok(found),
                Err(left) => best = least(best, left),
            }
        }
        Err(best)
    }

    fn left_by_trains(&self, trains: &Trains, index: usize) -> f64 {
        let full = &self.full.axes()[0];
        let left = self.known[index].most(self.full.duration(), |swing| {
            let (frequency, ratio) = (swing.frequency(), swing.damping_ratio());
            swing.left_by_plan(full) * trains.residual(frequency, ratio)
        });
        self.joints[index].distance().abs() * left
    }

    /// Ticks of the unshaped move, and of the longest that is tried.
    pub fn range(&self) -> [usize; 2] {
        let slowest = self.periods().fold(0.0, f64::max);
        let full = self.full.duration();
        [full, full + LONGER * slowest].map(|time| (time / self.period).ceil() as usize)
    }

    /// A move of this number of ticks of least residual: off the path where that is allowed, else along it.
    pub fn within(&self, ticks: usize) -> Tried {
        match self.deviation.map(|most| self.apart(ticks, most)) {
            None => self.along_path(ticks),
            Some(Ok(found)) => Ok(found),
            Some(Err(apart)) => self.along_path(ticks).map_err(|along| least(apart, along)),
        }
    }

    /// A move whose joints leave the path by at most a distance (m).
    fn apart(&self, ticks: usize, most: f64) -> Tried {
        let axes = self.joints.iter().enumerate().map(|(index, joint)| Axis {
            distance: joint.distance(),
            limits: joint.limits,
            modes: self.modes(index, 1.0, ticks),
            lever: joint.lever,
        });
        let axes: Vec<Axis> = axes.collect();
        let ends: Vec<[f64; 2]> = self.joints.iter().map(|joint| joint.ends).collect();
        let mut deviation = most;
        for _ in 0..ATTEMPTS {
            let motions = self.solve(&axes, deviation, (ticks, &ends)).ok_or(None)?;
            let plans = motions.iter().map(|motion| motion.sample(self.period).ok());
            let plans = plans.collect::<Option<Vec<_>>>().ok_or(None)?;
            let departure = self.departure(&plans);
            if departure <= most {
                let left = |index: usize| self.left_by(&motions[index], index);
                return self.left(left, departure).within(|| Some(plans));
            }
            // The bound holds at the steps; between them the deviation may be larger.
            deviation *= 0.99 * most / departure;
        }
        Err(None)
    }

    /// A move with all joints along the path.
    fn along_path(&self, ticks: usize) -> Tried {
        let distance = |index: usize| self.joints[index].distance().abs();
        let all =
            (0..self.joints.len()).flat_map(|index| self.modes(index, distance(index), ticks));
        let axis = Axis {
            distance: 1.0,
            limits: self.path,
            modes: all.collect(),
            lever: 0.0,
        };
        let motion = self.solve(&[axis], 0.0, (ticks, &[[0.0, 1.0]]));
        let motion = &motion.ok_or(None)?[0];
        let left = |index: usize| distance(index) * self.left_by(motion, index);
        let plans = || Some(self.along(&motion.sample(self.period).ok()?));
        self.left(left, 0.0).within(plans)
    }

    /// Motions of axes between exact ends and within the limits.
    fn solve(
        &self,
        axes: &[Axis],
        deviation: f64,
        (ticks, ends): (usize, &[[f64; 2]]),
    ) -> Option<Vec<Trajectory>> {
        let steps = self.steps(ticks);
        let program = Program {
            axes,
            deviation,
            steps: &steps,
        };
        let each = program.solve()?.into_iter().zip(axes).zip(ends);
        let motions = each.map(|((mut jerks, axis), ends)| {
            exact_end(&mut jerks, &steps, axis.distance)?;
            let steps = steps.iter().zip(jerks);
            let steps: Vec<(f64, f64)> = steps.map(|(step, jerk)| (step.duration, jerk)).collect();
            let [from, to] = ends.map(AxisState::at_rest);
            let motion = Trajectory::of_steps(from, to, &steps).ok()?;
            keeps_limits(&motion.axes()[0], axis.limits).then_some(motion)
        });
        motions.collect()
    }

    /// What a move leaves, from the amplitude of each joint (rad).
    fn left(&self, left: impl Fn(usize) -> f64, departure: f64) -> Left {
        let amplitudes = (0..self.known.len()).map(left);
        Left::new(self.known.iter().zip(amplitudes), departure)
    }

    fn periods(&self) -> impl Iterator<Item = f64> {
        let modes = self.joints.iter().flat_map(|joint| &joint.modes);
        modes.map(|known| known.mode.damped_period())
    }

    fn steps(&self, ticks: usize) -> Vec<Step> {
        let fastest = self.periods().fold(f64::INFINITY, f64::min);
        let ramp = self.path.acceleration / self.path.jerk;
        let short = (fastest / PER_PERIOD).min(ramp / PER_RAMP);
        steps(&self.full.axes()[0], ticks as f64 * self.period, short)
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

    /// The largest residual amplitude of the modes of a joint after a motion.
    fn left_by(&self, motion: &Trajectory, index: usize) -> f64 {
        let axis = &motion.axes()[0];
        self.known[index].most(motion.duration(), |swing| swing.left_by_plan(axis))
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
