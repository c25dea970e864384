//! An arm of two links in a vertical plane, by its equations of motion as they stand in textbooks, and a recording of it.
//!
//! Source: Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006), section 7.3.2.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::fmt::Write as _;
use std::path::Path;

const RATE: f64 = 500.0;
const G: f64 = 9.80665;
/// Length of the first link, and how far both centres of mass are from their joints, m.
const L1: f64 = 0.4;
const C1: f64 = 0.25;
const C2: f64 = 0.2;
/// Masses (kg) and inertias about the centres of mass (kg m^2).
const M1: f64 = 3.0;
const M2: f64 = 2.0;
const I1: f64 = 0.05;
const I2: f64 = 0.03;
/// Inertia of the rotors behind their gears, kg m^2.
const ROTORS: [f64; 2] = [0.5, 0.2];
/// Noise of encoders (rad) and of torques (N.m).
const NOISE: (f64, [f64; 2]) = (1e-5, [0.2, 0.05]);

/// What the description of the arm does not have.
#[derive(Clone, Copy, Default)]
pub struct Hidden {
    /// Coulomb friction, N.m.
    pub friction: [f64; 2],
    /// A point mass at the end of the second link, kg, and how far it is from the elbow, m.
    pub payload: [f64; 2],
    /// Whether there are no rotors.
    pub no_rotors: bool,
    /// Torque at the elbow for the acceleration of the shoulder, N.m.s^2/rad.
    pub coupling: f64,
}

/// The description, without what is hidden.
pub fn urdf() -> String {
    let link = |name: &str, mass: f64, centre: f64, inertia: f64| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"{centre} 0 0\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"0.001\" ixy=\"0\" ixz=\"0\" iyy=\"{inertia}\" iyz=\"0\" izz=\"0.001\"/></inertial></link>\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{x} 0 0\"/><axis xyz=\"0 -1 0\"/>\
             <limit lower=\"-3\" upper=\"3\" velocity=\"9\" effort=\"99\"/></joint>\n"
        )
    };
    [
        "<robot name=\"two\"><link name=\"base\"/>\n".into(),
        link("upper", M1, C1, I1),
        link("lower", M2, C2, I2),
        joint("shoulder", "base", "upper", 0.0),
        joint("elbow", "upper", "lower", L1),
        "</robot>\n".into(),
    ]
    .concat()
}

/// Torques and inertia matrix of the links: `tau = M a + h`.
fn equations(q: [f64; 2], v: [f64; 2], hidden: &Hidden) -> ([[f64; 2]; 2], [f64; 2]) {
    let ([mp, lp], (sin, cos)) = (hidden.payload, q[1].sin_cos());
    let second = M2 * C2 * C2 + mp * lp * lp;
    let (mass, moment) = (M2 + mp, M2 * C2 + mp * lp);
    let m11 = M1 * C1 * C1 + I1 + I2 + second + mass * L1 * L1 + 2.0 * L1 * moment * cos;
    let m12 = second + I2 + L1 * moment * cos;
    let m22 = second + I2;
    let h = -L1 * moment * sin;
    let g2 = moment * G * (q[0] + q[1]).cos();
    let g1 = (M1 * C1 + mass * L1) * G * q[0].cos() + g2;
    let bias = [h * v[1] * (2.0 * v[0] + v[1]) + g1, -h * v[0] * v[0] + g2];
    let rotors = if hidden.no_rotors { [0.0; 2] } else { ROTORS };
    let matrix = [
        [m11 + rotors[0], m12],
        [m12 + hidden.coupling, m22 + rotors[1]],
    ];
    (matrix, bias)
}

/// Point-to-point moves of the seventh order with rests between, at both joints out of step: value and two rates.
fn motion(t: f64, moves: &[(f64, f64, f64)], home: f64) -> [f64; 3] {
    let mut sum = [home, 0.0, 0.0];
    let mut before = home;
    for &(start, duration, target) in moves {
        let s = ((t - start) / duration).clamp(0.0, 1.0);
        let rise = target - before;
        sum[0] += rise * s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)));
        sum[1] += rise / duration * 140.0 * s.powi(3) * (1.0 - s).powi(3);
        sum[2] += rise / duration.powi(2) * 420.0 * s.powi(2) * (1.0 - s).powi(2) * (1.0 - 2.0 * s);
        before = target;
    }
    sum
}

/// Writes description and recording of so many seconds into a folder.
///
/// The motion is prescribed, as stiff loops would make it, and the torques are those that it takes.
pub fn record(folder: &Path, hidden: &Hidden, seconds: f64, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let homes = [0.4, 0.7];
    let moves = homes.map(|home| {
        let (mut moves, mut at) = (Vec::new(), 0.3);
        while at < seconds - 2.0 {
            let duration = random.random_range(0.8..1.8);
            moves.push((at, duration, home + random.random_range(-0.9..0.9)));
            at += duration + random.random_range(0.05..0.4);
        }
        moves
    });
    let mut rows = String::from("t,q1,q2,tau1,tau2\n");
    for k in 0..(seconds * RATE) as usize {
        let t = k as f64 / RATE;
        let own = [0, 1].map(|joint| motion(t, &moves[joint], homes[joint]));
        let of = |order: usize| own.map(|state| state[order]);
        let (q, v, a) = (of(0), of(1), of(2));
        let (matrix, bias) = equations(q, v, hidden);
        let mut noise = |std: f64| std * random.sample::<f64, _>(StandardNormal);
        let torque = [0, 1].map(|j| {
            let friction = hidden.friction[j] * if v[j] == 0.0 { 0.0 } else { v[j].signum() };
            matrix[j][0] * a[0] + matrix[j][1] * a[1] + bias[j] + friction + noise(NOISE.1[j])
        });
        let seen = q.map(|q| q + noise(NOISE.0));
        writeln!(
            rows,
            "{t},{},{},{},{}",
            seen[0], seen[1], torque[0], torque[1]
        )
        .unwrap();
    }
    let mut manifest = String::from("name = \"two links\"\n");
    for (joint, index) in [("shoulder", 1), ("elbow", 2)] {
        for (role, column, unit) in [("motor_position", "q", "rad"), ("torque", "tau", "N.m")] {
            write!(
                manifest,
                "[[channel]]\nrole = \"{role}\"\njoint = \"{joint}\"\nfile = \"arm.csv\"\ntime = \"t\"\n\
                 column = \"{column}{index}\"\nunit = \"{unit}\"\n"
            )
            .unwrap();
        }
    }
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("arm.csv"), rows).unwrap();
    std::fs::write(folder.join("recording.toml"), manifest).unwrap();
    std::fs::write(folder.join("two.urdf"), urdf()).unwrap();
}
