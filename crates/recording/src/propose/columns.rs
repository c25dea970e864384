//! Proposed channels for the columns of a file.

use super::super::role::Role;
use super::super::unit::Dimension;
use super::Guess;
use super::clock::Clock;
use super::content::{Column, Content};
use super::{joint, name, tool};
use crate::Wrap;

/// Standard acceleration of free fall, m/s^2.
const G_N: f64 = 9.80665;
/// Largest relative difference of an accelerometer's mean at rest from that: its offset, and the tilt of the
/// other axes.
const OFFSET: f64 = 0.05;
/// Most columns that are asked for, and most letters of a cell that are shown.
pub const MOST_ASKED: usize = 12;
const LONGEST: usize = 24;

/// A proposed channel.
pub struct Channel {
    /// Its role.
    pub role: Guess<Role>,
    /// Its joint, if the file has several.
    pub joint: Option<String>,
    /// Its columns, by their index in the file.
    pub columns: Vec<usize>,
    /// Its unit.
    pub unit: Guess<String>,
    /// The counter whose readings it has, if it begins again.
    pub wrap: Option<Wrap>,
}

/// Proposed channels of a file.
#[derive(Default)]
pub struct Channels {
    /// The channels.
    pub found: Vec<Channel>,
    /// Columns that are not used.
    pub unused: Vec<usize>,
    /// Open questions.
    pub open: Vec<String>,
}

/// The channels of a file, without the columns of its clock and its tests.
pub fn of(content: &Content, clock: &Clock, tests: Option<usize>) -> Channels {
    let mut channels = Channels::default();
    let roles: Vec<_> = (0..content.columns.len())
        .map(|index| role(content, index))
        .collect();
    let only: Vec<_> = roles
        .iter()
        .map(|role| role.map(|(role, _)| role))
        .collect();
    let joints = joint::of(content, &only);
    for (index, column) in content.columns.iter().enumerate() {
        if clock.has(index) || tests == Some(index) || column.is_empty() {
            continue;
        }
        let is_read = column.is_numeric() || column.is_mostly_numeric();
        if !is_read || column.name.is_count() || column.name.is_time() {
            channels.unused.push(index);
            continue;
        }
        match roles[index] {
            Some(role) => channels.take(content, (index, &joints[index]), role),
            None => channels.unused.push(index),
        }
    }
    if channels.found.is_empty() {
        channels.only_one(content);
    }
    for channel in &mut channels.found {
        // A manifest has the axes in the order of x, y and z.
        channel.columns.sort_by_key(|index| axis(content, *index));
        if channel.unit.value.is_empty() {
            channel.unit = unit(content, channel);
        }
    }
    channels.alone(content);
    channels.wraps(content);
    channels.open.extend(content.columns.iter().filter_map(bad));
    let of_clock = (0..content.columns.len()).filter(|index| clock.has(*index));
    let doubled = channels.doubled(content, of_clock);
    channels.open.extend(doubled);
    let counted = channels.counted(content);
    let second = channels
        .second_position(content)
        .filter(|_| counted.is_empty());
    channels.open.extend(counted.into_iter().chain(second));
    if channels.found.is_empty() {
        let names: Vec<&str> = channels
            .asked(content)
            .map(|index| content.columns[index].title.as_str())
            .collect();
        let mut question = format!(
            "which columns are meant of {}: fill in a [[channel]] block of the manifest for each",
            names.join(", ")
        );
        if channels
            .asked(content)
            .any(|index| content.columns[index].name.is_input())
        {
            question += ", with what its sensor measures, as unit = \"g\" and scale = 10 for volts of one with 100 mV/g";
        }
        channels.open.push(question);
    }
    channels
}

/// A sentence on the first cell that is no number in a column of numbers.
fn bad(column: &Column) -> Option<String> {
    let bad = column.bad.as_ref().filter(|_| column.is_mostly_numeric())?;
    let text: String = bad.text.chars().take(LONGEST).collect();
    let (place, title, others) = (&bad.place, &column.title, column.texts - 1);
    let more = match others {
        0 => String::new(),
        1 => " and one more like it".into(),
        n => format!(" and {n} more like it"),
    };
    Some(format!(
        "whether {text:?} in {place} of {title:?}{more} is a sample that is missing: say so with missing = [{text:?}] under \
         [csv] in the manifest, or mend the file"
    ))
}

impl Channels {
    /// Adds a column, to a channel that has its other axes already if there is one.
    fn take(
        &mut self,
        content: &Content,
        (index, joint): (usize, &Option<String>),
        (role, certain): (Role, bool),
    ) {
        let column = &content.columns[index];
        let same = self
            .found
            .iter_mut()
            .find(|channel| channel.role.value == role && channel.joint == *joint);
        let is_vector = role.entry().columns.contains(&3);
        match same {
            Some(channel)
                if is_vector && axis(content, index).is_some() && channel.columns.len() < 3 =>
            {
                channel.columns.push(index);
            }
            Some(_) => self.unused.push(index),
            None => {
                let told = column.name.unit.as_deref().and_then(name::unit);
                let unit = told.map_or(String::new(), |unit| unit.names[0].to_owned());
                let role = match certain {
                    true => Guess::known(role),
                    false => Guess::guessed(role, format!("by the name {:?}", column.title)),
                };
                let unit = Guess::known(unit);
                self.found.push(Channel {
                    role,
                    joint: joint.clone(),
                    columns: vec![index],
                    unit,
                    wrap: None,
                });
            }
        }
    }

    /// A single column of numbers without a known name is taken for the vibration.
    fn only_one(&mut self, content: &Content) {
        let numeric = |index: &&usize| {
            let column = &content.columns[**index];
            (column.is_numeric() || column.is_mostly_numeric()) && !column.name.is_count()
        };
        let mut rest = self.unused.iter().filter(numeric);
        if let (Some(&index), None) = (rest.next(), rest.next()) {
            self.unused.retain(|unused| *unused != index);
            self.take(content, (index, &None), (Role::Deformation, false));
        }
    }

    /// Handles guesses that matter. A tip sensor has three axes; with fewer it is a deflection.
    fn alone(&mut self, content: &Content) {
        for channel in &mut self.found {
            if channel.role.value == Role::TipPosition && channel.columns.len() != 3 {
                channel.role = Guess::guessed(Role::Deformation, "fewer than three axes of a tip");
                channel.columns.truncate(1);
            }
        }
        self.pairs(content);
        self.other_kind();
        // A single channel is the vibration, whatever its role.
        if let [only] = self.found.as_mut_slice() {
            if only.role.value == Role::MotorVelocity && only.role.why.is_some() {
                only.role.value = Role::LinkVelocity;
            }
            return;
        }
        // Of several joints the roles are the same.
        let mut guessed: Vec<(Role, Vec<&str>)> = Vec::new();
        for channel in self.found.iter().filter(|found| found.role.why.is_some()) {
            let (role, title) = (
                channel.role.value,
                &content.columns[channel.columns[0]].title,
            );
            match guessed.iter_mut().find(|(other, _)| *other == role) {
                Some((_, titles)) => titles.push(title),
                None => guessed.push((role, vec![title])),
            }
        }
        let words = guessed.iter().map(|(role, titles)| match &**titles {
            [first, _, ..] => format!(
                "whether {first:?} is a {role}, and {} like it",
                titles.len() - 1
            ),
            _ => format!("whether {:?} is a {role}", titles[0]),
        });
        self.open.extend(words);
    }
}

/// The role of a column, and whether it is certain.
pub fn role(content: &Content, index: usize) -> Option<(Role, bool)> {
    let own = by_name(content, index);
    tool::place(content, index).map_or(own, |place| tool::role(place, own))
}

/// The axis of a column: 0, 1 or 2.
fn axis(content: &Content, index: usize) -> Option<usize> {
    let name = &content.columns[index].name;
    name.axis().or_else(|| tool::place(content, index))
}

fn by_name(content: &Content, index: usize) -> Option<(Role, bool)> {
    let name = &content.columns[index].name;
    // RepRapFirmware calls the axes of its accelerometer X, Y and Z, as a phone does in a file `Accelerometer.csv`.
    let of_one = content.told_rate_hz.is_some()
        || name.words.len() == 1 && content.is_called_accelerometer();
    if of_one && name.axis().is_some() {
        return Some((Role::TipAcceleration, true));
    }
    if let Some(role) = super::theta::role(content, index) {
        return Some((role, false));
    }
    let dimension = name
        .unit
        .as_deref()
        .and_then(name::unit)
        .map(|unit| unit.dimension);
    let named = name.role();
    // A tool with an acceleration's unit has an accelerometer.
    match (named, dimension) {
        // A vibration may be told as a velocity or a length.
        (
            Some((Role::TipAcceleration | Role::LinkAcceleration, _)),
            Some(own @ (Dimension::Velocity | Dimension::AngularVelocity | Dimension::Length)),
        ) => by_dimension(own),
        (Some((role, true)), _) => Some((role, true)),
        (_, Some(Dimension::Acceleration)) => Some((Role::TipAcceleration, true)),
        // The command of a speed is no measured speed.
        (
            Some((Role::CommandPosition, _)),
            Some(Dimension::Velocity | Dimension::AngularVelocity | Dimension::AngularAcceleration),
        ) => None,
        // Any sensor gives volts at the input of an instrument.
        (None, Some(Dimension::Voltage)) if name.is_input() => None,
        // Steps of an encoder do not tell what moves.
        (Some(found), Some(Dimension::Number)) => Some(found),
        // An angle at the tip is that of the link.
        (Some((Role::TipPosition, _)), Some(Dimension::Angle)) => Some((Role::LinkPosition, false)),
        (Some((role, false)), Some(dimension)) => {
            let fits = role.entry().dimensions.contains(&dimension);
            fits.then_some((role, false))
                .or_else(|| by_dimension(dimension))
        }
        (Some(found), None) => Some(found),
        (None, Some(dimension)) => by_dimension(dimension),
        (None, None) => None,
    }
}

/// The most frequent role of a quantity.
fn by_dimension(dimension: Dimension) -> Option<(Role, bool)> {
    match dimension {
        Dimension::Angle => Some((Role::MotorPosition, false)),
        Dimension::Length => Some((Role::Deformation, false)),
        Dimension::Velocity | Dimension::AngularVelocity => Some((Role::LinkVelocity, false)),
        Dimension::AngularAcceleration => Some((Role::LinkAcceleration, false)),
        Dimension::Acceleration => Some((Role::TipAcceleration, true)),
        Dimension::Force => Some((Role::Force, true)),
        Dimension::Torque => Some((Role::Torque, true)),
        Dimension::Current => Some((Role::MotorCurrent, true)),
        Dimension::Voltage => Some((Role::MotorVoltage, true)),
        Dimension::MomentOfInertia => Some((Role::Inertia, true)),
        Dimension::Mass | Dimension::Number => None,
    }
}

/// The unit of a channel whose names do not contain it.
fn unit(content: &Content, channel: &Channel) -> Guess<String> {
    let role = channel.role.value;
    let told = content.columns[channel.columns[0]].name.unit.as_ref();
    let no_unit = told.map_or("no unit in its name".into(), |unit| {
        format!("the unit {unit:?} in its name is not known")
    });
    if role != Role::TipAcceleration {
        let usual = role.entry().dimensions[0];
        let raw = Guess::guessed("raw".into(), no_unit);
        if told.is_some() {
            return raw;
        }
        return match usual {
            Dimension::Angle | Dimension::Length => raw,
            dimension => by_role(dimension)
                .map_or(raw, |si| Guess::guessed(si.into(), "no unit in its name")),
        };
    }
    if content.told_rate_hz.is_some() {
        return Guess::known("g".into());
    }
    if content.is_klipper() {
        return Guess::known("mm/s^2".into());
    }
    let mean = |index: &usize| {
        let there = content.columns[*index]
            .numbers
            .iter()
            .filter(|value| !value.is_nan());
        there.clone().sum::<f64>() / there.count().max(1) as f64
    };
    let pull = channel
        .columns
        .iter()
        .map(mean)
        .map(|mean| mean * mean)
        .sum::<f64>()
        .sqrt();
    for (unit, gravity) in [
        ("m/s^2", G_N),
        ("g", 1.0),
        ("mm/s^2", 1e3 * G_N),
        ("mg", 1e3),
    ] {
        if (pull / gravity - 1.0).abs() < OFFSET {
            return Guess::guessed(unit.into(), "its mean is the gravity of the earth");
        }
    }
    Guess::guessed("raw".into(), no_unit + "; a frequency does not need one")
}

fn by_role(dimension: Dimension) -> Option<&'static str> {
    let of = super::super::unit::UNITS
        .iter()
        .find(|unit| unit.dimension == dimension);
    of.map(|unit| unit.si)
}
