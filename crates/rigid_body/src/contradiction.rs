//! What the torques of a joint leave of a description, and what the joint's own friction explains of it.

use super::dynamics::Dynamics;
use super::robot::{Joint, Robot};
use nalgebra::{DMatrix, DVector};
use quell_recording::{Channel, Role};

/// Blocks of time of a jackknife: enough degrees of freedom (19) for its own spread not to matter much.
pub const BLOCKS: usize = 20;
/// Rows of a joint at most: more of a smooth motion say the same again.
const ROWS: usize = 20_000;
/// Knots of a joint's own curves over speed, in either direction, and over position.
const SPEEDS: usize = 6;
const POSITIONS: usize = 12;

/// The rows of one joint: instants at which it moves and its torque was measured.
pub struct Rows {
    /// The joint of the description.
    pub joint: usize,
    pub time: Vec<f64>,
    /// Positions, velocities and accelerations of all joints.
    pub states: Vec<[Vec<f64>; 3]>,
    /// The measured torque.
    torque: Vec<f64>,
    /// The noise of the torque.
    pub noise: f64,
    /// An orthonormal basis of what the joint may do itself.
    own: DMatrix<f64>,
}

/// What a joint may do itself.
#[derive(Clone, Copy, PartialEq)]
pub enum Own {
    /// An offset, and any friction over its velocity.
    Speed,
    /// The same, and a rotor's inertia.
    Friction,
    /// The same, and any force over its position.
    FrictionAndPosition,
}

/// The torque of a joint, where it was measured.
pub fn torque<'a>(robot: &Robot, joint: &'a Joint) -> Option<&'a Channel> {
    let unit = robot.unit(joint.index);
    let mut channels = joint.recording.channels.iter();
    channels.find(|own| matches!(own.role, Role::Torque | Role::Force) && own.unit == unit)
}

impl Rows {
    /// The rows of a joint; none where it has no torque or hardly moves.
    pub fn of(robot: &Robot, joint: &Joint, own: Own) -> Option<Self> {
        let channel = torque(robot, joint)?;
        let stride = channel.time.len().div_ceil(ROWS);
        let course = robot.course(joint.index);
        let stamps = channel.time.iter().zip(&channel.columns[0]).step_by(stride);
        let moving = stamps.filter(|(time, _)| course.moves(**time));
        let (time, torque): (Vec<f64>, Vec<f64>) = moving.unzip();
        let states: Vec<_> = time.iter().map(|t| robot.state(*t)).collect();
        let curves = curves(&states, joint.index, own);
        (time.len() > 2 * BLOCKS + 2 * curves.len()).then(|| Self {
            joint: joint.index,
            own: basis(curves),
            time,
            states,
            torque,
            noise: quell_signal::noise_floor(&channel.columns[0]).standard_deviation,
        })
    }

    /// What a description leaves of the torque, and the joint's own physics of that.
    pub fn left(&self, dynamics: &Dynamics) -> DVector<f64> {
        let left = self
            .states
            .iter()
            .zip(&self.torque)
            .map(|([q, rate, acceleration], torque)| {
                torque - dynamics.torques(q, rate, acceleration)[self.joint]
            });
        self.without_own(DVector::from_iterator(self.time.len(), left))
    }

    /// What of a series the joint's own physics cannot be.
    pub fn without_own(&self, series: DVector<f64>) -> DVector<f64> {
        let within = self.own.tr_mul(&series);
        series - &self.own * within
    }

    /// The block of time that a row is in.
    pub fn block(&self, row: usize) -> usize {
        row * BLOCKS / self.time.len()
    }
}

/// The columns of what a joint may do itself.
fn curves(states: &[[Vec<f64>; 3]], joint: usize, own: Own) -> Vec<Vec<f64>> {
    let series = |order: usize| -> Vec<f64> { states.iter().map(|s| s[order][joint]).collect() };
    let [position, rate, acceleration] = [0, 1, 2].map(series);
    let mut columns = vec![vec![1.0; rate.len()]];
    if own != Own::Speed {
        columns.push(acceleration);
    }
    for sign in [1.0, -1.0] {
        let speed: Vec<f64> = rate.iter().map(|v| sign * v).collect();
        columns.extend(hats(&speed, 0.0, SPEEDS));
    }
    if own == Own::FrictionAndPosition {
        let least = position.iter().copied().fold(f64::INFINITY, f64::min);
        columns.extend(hats(&position, least, POSITIONS));
    }
    columns
}

/// Piecewise straight lines over a coordinate from here on, as many as knots; 0 before it.
fn hats(x: &[f64], from: f64, knots: usize) -> Vec<Vec<f64>> {
    let to = x.iter().copied().fold(from, f64::max);
    let width = ((to - from) / (knots - 1) as f64).max(f64::MIN_POSITIVE);
    let hat = |knot: usize| {
        let of = |x: &f64| match *x >= from {
            true => (1.0 - ((x - from) / width - knot as f64).abs()).max(0.0),
            false => 0.0,
        };
        x.iter().map(of).collect()
    };
    (0..knots).map(hat).collect()
}

/// An orthonormal basis of columns, by Gram and Schmidt, twice; what is rounding of the others is left out.
fn basis(columns: Vec<Vec<f64>>) -> DMatrix<f64> {
    let rows = columns[0].len();
    let mut found: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let mut own = DVector::from_vec(column);
        let size = own.norm();
        for _ in 0..2 {
            for other in &found {
                let along = other.dot(&own);
                own.axpy(-along, other, 1.0);
            }
        }
        let left = own.norm();
        if left > 1e-8 * size {
            found.push(own / left);
        }
    }
    match found.is_empty() {
        true => DMatrix::zeros(rows, 0),
        false => DMatrix::from_columns(&found),
    }
}
