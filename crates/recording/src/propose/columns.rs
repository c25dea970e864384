//! Proposed channels for the columns of a file.

use super::super::role::Role;
use super::Guess;
use super::clock::Clock;
use super::column::Column;
use super::content::Content;
use super::{gyroscope, joint, roles, units, usual_unit};
use crate::Wrap;

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
    /// How many counts a revolution has, where its unit says so.
    pub per_revolution: Option<f64>,
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
        .map(|index| roles::role(content, index))
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
        if !column.is_measured() {
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
        channels.only_three(content);
    }
    for channel in &mut channels.found {
        // A manifest has the axes in the order of x, y and z.
        channel
            .columns
            .sort_by_key(|index| roles::axis(content, *index));
        if channel.unit.value.is_empty() {
            channel.unit = usual_unit::of(content, channel.role.value, &channel.columns);
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
                if is_vector
                    && roles::axis(content, index).is_some()
                    && channel.columns.len() < 3 =>
            {
                channel.columns.push(index);
            }
            Some(_) => self.unused.push(index),
            None => {
                let told = column.name.unit.as_deref().and_then(units::unit);
                let unit = told.map_or(String::new(), |unit| unit.names[0].to_owned());
                let role = match certain {
                    true => Guess::known(role),
                    false => {
                        let by_name = || format!("by the name {:?}", column.title);
                        let why = gyroscope::why(content, index);
                        Guess::guessed(role, why.unwrap_or_else(by_name))
                    }
                };
                let unit = Guess::known(unit);
                self.found.push(Channel {
                    role,
                    joint: joint.clone(),
                    columns: vec![index],
                    unit,
                    per_revolution: column.name.per_revolution,
                    wrap: None,
                });
            }
        }
    }

    /// A single column of numbers without a known name is taken for the vibration.
    fn only_one(&mut self, content: &Content) {
        if let [index] = *self.measured(content) {
            self.unused.retain(|unused| *unused != index);
            self.take(content, (index, &None), (Role::Deformation, false));
        }
    }

    /// Three columns without known names whose mean is the gravity of the earth are taken for the axes of an accelerometer.
    fn only_three(&mut self, content: &Content) {
        let axes = self.measured(content);
        if axes.len() != 3 || usual_unit::of_gravity(content, &axes).is_none() {
            return;
        }
        self.unused.retain(|unused| !axes.contains(unused));
        self.found.push(Channel {
            role: Guess::guessed(Role::TipAcceleration, usual_unit::GRAVITY),
            joint: None,
            columns: axes,
            unit: Guess::known(String::new()),
            per_revolution: None,
            wrap: None,
        });
    }

    /// The columns of numbers that have no use and are neither counters nor times.
    fn measured(&self, content: &Content) -> Vec<usize> {
        let unused = self.unused.iter().copied();
        unused
            .filter(|index| content.columns[*index].is_measured())
            .collect()
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
