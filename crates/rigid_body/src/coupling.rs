//! Couplings of joints that a description does not have.

use super::contradiction::{BLOCKS, Own, Rows};
use super::dynamics::Dynamics;
use super::robot::Robot;
use nalgebra::DVector;

/// Standard deviations beyond which it is not chance: one in ten thousand with 19 degrees of freedom, for some hundred
/// are tried.
const CHANCE: f64 = 5.0;
/// Most couplings of one joint.
const MOST: usize = 4;

/// What of another joint a coupling follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Its acceleration: an inertia that both share, as of gears in the wrist.
    Acceleration,
    /// Its velocity: viscous friction of what turns with both.
    Velocity,
    /// The direction of its motion: dry friction.
    Direction,
}

/// A torque at a joint that follows the motion of another one, and that the description does not have.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// The joint at which it acts, counted from 0 in the description.
    pub joint: usize,
    /// The joint that it follows.
    pub other: usize,
    /// What of it.
    pub cause: Cause,
    /// Torque for a unit of the cause: N.m.s^2/rad, N.m.s/rad, N.m.
    pub size: f64,
    /// One standard deviation, by a jackknife over blocks of time.
    pub std: f64,
}

impl Cause {
    const ALL: [Self; 3] = [Self::Acceleration, Self::Velocity, Self::Direction];

    fn of(self, rate: f64, acceleration: f64) -> f64 {
        match self {
            Self::Acceleration => acceleration,
            Self::Velocity => rate,
            Self::Direction if rate == 0.0 => 0.0,
            Self::Direction => rate.signum(),
        }
    }
}

impl Coupling {
    /// The torque that it takes at an instant.
    pub fn torque(&self, robot: &Robot, time: f64) -> f64 {
        let [_, rate, acceleration] = robot.course(self.other).at(time);
        self.size * self.cause.of(rate, acceleration)
    }
}

/// The couplings that the measured torques show: those that neither the description nor any friction and any force over
/// position of the joint itself explains, the surest first, each beside those before it. One that adds less than the noise
/// of a sample is none: so much the smoothing of the accelerations leaves.
pub fn couplings(robot: &Robot, dynamics: &Dynamics) -> Vec<Coupling> {
    let mut found = Vec::new();
    for joint in &robot.joints {
        let Some(rows) = Rows::of(robot, joint, Own::FrictionAndPosition) else {
            continue;
        };
        let mut left = rows.left(dynamics);
        let mut columns = causes(robot, &rows);
        for _ in 0..MOST {
            let fitted = columns
                .iter()
                .map(|own| (own.0, own.1, fitted(&rows, &own.2, &left)));
            let seen = fitted.filter(|own| own.2.reach > rows.noise);
            let best = seen.max_by(|a, b| a.2.certainty().total_cmp(&b.2.certainty()));
            let Some((other, cause, fit)) = best.filter(|best| best.2.certainty() > CHANCE) else {
                break;
            };
            let taken = columns
                .iter()
                .position(|own| (own.0, own.1) == (other, cause));
            let Some(taken) = taken else { break };
            let column = columns.swap_remove(taken).2;
            left.axpy(-fit.size, &column, 1.0);
            found.push(Coupling {
                joint: joint.index,
                other,
                cause,
                size: fit.size,
                std: fit.std,
            });
        }
    }
    found
}

/// What of each other joint may be a cause, but for what the joint's own physics may be.
fn causes(robot: &Robot, rows: &Rows) -> Vec<(usize, Cause, DVector<f64>)> {
    let others = robot.joints.iter().map(|joint| joint.index);
    let others = others.filter(|index| *index != rows.joint);
    let mut columns = Vec::new();
    for other in others {
        for cause in Cause::ALL {
            let of = |[_, rate, acceleration]: &[Vec<f64>; 3]| {
                cause.of(rate[other], acceleration[other])
            };
            let column = DVector::from_iterator(rows.time.len(), rows.states.iter().map(of));
            let size = column.norm();
            let column = rows.without_own(column);
            // Motions in step with the joint's own say nothing.
            if column.norm() > 1e-3 * size {
                columns.push((other, cause, column));
            }
        }
    }
    columns
}

#[derive(Clone, Copy)]
struct Fit {
    size: f64,
    std: f64,
    /// Root mean square of what it adds to the torque.
    reach: f64,
}

impl Fit {
    fn certainty(&self) -> f64 {
        self.size.abs() / self.std
    }
}

/// The slope over a column, by least squares, and its deviation by a jackknife.
fn fitted(rows: &Rows, column: &DVector<f64>, left: &DVector<f64>) -> Fit {
    let (mut square, mut product) = ([0.0; BLOCKS], [0.0; BLOCKS]);
    for row in 0..left.len() {
        let block = rows.block(row);
        square[block] += column[row] * column[row];
        product[block] += column[row] * left[row];
    }
    let (all, along): (f64, f64) = (square.iter().sum(), product.iter().sum());
    let without = |block: usize| (along - product[block]) / (all - square[block]);
    let parts: Vec<f64> = (0..BLOCKS).map(without).collect();
    let mean = parts.iter().sum::<f64>() / BLOCKS as f64;
    let scatter: f64 = parts.iter().map(|part| (part - mean).powi(2)).sum();
    let count = BLOCKS as f64;
    let size = along / all;
    Fit {
        size,
        reach: size.abs() * (all / left.len() as f64).sqrt(),
        std: (scatter * (count - 1.0) / count)
            .sqrt()
            .max(f64::MIN_POSITIVE),
    }
}
