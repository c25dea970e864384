//! A recording that is written while it is made, as an MCAP file in the profile of ROS 2.

use super::cdr::Encoder;
use super::message::{self, Definition, FLOAT, FLOATS, JointState};
use super::prefix::Prefix;
use super::topic;
use crate::error::{Problem, RecordingError};
use crate::{Role, Sink};
use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{Compression, McapError, WriteOptions, Writer};
use std::collections::{BTreeMap, HashMap};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Bytes after which a chunk is closed: 0.1 s of three sensors at 1 kHz.
const CHUNK: usize = 1 << 16;
/// Time after which a chunk is closed although it is small, ns: what a crash may cost.
const SPAN: i64 = 250_000_000;
/// The last stamp of ROS 2, ns: its seconds have 32 bits with a sign.
const LAST: i64 = i32::MAX as i64 * 1_000_000_000 + 999_999_999;

/// Writes commands, measurements and what is known of joints into an MCAP file that other tools of ROS 2 read, chunk by chunk: a file
/// that is cut in the middle lacks a quarter of a second.
///
/// Times are s, values SI. The recorder's clock counts from a wall time that stands in the file; the stamp of a
/// sample is of the sensor's own clock and may have any offset to it.
///
/// # Example
/// ```
/// use quell_recording::{McapWriter, Recording, Role};
/// let path = std::env::temp_dir().join("quell-doc.mcap");
/// let file = std::fs::File::create(&path)?;
/// let mut writer = McapWriter::on(Box::new(file), &path, &["joint_1"], 1_700_000_000_000_000_000)?;
/// for tick in 0..10 {
///     let t = f64::from(tick) / 1000.0;
///     writer.write_command(t, "joint_1", 0.5, 0.0, 0.0)?;
///     writer.write_sample(t, "joint_1", Role::MotorPosition, t, &[0.4])?;
/// }
/// writer.finish()?;
/// let recording = Recording::from_path(&path)?;
/// assert_eq!(recording.channel(Role::MotorPosition).unwrap().time[9], 0.009);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct McapWriter {
    path: PathBuf,
    out: Writer<NoSeek<BufWriter<Prefix>>>,
    /// Wall time of the recorder's zero, ns since 1970.
    origin: i64,
    joints: Vec<String>,
    /// Identifier and messages written, by topic.
    channels: HashMap<String, (u16, u32)>,
    body: Encoder,
    /// Bytes in the chunk that is open, and the recorder's time of its first message, ns.
    chunk: (usize, i64),
}

impl McapWriter {
    /// Begins a file that is open, the zero of all times at a wall time in ns since 1970; `path` stands in
    /// errors.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn on(
        file: Sink,
        path: &Path,
        joints: &[&str],
        origin: i64,
    ) -> Result<Self, RecordingError> {
        // Nothing is written twice, so that the file on the disk ends with a whole chunk at all times.
        let out = options()
            .chunk_size(None)
            .create(NoSeek::new(BufWriter::new(Prefix::of(file))));
        Ok(Self {
            out: out.map_err(|error| refused(path, error))?,
            path: path.into(),
            origin,
            joints: joints.iter().map(|&name| name.into()).collect(),
            channels: HashMap::new(),
            body: Encoder::new(),
            chunk: (0, 0),
        })
    }

    /// Writes a setpoint that was sent at `time` of the recorder's clock.
    ///
    /// # Errors
    /// [`RecordingError`] where the joint is none of this file, a value is not finite, or the disk refuses.
    pub fn write_command(
        &mut self,
        time: f64,
        joint: &str,
        position: f64,
        velocity: f64,
        acceleration: f64,
    ) -> Result<(), RecordingError> {
        let role = Role::CommandPosition;
        let name = role.name();
        self.check(joint, name, &[time, position, velocity, acceleration])?;
        let now = self.wall(name, time)?;
        let state = JointState {
            name: joint,
            position: &[position],
            velocity: &[velocity],
            effort: &[],
        };
        state.encode(now, &mut self.body);
        self.put(&topic::topic(joint, role), &message::JOINT_STATE, now, now)?;
        message::encode_float(acceleration, &mut self.body);
        let topic = topic::quantity(joint, topic::COMMAND_ACCELERATION);
        self.put(&topic, &FLOAT, now, now)
    }

    /// Writes what a sensor measured: `stamp` is of the sensor's clock, `time` is when the recorder had it.
    /// `values` has one value, or three for a vector.
    ///
    /// # Errors
    /// As [`Self::write_command`], and where the role does not take so many values.
    pub fn write_sample(
        &mut self,
        time: f64,
        joint: &str,
        role: Role,
        stamp: f64,
        values: &[f64],
    ) -> Result<(), RecordingError> {
        let name = role.name();
        self.check(joint, name, &[time, stamp])?;
        self.check(joint, name, values)?;
        if !role.entry().columns.contains(&values.len()) {
            return Err(self.bad(name, format!("it has {} values", values.len())));
        }
        let (now, stamp) = (self.wall(name, time)?, self.wall(name, stamp)?);
        let carrier = topic::carrier(role, values.len());
        match (values, carrier.fields[0]) {
            (&[x, y, z], _) => message::encode_vector(stamp, "", [x, y, z], &mut self.body),
            (&[value], "data") => {
                message::encode_float(value, &mut self.body);
            }
            (_, field) => {
                let of = |name| if field == name { values } else { &[] };
                let state = JointState {
                    name: joint,
                    position: of("position"),
                    velocity: of("velocity"),
                    effort: of("effort"),
                };
                state.encode(stamp, &mut self.body);
            }
        }
        let topic = topic::topic(joint, role);
        self.put(&topic, carrier.definition, now, stamp)
    }

    /// Writes numbers that were known of a joint from `time` of the recorder's clock on, as `/quell/<joint>/<name>`. Each dimension
    /// has a label and a size, the outermost first; the innermost stands side by side. A reader of recordings passes them over.
    ///
    /// # Errors
    /// As [`Self::write_command`], and where the dimensions are not those of the numbers.
    pub fn write_numbers(
        &mut self,
        time: f64,
        joint: &str,
        name: &'static str,
        dimensions: &[(&str, usize)],
        numbers: &[f64],
    ) -> Result<(), RecordingError> {
        self.check(joint, name, &[time])?;
        self.check(joint, name, numbers)?;
        let sizes: usize = dimensions.iter().map(|(_, size)| size).product();
        if sizes != numbers.len() {
            let reason = format!("{} numbers are not {dimensions:?}", numbers.len());
            return Err(self.bad(name, reason));
        }
        let now = self.wall(name, time)?;
        self.body.clear();
        self.body.float64_multi_array(dimensions, numbers);
        self.put(&topic::quantity(joint, name), &FLOATS, now, now)
    }

    /// Closes the chunk and hands it to the operating system: what is written so far survives a crash.
    ///
    /// # Errors
    /// [`RecordingError`] where the disk refuses.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        self.chunk = (0, 0);
        self.out.flush().map_err(|error| refused(&self.path, error))
    }

    /// Writes the index that lets other tools seek, and closes the file.
    ///
    /// # Errors
    /// [`RecordingError`] where the disk refuses.
    pub fn finish(mut self) -> Result<(), RecordingError> {
        let summary = self.out.finish();
        summary.map_err(|error| refused(&self.path, error))?;
        let flushed = self.out.into_inner().into_inner().flush();
        flushed.map_err(|error| RecordingError::io(&self.path, &error))
    }

    /// Writes the body as a message of a topic.
    fn put(
        &mut self,
        topic: &str,
        definition: &Definition,
        now: i64,
        stamp: i64,
    ) -> Result<(), RecordingError> {
        if !self.channels.contains_key(topic) {
            let id = self.channel(topic, definition);
            let id = id.map_err(|error| refused(&self.path, error))?;
            self.channels.insert(topic.into(), (id, 0));
        }
        let Some((channel_id, sequence)) = self.channels.get_mut(topic) else {
            return Ok(());
        };
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: now.unsigned_abs(),
            publish_time: stamp.unsigned_abs(),
        };
        *sequence = sequence.wrapping_add(1);
        let body = self.body.bytes();
        let written = self.out.write_to_known_channel(&header, body);
        written.map_err(|error| refused(&self.path, error))?;
        let (bytes, since) = self.chunk;
        let since = if bytes == 0 { now } else { since };
        self.chunk = (bytes + body.len(), since);
        if self.chunk.0 >= CHUNK || now - since >= SPAN {
            self.flush()?;
        }
        Ok(())
    }

    fn channel(&mut self, topic: &str, definition: &Definition) -> Result<u16, McapError> {
        let text = definition.text.as_bytes();
        let schema = self.out.add_schema(definition.name, "ros2msg", text)?;
        self.out.add_channel(schema, topic, "cdr", &BTreeMap::new())
    }

    /// A time in s as wall time in ns, rounded to the nearest.
    fn wall(&self, role: &'static str, time: f64) -> Result<i64, RecordingError> {
        let wall = self.origin.saturating_add((time * 1e9).round() as i64);
        match (0..=LAST).contains(&wall) {
            true => Ok(wall),
            false => Err(self.bad(
                role,
                format!("{time} s is outside of the years 1970 to 2038, which a stamp can hold"),
            )),
        }
    }

    fn check(&self, joint: &str, role: &'static str, values: &[f64]) -> Result<(), RecordingError> {
        if !self.joints.iter().any(|known| known == joint) {
            let reason = format!("the file is not made for a joint \"{joint}\"");
            return Err(self.bad(role, reason));
        }
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.bad(role, format!("{value} is not a finite number"))),
            None => Ok(()),
        }
    }

    fn bad(&self, role: &'static str, reason: String) -> RecordingError {
        Problem::Channel { role, reason }.in_file(&self.path)
    }
}

/// How files are written: without seeking, and by one thread, since a chunk is compressed in less time than
/// a pool of threads takes to begin.
pub(super) fn options() -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(concat!("quell ", env!("CARGO_PKG_VERSION")))
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .disable_seeking(true)
        .chunk_size(Some(CHUNK as u64))
}

pub(super) fn refused(path: &Path, error: McapError) -> RecordingError {
    match error {
        McapError::Io(error) => RecordingError::io(path, &error),
        error => Problem::Io(error.to_string()).in_file(path),
    }
}
