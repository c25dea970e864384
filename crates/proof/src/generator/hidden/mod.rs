//! The effects that can be hidden in an arm: one table, from the transmission to the world outside.
//!
//! Each entry has one size, without a unit, that is about the share of the deformation that it makes.
//! Its shape (a corner, a wave length, an instant) follows from four numbers in [0, 1).

mod laws;
mod link;
mod outside;
mod sensor;
mod shaped;
mod transmission;

use super::Channel;
use super::plan::Table;
use super::sensors::Arm;

/// Parameters of what was hidden: name and value, as the truth tells them.
pub type Parameters = Vec<(&'static str, f64)>;

/// Sizes of the motion without anything hidden, by which effects are measured.
#[derive(Clone, Debug)]
pub struct Scales {
    /// Greatest deformation, rad.
    pub deformation: f64,
    /// Its rms over the recording, rad.
    pub deformation_rms: f64,
    /// Greatest rate of the deformation, rad/s.
    pub rate: f64,
    /// Natural frequency, rad/s.
    pub natural_frequency: f64,
    /// Greatest speed of the motor side, rad/s.
    pub speed: f64,
    /// Least and greatest position of the motor side, rad.
    pub span: [f64; 2],
    /// Pauses of the programme, s.
    pub pauses: Vec<[f64; 2]>,
    /// Length of the recording, s.
    pub duration: f64,
}

/// Puts something of a shape and a size into an arm, and tells its parameters.
pub type Hide = fn(&mut Arm, &Scales, [f64; 4], f64) -> Parameters;

/// Puts a law that another one contains into an arm: for a shape and a size of that one, and what its
/// own force and length are multiplied by.
pub type Simpler = fn(&mut Arm, &Scales, [f64; 4], f64, [f64; 2]);

/// Something that can be hidden.
pub struct Entry {
    /// Name, as in the catalogue of effects.
    pub name: &'static str,
    /// Where it sits.
    pub place: &'static str,
    /// Whether a diagnosis can know it.
    pub in_catalogue: bool,
    /// What its law has beside the textbook's, in words; empty where it has that of the textbook.
    pub shape: &'static str,
    /// Sensors that show it.
    pub channels: &'static [Channel],
    /// Whether one move does not show it.
    pub needs_programme: bool,
    /// A law that this one contains: it is hidden only where it shows as more than that.
    pub contains: Option<Simpler>,
    /// First size to try, and the greatest one that makes sense.
    pub sizes: [f64; 2],
    /// Puts it into the arm and tells its parameters.
    pub hide: Hide,
}

/// All sensors.
const ANY: &[Channel] = &[Channel::Tip, Channel::Link, Channel::Deformation];
/// Sensors outside the arm.
const OUTER: &[Channel] = &[Channel::Tip, Channel::Link];

/// What can be hidden in a flexible joint, of one table.
pub fn entries(table: Table) -> impl Iterator<Item = &'static Entry> {
    let tables: &[&[Entry]] = match table {
        Table::Catalogue => &[transmission::ENTRIES, link::ENTRIES, sensor::ENTRIES],
        Table::Shaped => &[shaped::ENTRIES],
        Table::Strange => &[outside::ENTRIES],
        Table::Outside => &[outside::ENTRIES, laws::ENTRIES],
    };
    tables.iter().copied().flatten()
}

/// An entry with neither sensor nor programme asked for.
const fn entry(name: &'static str, place: &'static str, sizes: [f64; 2], hide: Hide) -> Entry {
    Entry {
        name,
        place,
        in_catalogue: true,
        shape: "",
        channels: ANY,
        needs_programme: false,
        contains: None,
        sizes,
        hide,
    }
}

impl Entry {
    const fn seen_by(mut self, channels: &'static [Channel]) -> Self {
        self.channels = channels;
        self
    }

    const fn in_a_programme(mut self) -> Self {
        self.needs_programme = true;
        self
    }

    const fn more_than(mut self, simpler: Simpler) -> Self {
        self.contains = Some(simpler);
        self
    }

    const fn unknown(mut self) -> Self {
        self.in_catalogue = false;
        self
    }

    const fn shaped(self, words: &'static str, textbook: Simpler) -> Self {
        let mut shaped = self.more_than(textbook);
        shaped.shape = words;
        shaped
    }
}

/// A number between bounds, evenly in the logarithm, from one in [0, 1).
fn log_between(low: f64, high: f64, share: f64) -> f64 {
    low * (high / low).powf(share)
}

/// A number between bounds from one in [0, 1).
fn between(low: f64, high: f64, share: f64) -> f64 {
    low + (high - low) * share
}

/// 1 or -1 from a number in [0, 1).
fn sign(share: f64) -> f64 {
    if share < 0.5 { 1.0 } else { -1.0 }
}
