//! One recording of a robot, ready to be diagnosed joint by joint.

use crate::cli::CliError;
use crate::model::Model;
use crate::recording::{Recording, Role, plain};
use crate::rigid_body::{
    Beside, Cause, Coupling, Dynamics, Payload, Robot, RobotError, beside, couplings, payload,
    rotor,
};
use crate::signal::{JointKind, Tree};
use nalgebra::Vector3;
use std::path::Path;

/// Least inertia of a rotor, as a share of the links' inertia, if the torques show none, or less than none:
/// negligibly small.
const LEAST: f64 = 1e-3;

/// A recording, and the comparison of its torques with the description.
pub(super) struct Prepared {
    pub name: String,
    pub robot: Robot,
    /// The description with the payload.
    dynamics: Dynamics,
    pub payload: Option<Payload>,
    pub couplings: Vec<Coupling>,
    beside: Vec<Beside>,
}

impl Prepared {
    pub fn read(tree: &Tree, gravity: Vector3<f64>, path: &Path) -> Result<Self, CliError> {
        let joints = Recording::joints(path)?;
        let Some(name) = joints.first().map(|(_, recording)| recording.name.clone()) else {
            let recording = path.display().to_string();
            return Err(CliError::input(RobotError::NoJoint { recording }));
        };
        let robot = Robot::new(Dynamics::new(tree, gravity), joints).map_err(CliError::input)?;
        let payload = payload(&robot);
        let mut loaded = robot.clone();
        if let Some(payload) = &payload {
            loaded.dynamics = robot.dynamics.with(payload.body());
        }
        let couplings = couplings(&robot, &loaded.dynamics);
        Ok(Self {
            name,
            beside: beside(&loaded, &couplings),
            dynamics: loaded.dynamics,
            robot,
            payload,
            couplings,
        })
    }

    /// A joint with the known quantities beside it.
    pub fn beside(&self, joint: &str) -> Option<&Beside> {
        self.beside.iter().find(|own| own.joint == joint)
    }

    /// The recording that a model of a joint is compared with.
    pub fn recording(&self, joint: &str, model: &Model) -> Option<Recording> {
        let own = self.beside(joint)?;
        let kind = model.kind;
        let predicts_torque = kind.outputs.contains(&Role::Torque);
        match &own.inverse {
            Some(inverse) if predicts_torque && kind.inputs.contains(&Role::MotorPosition) => {
                Some(inverse.clone())
            }
            _ => Some(own.recording.clone()),
        }
    }

    /// A rigid axis with the friction of the description; if its torque tells none, the reason in words.
    pub fn believed(&self, joint: &str) -> Result<Model, String> {
        let absent = || "the recording does not have it".to_string();
        let mut joints = self.robot.joints.iter();
        let own = joints.find(|own| own.name == joint).ok_or_else(absent)?;
        let seen = self.beside(joint).ok_or_else(absent)?.inertia;
        let slope = rotor(&self.robot, &self.dynamics, own).map_err(|why| why.to_string())?;
        let [mass, std] = [slope, slope.abs()].map(|own| own.max(LEAST * seen));
        let described = &self.robot.dynamics.joints()[own.index];
        // The torque gives the rotor's inertia within a factor; the fit determines the rest.
        let mut text =
            format!("kind = \"inverse_dynamics\"\nmass = {{ value = {mass}, std = {std} }}\n");
        if described.damping > 0.0 {
            text += &format!("viscous = {}\n", described.damping);
        }
        if described.friction > 0.0 {
            text += &format!(
                "[[effect]]\nname = \"coulomb_friction\"\nplace = \"transmission\"\n[effect.parameters]\nfriction = {}\n",
                described.friction
            );
        }
        Model::from_toml(&text, joint).map_err(|error| error.to_string())
    }

    /// Remarks on the whole robot, from the recording against its description.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = self.payload.iter().map(|own| self.carries(own)).collect();
        remarks.extend(self.couplings.iter().map(|own| self.coupled(own)));
        let unseen = self.robot.unseen();
        if !unseen.is_empty() {
            let names = unseen.join(", ");
            remarks.push(format!(
                "\"{}\" does not have {names}: taken to stand at 0.",
                self.name
            ));
        }
        remarks
    }

    /// The remarks that concern this joint.
    pub fn remarks_of(&self, joint: &str) -> Vec<String> {
        let mut remarks: Vec<String> = self.payload.iter().map(|own| self.carries(own)).collect();
        let own = |coupling: &&Coupling| self.joint(coupling.joint) == joint;
        let couplings = self.couplings.iter().filter(own);
        remarks.extend(couplings.map(|own| self.coupled(own)));
        remarks
    }

    fn joint(&self, index: usize) -> &str {
        &self.robot.dynamics.joints()[index].name
    }

    fn carries(&self, own: &Payload) -> String {
        let [mass, lever] = [(own.mass.abs(), own.mass_std), (own.lever, own.lever_std)];
        let [mass, lever] = [(mass, "kg"), (lever, "m")]
            .map(|((value, std), unit)| format!("{} {unit} (± {})", rounded(value), rounded(std)));
        let more = if own.mass < 0.0 { "less" } else { "more" };
        format!(
            "The torques of \"{}\" contradict the description: the link behind {} carries {mass} {more}, {lever} from that \
             joint's axis. It was taken into account.",
            self.name,
            self.joint(own.joint),
        )
    }

    fn coupled(&self, own: &Coupling) -> String {
        let (cause, per) = match own.cause {
            Cause::Acceleration => ("the acceleration", ".s^2"),
            Cause::Velocity => ("the velocity", ".s"),
            Cause::Direction => ("the direction of motion", ""),
        };
        let other = match self.robot.dynamics.joints()[own.other].kind {
            _ if own.cause == Cause::Direction => "",
            JointKind::Revolute => "/rad",
            JointKind::Prismatic => "/m",
        };
        format!(
            "{} is coupled with {}, which the description does not have: a torque of {} {}{per}{other} ({} one standard \
             deviation) follows {cause} of {}. It was taken into account.",
            self.joint(own.joint),
            self.joint(own.other),
            rounded(own.size),
            self.robot.unit(own.joint),
            rounded(own.std),
            self.joint(own.other)
        )
    }
}

/// A number with three digits.
fn rounded(value: f64) -> String {
    plain(format!("{value:.2e}").parse().unwrap_or(value))
}
