//! A robot's description, and a recording of all its joints.

use super::dynamics::Dynamics;
use quell_recording::{Channel, Recording, Role, one_of};
use quell_signal::{Course, JointKind, SignalError};

/// Why a recording does not suit a description.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// The recording names no joint.
    #[error(
        "\"{recording}\" names no joint: give its channels a joint, the name in the robot's description"
    )]
    NoJoint {
        /// Name of the recording.
        recording: String,
    },
    /// A joint that the description does not have.
    #[error(
        "joint \"{joint}\" of \"{recording}\" is not in the robot's description: joint must be {rule}"
    )]
    NoSuchJoint {
        /// The joint.
        joint: String,
        /// Name of the recording.
        recording: String,
        /// The joints of the description, and what was perhaps meant.
        rule: String,
    },
    /// A joint without a position.
    #[error(
        "joint \"{joint}\" of \"{recording}\" has no position in {unit}: its motion moves all other joints"
    )]
    NoPosition {
        /// The joint.
        joint: String,
        /// Name of the recording.
        recording: String,
        /// The unit of its positions.
        unit: &'static str,
    },
    /// A joint whose positions are none.
    #[error("joint \"{joint}\": {source}")]
    Position {
        /// The joint.
        joint: String,
        /// What is wrong with them.
        source: SignalError,
    },
}

/// A recorded joint of a robot.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Its place in the description, counted from 0.
    pub index: usize,
    /// Its channels, angles unwrapped.
    pub recording: Recording,
}

/// A robot in motion.
#[derive(Clone, Debug)]
pub struct Robot {
    /// What its description says.
    pub dynamics: Dynamics,
    /// The recorded joints, in the description's order.
    pub joints: Vec<Joint>,
    /// The motion of every joint of the description.
    courses: Vec<Course>,
}

/// Where a joint is seen, in the order of preference: the link itself first.
const POSITIONS: [Role; 3] = [
    Role::LinkPosition,
    Role::MotorPosition,
    Role::CommandPosition,
];

impl Robot {
    /// A description and the recordings of its joints, by name. A joint that was not recorded stands at 0.
    ///
    /// # Errors
    /// [`RobotError`] with the joint.
    pub fn new(
        dynamics: Dynamics,
        recordings: Vec<(String, Recording)>,
    ) -> Result<Self, RobotError> {
        let mut courses = vec![Course::still(0.0); dynamics.joints().len()];
        let mut joints = Vec::new();
        for (name, mut recording) in recordings {
            recording
                .channels
                .iter_mut()
                .for_each(Channel::unwrap_turns);
            let index = index(&dynamics, &name, &recording.name)?;
            courses[index] = course(&recording, &name, dynamics.joints()[index].kind)?;
            joints.push(Joint {
                name,
                index,
                recording,
            });
        }
        joints.sort_by_key(|joint| joint.index);
        Ok(Self {
            dynamics,
            joints,
            courses,
        })
    }

    /// Names of the joints that were not recorded.
    pub fn unseen(&self) -> Vec<&str> {
        let all = self.dynamics.joints().iter().enumerate();
        let recorded = |index: usize| self.joints.iter().any(|joint| joint.index == index);
        let unseen = all.filter(|(index, _)| !recorded(*index));
        unseen.map(|(_, joint)| joint.name.as_str()).collect()
    }

    /// The motion of a joint of the description.
    pub fn course(&self, index: usize) -> &Course {
        &self.courses[index]
    }

    /// Positions, velocities and accelerations of all joints at an instant.
    pub fn state(&self, time: f64) -> [Vec<f64>; 3] {
        let all: Vec<[f64; 3]> = self.courses.iter().map(|course| course.at(time)).collect();
        [0, 1, 2].map(|order| all.iter().map(|own| own[order]).collect())
    }

    /// The unit of a joint's torques.
    pub fn unit(&self, index: usize) -> &'static str {
        match self.dynamics.joints()[index].kind {
            JointKind::Revolute => "N.m",
            JointKind::Prismatic => "N",
        }
    }
}

fn index(dynamics: &Dynamics, name: &str, recording: &str) -> Result<usize, RobotError> {
    let names = dynamics.joints().iter().map(|joint| joint.name.as_str());
    let found = names.clone().position(|own| own == name);
    found.ok_or_else(|| RobotError::NoSuchJoint {
        joint: name.into(),
        recording: recording.into(),
        rule: one_of(name, names),
    })
}

fn course(recording: &Recording, name: &str, kind: JointKind) -> Result<Course, RobotError> {
    let unit = match kind {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    };
    let mut roles = POSITIONS.iter();
    let channel = roles.find_map(|role| {
        let channel = recording.channel(*role)?;
        (channel.unit == unit).then_some(channel)
    });
    let channel = channel.ok_or_else(|| RobotError::NoPosition {
        joint: name.into(),
        recording: recording.name.clone(),
        unit,
    })?;
    Course::of(channel).map_err(|source| RobotError::Position {
        joint: name.into(),
        source,
    })
}
