#![doc = include_str!("../README.md")]
//!
//! # The manifest
//! ```toml
//! name = "arm 7"
//! payload = "2 kg"          # optional: what the arm carries; recordings of one axis may differ in it
//! rows = [0, 8000]          # optional: only rows 0 to 7999 below the header, at their own stamps
//! [[channel]]
//! role = "motor_position"   # a name of the table of roles
//! file = "encoder.csv.gz"   # beside the manifest; .csv or .csv.gz
//! time = "time_s"           # the column with seconds, or rate_hz = 500
//! column = "joint_1_rad"    # or columns = ["x_m", "y_m", "z_m"] for a vector
//! unit = "rad"              # a name of the table of units
//! scale = 1.0               # optional: value in `unit` = cell * scale + offset
//! offset = 0.0
//! # rows = [0, 4000]        # optional: instead of the recording's, where files differ in rate
//! ```
//!
//! Of an MCAP file a channel names a topic and a field of its messages; the file says how they are laid out:
//!
//! ```toml
//! [[channel]]
//! role = "motor_position"
//! file = "run.mcap"
//! topic = "/joint_states"
//! field = "position[shoulder]"  # or position[0]; fields = ["point.x", "point.y", "point.z"] for a vector
//! unit = "rad"
//! # time = "log_time"           # optional: or "publish_time", or a field; else header.stamp where there is one
//! ```
//!
//! `rows` lets parts of one file be recordings of their own, one to fit and one to be judged by. A
//! unit need not be one that the role usually has: the force of an analogue circuit may be in `V`,
//! and a quantity of unknown scale in `raw`. It is kept, and remarked upon.

mod carries;
mod dates;
mod durations;
mod error;
mod even;
mod exactly;
mod foreign;
pub mod health;
mod layout;
mod manifest;
mod mcap;
mod memory;
mod mistakes;
mod preferred;
#[cfg(test)]
mod properties;
mod propose;
mod resolution;
mod role;
mod sink;
mod stamp;
mod stamp_wraps;
mod syntax;
mod table;
mod toml_keys;
mod unit;
mod wraps;
mod write;

pub use carries::{plain, range};
pub use error::{Place, Problem, RecordingError, nearest};
pub use even::are_even;
pub use exactly::exactly;
pub use foreign::{FOREIGN, Foreign};
pub use layout::Layout;
pub use mcap::{Cut, Damage, Decoder, Encoder, Found, McapFile, McapWriter, Mended, Topic};
pub use preferred::Preferred;
pub use propose::{GUESSED, NO_RATE, Proposal, Proposed, is_csv, propose};
pub use resolution::{to_nanosecond, to_resolution, to_scale};
pub use role::{ROLES, Role, RoleEntry};
pub use sink::Sink;
pub use stamp::{Origin, TIME_UNITS, TimeUnit};
pub use syntax::{SyntaxError, one_of};
pub use table::Table;
pub use toml_keys::toml_line;
pub use unit::{Dimension, UNITS, Unit};
pub use wraps::Wrap;

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// The manifest's name in a folder of its own.
pub const MANIFEST: &str = "recording.toml";

/// One measured quantity on its own clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The role.
    pub role: Role,
    /// SI unit of `columns`; not always one that is usual for the role (see
    /// [`Channel::has_usual_unit`]).
    pub unit: String,
    /// Stamps, s, strictly increasing; length n.
    pub time: Vec<f64>,
    /// One column for a scalar, three for a vector; each of length n.
    pub columns: Vec<Vec<f64>>,
}

/// What the columns of a role's vector are called: of two the axes in the names of the file's columns, if it has a manifest or
/// is a CSV file that tells them; else as by [`axis_name`].
pub fn axis_names(path: &Path, role: Role, columns: usize) -> Vec<&'static str> {
    let names = || manifest::columns(&file_and_joint(path).0, role);
    let told = match columns {
        2 => names().and_then(|names| propose::axes(&names)),
        _ => None,
    };
    let plain = (0..columns).filter_map(|index| axis_name(columns, index));
    told.unwrap_or_else(|| plain.collect())
}

/// What a column of a vector is called: `x`, `y` or `z` of three; of two nobody has said which of the axes they are, so that
/// they are `column 1` and `column 2`.
pub fn axis_name(columns: usize, index: usize) -> Option<&'static str> {
    let names: &[&'static str] = match columns {
        3 => &["x", "y", "z"],
        _ => &["column 1", "column 2"],
    };
    names.get(index).copied().filter(|_| index < columns)
}

/// Channels of one run of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name given in the manifest.
    pub name: String,
    /// The payload of the axis, as the manifest calls it; where it differs between recordings of one axis,
    /// so does the inertia of the link.
    pub payload: Option<String>,
    /// Channels in the manifest's order.
    pub channels: Vec<Channel>,
}

impl Recording {
    /// Reads a recording: a manifest, a folder that has a `recording.toml`, an MCAP file with Quell's own
    /// topics, or a CSV file that can only mean one thing. Of several joints `run.mcap#joint_2`, `folder#joint_2` takes one.
    ///
    /// Values are converted to SI. File names in the manifest are relative to its folder.
    ///
    /// # Errors
    /// [`RecordingError`] with file, line and column, or file, byte, topic and field.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let (file, joint) = mcap_and_joint(path.as_ref());
        match McapFile::is_named(&file) {
            true => McapFile::open(&file)?.recording(joint.as_deref()),
            false => {
                let (file, joint) = file_and_joint(&file);
                manifest::read(&file, joint.as_deref())
            }
        }
    }

    /// Reads the recordings of all joints of a robot, each with its name: those that a manifest's channels name, or an
    /// MCAP file's topics. None where no joint is named.
    ///
    /// # Errors
    /// As [`Recording::from_path`].
    pub fn joints(path: impl AsRef<Path>) -> Result<Vec<(String, Self)>, RecordingError> {
        let path = path.as_ref();
        if !McapFile::is_named(path) {
            return manifest::read_joints(path);
        }
        let file = McapFile::open(path)?;
        let of = |joint: String| Ok((joint.clone(), file.recording(Some(&joint))?));
        file.joints().into_iter().map(of).collect()
    }

    /// Writes the recording into a folder, as `recording.toml` and one CSV file a channel,
    /// gzipped where `compress` says so. [`Recording::from_path`] reads the same values back, to
    /// the bit.
    ///
    /// # Errors
    /// [`RecordingError`] where a channel would not be read back, or a file cannot be written.
    pub fn write(&self, folder: impl AsRef<Path>, compress: bool) -> Result<(), RecordingError> {
        let folder = folder.as_ref();
        write::checked(self, folder)?;
        std::fs::create_dir_all(folder).map_err(|error| RecordingError::io(folder, &error))?;
        write::write(self, folder, compress, &mut |path| {
            Ok(Box::new(std::fs::File::create(path)?))
        })
    }

    /// As [`Recording::write`], into a folder that is there and into files that `create` gives.
    ///
    /// # Errors
    /// As [`Recording::write`].
    pub fn write_by(
        &self,
        folder: &Path,
        compress: bool,
        mut create: impl FnMut(&Path) -> std::io::Result<Sink>,
    ) -> Result<(), RecordingError> {
        write::checked(self, folder)?;
        write::write(self, folder, compress, &mut create)
    }

    /// The first channel with this role.
    pub fn channel(&self, role: Role) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.role == role)
    }

    /// The recording before an instant, and from it on.
    ///
    /// # Example
    /// ```
    /// use quell_recording::{Channel, Recording, Role};
    /// let (role, unit, time) = (Role::Torque, "N.m".into(), vec![0.0, 0.1, 0.2]);
    /// let channel = Channel { role, unit, time, columns: vec![vec![1.0, 2.0, 3.0]] };
    /// let whole = Recording { name: "torque".into(), channels: vec![channel], payload: None };
    /// let (before, after) = whole.at(0.1);
    /// assert_eq!(before.channels[0].columns, [[1.0]]);
    /// assert_eq!(after.channels[0].columns, [[2.0, 3.0]]);
    /// ```
    pub fn at(&self, instant: f64) -> (Self, Self) {
        let part = |after: bool| Self {
            payload: self.payload.clone(),
            name: self.name.clone(),
            channels: self.channels.iter().map(|c| c.at(instant, after)).collect(),
        };
        (part(false), part(true))
    }

    /// The recording from the first of two instants on, before the second. The rest is not copied.
    pub fn within(&self, span: [f64; 2]) -> Self {
        Self {
            payload: self.payload.clone(),
            name: self.name.clone(),
            channels: self.channels.iter().map(|c| c.within(span)).collect(),
        }
    }
}

/// The MCAP file and the joint of `run.mcap#joint_2`; any other path is left as it is.
pub fn mcap_and_joint(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    match text.rsplit_once(".mcap#") {
        Some((stem, joint)) if !path.exists() => {
            (format!("{stem}.mcap").into(), Some(joint.into()))
        }
        _ => (path.into(), None),
    }
}

/// A manifest or its folder, and the joint of `folder#joint_2`; a path that is there is left as it is.
fn file_and_joint(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    match text.rsplit_once('#') {
        Some((file, joint)) if !path.exists() && Path::new(file).exists() => {
            (file.into(), Some(joint.into()))
        }
        _ => (path.into(), None),
    }
}

impl Channel {
    /// The samples before an instant, or from it on.
    fn at(&self, instant: f64, after: bool) -> Self {
        match after {
            true => self.within([instant, f64::INFINITY]),
            false => self.within([f64::NEG_INFINITY, instant]),
        }
    }

    /// The samples from the first of two instants on, before the second.
    fn within(&self, [from, to]: [f64; 2]) -> Self {
        let before = |instant: f64| self.time.partition_point(|t| *t < instant);
        let range = before(from)..before(to).max(before(from));
        let part = |column: &Vec<f64>| column[range.clone()].to_vec();
        Self {
            role: self.role,
            unit: self.unit.clone(),
            time: part(&self.time),
            columns: self.columns.iter().map(part).collect(),
        }
    }

    /// Takes out the jumps by a turn that an angle makes where its sensor wraps: after it, no two
    /// neighbours are further apart than half a turn.
    ///
    /// Does nothing to a channel that is no angle, or that moves by a twentieth of a turn between
    /// samples at the median (see [`health::wraps`]).
    ///
    /// # Example
    /// ```
    /// use quell_recording::{Channel, Role};
    /// use std::f64::consts::{PI, TAU};
    /// let angle = vec![PI - 0.3, PI - 0.2, PI - 0.1, PI - TAU, PI + 0.1 - TAU];
    /// let time = vec![0.0, 1.0, 2.0, 3.0, 4.0];
    /// let (role, unit) = (Role::MotorPosition, "rad".into());
    /// let mut channel = Channel { role, unit, time, columns: vec![angle] };
    /// channel.unwrap_turns();
    /// assert!((channel.columns[0][4] - (PI + 0.1)).abs() < 1e-14);
    /// ```
    pub fn unwrap_turns(&mut self) {
        if self.unit != "rad" {
            return;
        }
        for column in &mut self.columns {
            let wraps = health::wraps(column);
            let (mut turns, mut next) = (0.0, 0);
            for sample in 1..column.len() {
                if wraps.get(next) == Some(&sample) {
                    // The sample before has its turns added already.
                    let jump = column[sample] + turns - column[sample - 1];
                    turns -= TAU * (jump / TAU).round();
                    next += 1;
                }
                column[sample] += turns;
            }
        }
    }

    /// Whether the unit is one that channels of this role usually have; a force in volts is not.
    pub fn has_usual_unit(&self) -> bool {
        Unit::from_name(&self.unit)
            .is_some_and(|unit| self.role.entry().dimensions.contains(&unit.dimension))
    }
}
