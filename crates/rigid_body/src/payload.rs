//! What a robot carries that its description does not have: mass and lever, from the torques of all joints.

use super::contradiction::{BLOCKS, Own, Rows};
use super::dynamics::Dynamics;
use super::robot::Robot;
use nalgebra::{DMatrix, DVector, Matrix3, Point3, Vector3};
use quell_signal::Body;

/// Values of F that one in a thousand exceeds by chance, for 1 to 4 parameters and 20 blocks (tables of the F
/// distribution: 1 and 19 degrees of freedom, 2 and 18, 3 and 17, 4 and 16).
const CHANCE: [f64; 4] = [15.08, 10.39, 8.73, 7.94];
/// Most corrections after the first estimate, and most halvings of one; the fits here end after three to six.
const CORRECTIONS: usize = 20;
const HALVINGS: usize = 10;
/// Fall of twice the negative logarithm of the likelihood at convergence: a hundredth of one chi-squared.
const ENDED: f64 = 0.01;

/// A point mass on the last link that the description does not have; below 0 the link is lighter than that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload {
    /// The joint whose link carries it, counted from 0.
    pub joint: usize,
    /// Mass, kg.
    pub mass: f64,
    /// One standard deviation of it, kg, by a jackknife over blocks of time.
    pub mass_std: f64,
    /// Where it is in the link's frame, m.
    pub centre: Point3<f64>,
    /// How far it is from the joint's axis, m.
    pub lever: f64,
    /// One standard deviation of that, m, by the same jackknife.
    pub lever_std: f64,
}

impl Payload {
    /// It as a body of the description.
    pub fn body(&self) -> Body {
        Body {
            joint: self.joint,
            mass: self.mass,
            centre: self.centre,
            inertia: Matrix3::zeros(),
        }
    }
}

/// The mass and first moment that the measured torques show at the last link beside the description, where it is not
/// chance: none where no torque was measured, or what is there is explained without.
///
/// Weighted least squares of the joints' torques over the parameters, the inertia of a rotor, an offset and any friction of
/// each joint left free: linear at first, without the point's second moment, then by Gauss and Newton's method with it.
///
/// Source: Khalil, Gautier, Lemoine, Identification of the payload inertial parameters of industrial manipulators, IEEE
/// ICRA (2007); Hotelling's test for the whole.
pub fn payload(robot: &Robot) -> Option<Payload> {
    let joint = robot.dynamics.last();
    let rows = robot.joints.iter();
    let rows: Vec<Rows> = rows
        .filter_map(|own| Rows::of(robot, own, Own::Friction))
        .collect();
    let scale = scale(robot, &rows, joint)?;
    let step = |at: &DVector<f64>| {
        let centre = point(joint, at).map_or_else(Vector3::zeros, |body| body.centre.coords);
        let of = |own| columns(robot, own, (joint, centre), &scale);
        let columns: Vec<_> = rows.iter().map(of).collect();
        Sums::of(&rows, &columns, &carrying(robot, joint, at)).solved()
    };
    let cost = |at: &DVector<f64>| cost(&rows, &carrying(robot, joint, at));
    let first = step(&DVector::zeros(4)).filter(Step::is_no_chance)?;
    let start = first.parameters.component_mul(&scale);
    let (at, spread) = corrected(start, first.covariance, &scale, step, cost);
    let spread = spread.component_mul(&(&scale * scale.transpose()));
    let body = point(joint, &at)?;
    let axis = robot.dynamics.joints()[joint].axis;
    let centre = body.centre.coords;
    let across = centre - axis.into_inner() * axis.dot(&centre);
    let lever = across.norm();
    // The lever is the first moment across the axis over the mass.
    let slope = match lever > 0.0 {
        true => across / lever,
        false => Vector3::zeros(),
    };
    let slope = DVector::from_vec(vec![-lever, slope.x, slope.y, slope.z]) / body.mass;
    Some(Payload {
        joint,
        mass: body.mass,
        mass_std: spread[(0, 0)].max(0.0).sqrt(),
        centre: body.centre,
        lever,
        lever_std: slope.dot(&(&spread * &slope)).max(0.0).sqrt(),
    })
}

/// The parameters from which no step goes further down, and their covariance there in units of the scale.
fn corrected(
    mut at: DVector<f64>,
    mut covariance: DMatrix<f64>,
    scale: &DVector<f64>,
    step: impl Fn(&DVector<f64>) -> Option<Step>,
    cost: impl Fn(&DVector<f64>) -> f64,
) -> (DVector<f64>, DMatrix<f64>) {
    let mut now = cost(&at);
    for _ in 0..CORRECTIONS {
        let Some(next) = step(&at) else { break };
        covariance = next.covariance;
        let by = next.parameters.component_mul(scale);
        let shorter = (0..HALVINGS).map(|k| &at + &by * 0.5_f64.powi(k as i32));
        let better = shorter
            .map(|to| (cost(&to), to))
            .find(|(left, _)| *left < now);
        let Some((left, to)) = better else { break };
        let fall = now - left;
        (now, at) = (left, to);
        if fall < ENDED {
            break;
        }
    }
    (at, covariance)
}

/// The description with the point of these parameters.
fn carrying(robot: &Robot, joint: usize, parameters: &DVector<f64>) -> Dynamics {
    let body = point(joint, parameters);
    body.map_or_else(|| robot.dynamics.clone(), |body| robot.dynamics.with(body))
}

/// Twice the negative logarithm of the likelihood of what is left, each joint's noise being what is left of it.
fn cost(rows: &[Rows], dynamics: &Dynamics) -> f64 {
    let of = |own: &Rows| {
        let left = own.left(dynamics);
        left.len() as f64 * left.norm_squared().max(f64::MIN_POSITIVE).ln()
    };
    rows.iter().map(of).sum()
}

/// The body of a mass and a first moment.
fn point(joint: usize, parameters: &DVector<f64>) -> Option<Body> {
    let mass = parameters[0];
    (mass != 0.0).then(|| Body {
        joint,
        mass,
        centre: Point3::new(parameters[1], parameters[2], parameters[3]) / mass,
        inertia: Matrix3::zeros(),
    })
}

/// What is believed of the parameters: 0, give or take the mass of all links, and that at the arm's reach.
fn scale(robot: &Robot, rows: &[Rows], joint: usize) -> Option<DVector<f64>> {
    let mass: f64 = robot.dynamics.bodies().iter().map(|body| body.mass).sum();
    let state = &rows.first()?.states.first()?[0];
    let reach = robot.dynamics.inertias(state);
    let largest = reach.iter().copied().fold(reach[joint], f64::max);
    let lever = (largest / mass).sqrt();
    let usable = mass > 0.0 && lever > 0.0;
    usable.then(|| DVector::from_vec(vec![mass, mass * lever, mass * lever, mass * lever]))
}

/// Normal equations in units of what is believed, a block of time each.
struct Sums {
    normal: Vec<DMatrix<f64>>,
    right: Vec<DVector<f64>>,
}

/// A solution, in units of what is believed.
struct Step {
    parameters: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Hotelling's statistic as a value of F, and how many parameters it is of.
    value: f64,
    rank: usize,
}

impl Step {
    fn is_no_chance(&self) -> bool {
        (1..=CHANCE.len()).contains(&self.rank) && self.value > CHANCE[self.rank - 1]
    }
}

impl Sums {
    fn of(rows: &[Rows], columns: &[Vec<DVector<f64>>], dynamics: &Dynamics) -> Self {
        let mut sums = Self {
            normal: vec![DMatrix::zeros(4, 4); BLOCKS],
            right: vec![DVector::zeros(4); BLOCKS],
        };
        for (own, columns) in rows.iter().zip(columns) {
            let left = own.left(dynamics);
            let deviation = left.norm() / (left.len() as f64).sqrt();
            if deviation == 0.0 {
                continue;
            }
            for row in 0..left.len() {
                let block = own.block(row);
                let x = DVector::from_iterator(4, columns.iter().map(|c| c[row] / deviation));
                sums.right[block] += &x * (left[row] / deviation);
                sums.normal[block] += &x * x.transpose();
            }
        }
        sums
    }

    /// In the directions that the data know better than what is believed.
    fn solved(&self) -> Option<Step> {
        let all = self.normal.iter().fold(DMatrix::zeros(4, 4), |a, b| a + b);
        let right = self.right.iter().fold(DVector::zeros(4), |a, b| a + b);
        let eigen = all.clone().symmetric_eigen();
        let known: Vec<_> = (0..4).filter(|&k| eigen.eigenvalues[k] > 1.0).collect();
        if known.is_empty() {
            return None;
        }
        let known = DMatrix::from_columns(
            &known
                .iter()
                .map(|&k| eigen.eigenvectors.column(k).into_owned())
                .collect::<Vec<_>>(),
        );
        let solve = |normal: &DMatrix<f64>, right: &DVector<f64>| {
            let normal = known.tr_mul(normal) * &known;
            normal
                .cholesky()
                .map(|root| root.solve(&known.tr_mul(right)))
        };
        let whole = solve(&all, &right)?;
        let mut parts = Vec::with_capacity(BLOCKS);
        for (normal, own) in self.normal.iter().zip(&self.right) {
            parts.push(solve(&(&all - normal), &(&right - own))?);
        }
        let count = BLOCKS as f64;
        let mean = parts.iter().fold(DVector::zeros(whole.len()), |a, b| a + b) / count;
        let mut covariance = DMatrix::zeros(whole.len(), whole.len());
        for part in &parts {
            let off = part - &mean;
            covariance += &off * off.transpose();
        }
        covariance *= (count - 1.0) / count;
        let rank = whole.len();
        let statistic = whole.dot(&covariance.clone().cholesky()?.solve(&whole));
        let degrees = (count - rank as f64) / (rank as f64 * (count - 1.0));
        Some(Step {
            parameters: &known * whole,
            covariance: &known * covariance * known.transpose(),
            value: statistic * degrees,
            rank,
        })
    }
}

/// The torque at a joint for a unit of mass, and of first moment along each axis, of a point that is at a centre already,
/// but for what the joint's own physics may be. Its second moment is `h h^T / m`: it changes by `-c c^T` for a unit of
/// mass, and by `e c^T + c e^T` for one of first moment along `e`.
fn columns(
    robot: &Robot,
    rows: &Rows,
    (joint, centre): (usize, Vector3<f64>),
    scale: &DVector<f64>,
) -> Vec<DVector<f64>> {
    let body = |mass: f64, centre: Vector3<f64>, second: Matrix3<f64>| Body {
        joint,
        mass,
        centre: Point3::from(centre),
        inertia: Matrix3::identity() * second.trace() - second,
    };
    let unit = |bodies: Vec<Body>| {
        let bodies = bodies.into_iter();
        let parts: Vec<Dynamics> = bodies.map(|own| robot.dynamics.of_body(own)).collect();
        let of = |[q, rate, acceleration]: &[Vec<f64>; 3]| -> f64 {
            let own = |part: &Dynamics| part.torques(q, rate, acceleration)[rows.joint];
            parts.iter().map(own).sum()
        };
        DVector::from_iterator(rows.time.len(), rows.states.iter().map(of))
    };
    // A pair of masses at the ends of a rod has a first moment and no second one, but for what is added.
    let pair = |axis: Vector3<f64>| {
        let second = axis * centre.transpose() + centre * axis.transpose();
        vec![body(0.5, axis, second), body(-0.5, -axis, Matrix3::zeros())]
    };
    let mass = body(1.0, Vector3::zeros(), -centre * centre.transpose());
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let columns = [vec![mass]].into_iter().chain(axes.map(pair)).map(unit);
    columns
        .zip(scale.iter())
        .map(|(column, scale)| rows.without_own(column * *scale))
        .collect()
}
