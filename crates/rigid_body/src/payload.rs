//! What a robot carries that its description does not have: mass and lever, from the torques of all joints.

use super::contradiction::{BLOCKS, Own, Rows};
use super::dynamics::Dynamics;
use super::robot::Robot;
use nalgebra::{DMatrix, DVector, Matrix3, Point3};
use quell_signal::Body;

/// Values of F that one in a thousand exceeds by chance, for 1 to 4 parameters and 20 blocks (tables of the F
/// distribution: 1 and 19 degrees of freedom, 2 and 18, 3 and 17, 4 and 16).
const CHANCE: [f64; 4] = [15.08, 10.39, 8.73, 7.94];
/// Corrections after the first estimate: a point's inertia is of second order in its lever.
const CORRECTIONS: usize = 4;

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
/// each joint left free.
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
    let columns = |own| columns(robot, own, joint, &scale);
    let columns: Vec<_> = rows.iter().map(columns).collect();
    let mut parameters = DVector::zeros(4);
    let mut first = None;
    for _ in 0..=CORRECTIONS {
        let body = point(joint, &parameters);
        let dynamics =
            body.map_or_else(|| robot.dynamics.clone(), |body| robot.dynamics.with(body));
        let sums = Sums::of(&rows, &columns, &dynamics);
        let step = sums.solved()?;
        parameters += step.parameters.component_mul(&scale);
        first.get_or_insert(step);
    }
    let first = first?;
    let certain = first.is_no_chance();
    let body = point(joint, &parameters).filter(|_| certain)?;
    let axis = robot.dynamics.joints()[joint].axis;
    let centre = body.centre.coords;
    Some(Payload {
        joint,
        mass: body.mass,
        mass_std: first.mass_std * scale[0],
        centre: body.centre,
        lever: (centre - axis.into_inner() * axis.dot(&centre)).norm(),
    })
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
    mass_std: f64,
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
        let spread = &known * covariance * known.transpose();
        Some(Step {
            parameters: &known * whole,
            mass_std: spread[(0, 0)].max(0.0).sqrt(),
            value: statistic * degrees,
            rank,
        })
    }
}

/// The torque at a joint for a unit of mass, and of first moment along each axis, but for what the joint's own physics may
/// be.
fn columns(robot: &Robot, rows: &Rows, joint: usize, scale: &DVector<f64>) -> Vec<DVector<f64>> {
    let unit = |mass: f64, moment: [f64; 3]| {
        // A pair of masses at the ends of a short rod has a first moment and, in the limit, no second one.
        let body = |mass: f64, sign: f64| Body {
            joint,
            mass,
            centre: Point3::from(moment.map(|own| sign * own)),
            inertia: Matrix3::zeros(),
        };
        let masses = match mass > 0.0 {
            true => vec![body(mass, 0.0)],
            false => vec![body(0.5, 1.0), body(-0.5, -1.0)],
        };
        let parts: Vec<Dynamics> = masses
            .into_iter()
            .map(|own| robot.dynamics.of_body(own))
            .collect();
        let of = |[q, rate, acceleration]: &[Vec<f64>; 3]| -> f64 {
            let own = |part: &Dynamics| part.torques(q, rate, acceleration)[rows.joint];
            parts.iter().map(own).sum()
        };
        DVector::from_iterator(rows.time.len(), rows.states.iter().map(of))
    };
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut columns = vec![unit(1.0, [0.0; 3])];
    columns.extend(axes.map(|axis| unit(0.0, axis)));
    let scaled = columns.into_iter().zip(scale.iter());
    scaled
        .map(|(column, scale)| rows.without_own(column * *scale))
        .collect()
}
