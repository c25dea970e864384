//! The channels `known_force` and `inertia` of each joint of a robot.

use super::contradiction::torque;
use super::coupling::Coupling;
use super::robot::{Joint, Robot};
use quell_recording::{Channel, Recording, Role};

/// A joint with what is known beside it.
#[derive(Clone, Debug)]
pub struct Beside {
    /// Its name.
    pub joint: String,
    /// Its channels, `known_force` and `inertia` among them.
    pub recording: Recording,
    /// For `inverse_dynamics`: the smoothed position, and the torque while the joint moves; none where no torque was measured.
    pub inverse: Option<Recording>,
    /// The mean of the inertia along the motion, kg.m^2 or kg.
    pub inertia: f64,
}

/// What the description says of each recorded joint along the motion:
/// `known_force = M_jj q_j'' - tau_j(q, q', q'') - coupling`, gravity, Coriolis and centrifugal forces and the accelerations of
/// the other joints; `inertia = M_jj(q)`. A joint's own inertia of 0 (nothing has a mass behind it) has no such channel.
pub fn beside(robot: &Robot, couplings: &[Coupling]) -> Vec<Beside> {
    robot
        .joints
        .iter()
        .map(|joint| of(robot, joint, couplings))
        .collect()
}

fn of(robot: &Robot, joint: &Joint, couplings: &[Coupling]) -> Beside {
    let own = joint.index;
    let time = robot.course(own).time.clone();
    let (mut force, mut inertia) = (Vec::new(), Vec::new());
    for &stamp in &time {
        let [q, rate, mut acceleration] = robot.state(stamp);
        // What the others do: the joint's own acceleration is the equation's.
        acceleration[own] = 0.0;
        let torque = robot.dynamics.torques(&q, &rate, &acceleration)[own];
        let coupled = couplings.iter().filter(|coupling| coupling.joint == own);
        let coupled: f64 = coupled.map(|coupling| coupling.torque(robot, stamp)).sum();
        force.push(-torque - coupled);
        inertia.push(robot.dynamics.inertias(&q)[own]);
    }
    let mean = inertia.iter().sum::<f64>() / inertia.len() as f64;
    let unit = robot.unit(own);
    let channel = |role, unit: &str, values| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![values],
    };
    let mut recording = joint.recording.clone();
    recording.name = format!("{}#{}", recording.name, joint.name);
    recording
        .channels
        .push(channel(Role::KnownForce, unit, force));
    if inertia.iter().all(|value| *value > 0.0) {
        let unit = if unit == "N" { "kg" } else { "kg.m^2" };
        recording
            .channels
            .push(channel(Role::Inertia, unit, inertia));
    }
    Beside {
        inverse: inverse(robot, joint, &recording),
        joint: joint.name.clone(),
        recording,
        inertia: mean,
    }
}

/// At rest friction holds whatever it can bear: what the torque is there nobody knows.
fn inverse(robot: &Robot, joint: &Joint, known: &Recording) -> Option<Recording> {
    let (torque, course) = (torque(robot, joint)?, robot.course(joint.index));
    let samples = torque.time.iter().zip(&torque.columns[0]);
    let moving = samples.filter(|(time, _)| course.moves(**time));
    let (time, values): (Vec<f64>, Vec<f64>) = moving.unzip();
    let position = Channel {
        role: Role::MotorPosition,
        unit: if robot.unit(joint.index) == "N" {
            "m"
        } else {
            "rad"
        }
        .into(),
        time: course.time.clone(),
        columns: vec![course.state.iter().map(|state| state[0]).collect()],
    };
    let measured = Channel {
        time,
        columns: vec![values],
        ..torque.clone()
    };
    let beside = known.channels.iter();
    let beside = beside.filter(|own| matches!(own.role, Role::KnownForce | Role::Inertia));
    Some(Recording {
        channels: [position, measured]
            .into_iter()
            .chain(beside.cloned())
            .collect(),
        ..known.clone()
    })
}
