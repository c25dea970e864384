//! Positions that are readings of a counter which begins again.

use super::super::unit::Dimension;
use super::clock::Clock;
use super::columns::{Channel, Channels};
use super::content::Content;
use super::read::Read;
use super::units;
use crate::{Role, Wrap};

/// What a counter of an encoder reads.
const POSITIONS: [Role; 4] = [
    Role::CommandPosition,
    Role::MotorPosition,
    Role::LinkPosition,
    Role::Deformation,
];

/// A clause on its jumps.
pub fn words(wrap: &Wrap) -> String {
    format!(
        "it jumps by that {}, and goes on smoothly without it",
        times(wrap)
    )
}

/// The same of stamps.
pub fn of_time(wrap: &Wrap) -> String {
    format!(
        "the time falls by that {}, as a counter that begins again, and goes on by one sample without it",
        times(wrap)
    )
}

/// A sentence on stamps of a file that are read so.
pub fn taken(file: &Read) -> Option<String> {
    let Clock::Stamps { column, .. } = &file.clock else {
        return None;
    };
    let column = &file.content.columns[*column];
    let wrap = column.wrap.as_ref()?;
    Some(format!(
        "{:?} is read with time_wrap = {}: {}",
        column.title,
        wrap.period,
        of_time(wrap)
    ))
}

fn times(wrap: &Wrap) -> String {
    match wrap.jumps {
        1 => "once".into(),
        count => format!("{count} times"),
    }
}

impl Channels {
    /// Finds the counters that begin again among positions without a physical unit. An angle in one is unwrapped where it is
    /// used.
    pub(super) fn wraps(&mut self, content: &Content) {
        for channel in self.found.iter_mut().filter(|own| is_counted(own)) {
            let column = &content.columns[channel.columns[0]];
            let there = column.numbers.iter().copied().filter(|own| !own.is_nan());
            channel.wrap = Wrap::of(&there.collect::<Vec<_>>());
            if let Some(wrap) = &channel.wrap {
                self.open.push(format!(
                    "whether {:?} is of a counter that begins again at {}: {}, so that wrap = {} takes the jumps out",
                    column.title,
                    wrap.period,
                    words(wrap),
                    wrap.period
                ));
            }
        }
    }
}

/// Whether it is a position in counts, or in a unit that nobody knows.
fn is_counted(channel: &Channel) -> bool {
    let unit = channel.unit.value.as_str();
    let is_bare = units::unit(unit).is_some_and(|own| own.dimension == Dimension::Number);
    POSITIONS.contains(&channel.role.value) && is_bare && channel.columns.len() == 1
}
