//! A recording from an MCAP file alone: Quell's own topics determine the roles.

use super::file::{McapFile, Topic};
use super::topic::{JOINT_STATES, carrier, joint_and_role};
use crate::error::{Place, Problem, RecordingError};
use crate::{Channel, ROLES, Recording, Role, Unit};

/// Place of a role of a joint in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// The role.
    pub role: Role,
    /// The topic.
    pub topic: String,
    /// The fields of its messages, one for each column.
    pub fields: Vec<String>,
    /// The source of its stamps, if it is not the default.
    time: Option<&'static str>,
}

impl McapFile {
    /// The joints of the file: those with topics of their own, else the names in the joint states.
    pub fn joints(&self) -> Vec<String> {
        let own = self
            .topics()
            .iter()
            .filter_map(|topic| joint_and_role(&topic.name));
        let mut joints: Vec<String> = own.map(|(joint, _)| joint.into()).collect();
        if joints.is_empty() {
            let states = self
                .topics()
                .iter()
                .filter(|topic| topic.name == JOINT_STATES);
            joints = states.flat_map(|topic| topic.names.clone()).collect();
        }
        joints.sort();
        joints.dedup();
        joints
    }

    /// The roles of a joint, from the names and types of the topics, in the order of [`ROLES`].
    pub fn roles(&self, joint: &str) -> Vec<Found> {
        let of = |role| {
            self.topics()
                .iter()
                .filter_map(move |topic| found(topic, joint, role))
        };
        ROLES.iter().flat_map(|entry| of(entry.role)).collect()
    }

    /// The recording of a joint, which need not be named if there is only one.
    ///
    /// Values are SI in the role's usual unit; times are s since the first log time of the file.
    ///
    /// # Errors
    /// [`RecordingError`] where there is no such joint, or several, or a message cannot be read.
    pub fn recording(&self, joint: Option<&str>) -> Result<Recording, RecordingError> {
        let joint = self.joint(joint).map_err(|p| p.in_file(self.path()))?;
        let mut channels = Vec::new();
        for Found {
            role,
            topic,
            fields,
            time,
        } in self.roles(&joint)
        {
            let fields: Vec<&str> = fields.iter().map(String::as_str).collect();
            let series = self.series(&topic, &fields, time)?;
            if series.stamps.is_empty() {
                continue;
            }
            let (time, columns) = series.since(&topic, self.zero());
            channels.push(Channel {
                role,
                unit: usual_unit(role),
                time,
                columns,
            });
        }
        if channels.is_empty() {
            let problem = Problem::Mcap(format!("there are no messages of the joint \"{joint}\""));
            return Err(problem.in_file(self.path()));
        }
        let name = self.path().file_stem().unwrap_or_default();
        Ok(Recording {
            name: name.to_string_lossy().into(),
            payload: None,
            channels,
        })
    }

    /// Stamps, s since the first log time of the file, and numbers of fields of a topic. `time` is `log_time`,
    /// `publish_time` or a field with a stamp; by default `header.stamp`, where there is one, else `log_time`.
    ///
    /// # Errors
    /// [`RecordingError`] with topic and field where these are missing, or a number is not finite.
    pub fn numbers(
        &self,
        topic: &str,
        fields: &[&str],
        time: Option<&str>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), RecordingError> {
        let series = self.series(topic, fields, time)?;
        if series.stamps.is_empty() {
            return Err(self.none_has(topic, fields));
        }
        Ok(series.since(topic, self.zero()))
    }

    /// The error for a field that no message has, with the available names.
    fn none_has(&self, topic: &str, fields: &[&str]) -> RecordingError {
        let entry = self.topics().iter().find(|entry| entry.name == topic);
        let names = entry.map_or(String::new(), |entry| entry.names.join(", "));
        let reason = match (entry.map_or(0, |entry| entry.messages), names.is_empty()) {
            (0, _) => "the topic has no messages".into(),
            (count, true) => format!("none of {count} messages has it"),
            (_, false) => format!("no message has it; the names are: {names}"),
        };
        let place = Place {
            file: self.path().into(),
            topic: Some(topic.into()),
            field: Some(fields.join(", ")),
            ..Place::default()
        };
        let problem = Problem::Mcap(reason);
        RecordingError { place, problem }
    }

    /// The first log time of the file, ns.
    fn zero(&self) -> i64 {
        let logged = self.topics().iter().filter_map(|topic| topic.logged);
        let first = logged.map(|[first, _]| first).min().unwrap_or(0);
        i64::try_from(first).unwrap_or(i64::MAX)
    }

    fn joint(&self, asked: Option<&str>) -> Result<String, Problem> {
        let joints = self.joints();
        let list = || joints.join(", ");
        match (asked, &*joints) {
            (_, []) => Err(Problem::NoJoints),
            (None, [one]) => Ok(one.clone()),
            (None, _) => Err(Problem::Mcap(format!(
                "it has several joints: {}; name one behind the file, as in {}#{}",
                list(),
                self.path().display(),
                joints[0]
            ))),
            (Some(joint), _) if joints.iter().any(|known| known == joint) => Ok(joint.into()),
            (Some(joint), _) => Err(Problem::Mcap(format!(
                "there is no joint \"{joint}\"; the joints are: {}",
                list()
            ))),
        }
    }
}

/// The fields of a topic that have this role of a joint.
fn found(topic: &Topic, joint: &str, role: Role) -> Option<Found> {
    let is_shared = topic.name == JOINT_STATES && role == Role::MotorPosition;
    if !is_shared && joint_and_role(&topic.name) != Some((joint, role)) {
        return None;
    }
    let carriers = role
        .entry()
        .columns
        .iter()
        .map(|columns| carrier(role, *columns));
    let carrier = { carriers }.find(|carrier| carrier.definition.name == topic.kind)?;
    let is_many = |field: &&str| ["position", "velocity", "effort"].contains(field);
    let named = |field: &&str| match is_many(field) {
        true => format!("{field}[{joint}]"),
        false => (*field).into(),
    };
    Some(Found {
        role,
        topic: topic.name.clone(),
        fields: carrier.fields.iter().map(named).collect(),
        time: (carrier.fields == ["data"]).then_some("publish_time"),
    })
}

/// The SI unit of a role's usual quantity.
fn usual_unit(role: Role) -> String {
    let dimension = role.entry().dimensions[0];
    let unit = crate::UNITS
        .iter()
        .find(|unit: &&Unit| unit.dimension == dimension);
    unit.map_or_else(String::new, |unit| unit.si.into())
}
