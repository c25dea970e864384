//! Two columns that are the two sides of a joint.

use super::super::role::Role;
use super::super::unit::{Dimension, Unit};
use super::Guess;
use super::column::Column;
use super::columns::{Channel, Channels};
use super::content::Content;
use crate::range;

/// Ratio of link to motor side from which on the two are no sides of one joint, see `StaticRatio` of quell-signal.
const FAR: f64 = 2.0;

impl Channels {
    /// Takes a column of the motor, by its name, and one of the link or the tip, in the same unit, for the positions of the
    /// two sides where the second one goes as far as the first: a deformation has the slope 0 over the motor side.
    pub(super) fn pairs(&mut self, content: &Content) {
        let title = |channel: &Channel| &content.columns[channel.columns[0]].name;
        let says = |channel: &Channel, words: &[&str]| {
            title(channel)
                .words
                .iter()
                .any(|word| words.contains(&word.as_str()))
        };
        let guessed = |channel: &Channel| channel.role.why.is_some() && channel.columns.len() == 1;
        let place = |role: &[Role], words: &[&str]| {
            let is_one = |own: &Channel| role.contains(&own.role.value) && says(own, words);
            let mut all = (0..self.found.len()).filter(|&k| is_one(&self.found[k]));
            all.next().filter(|_| all.next().is_none())
        };
        let motor = place(&[Role::MotorPosition], &["motor"]);
        let sides = [Role::LinkPosition, Role::Deformation];
        let link = place(&sides, &["tip", "tcp", "tool", "link", "load", "arm"]);
        let Some((motor, link)) = motor
            .zip(link)
            .filter(|(_, link)| guessed(&self.found[*link]))
        else {
            return;
        };
        let [u, y] = [motor, link].map(|k| &content.columns[self.found[k].columns[0]]);
        let is_far = |ratio: f64| !(FAR.recip()..FAR).contains(&ratio);
        if u.name.unit != y.name.unit {
            if let Some(words) = geared(u, y) {
                self.found[motor].role = Guess::known(Role::MotorPosition);
                self.found[link].role = Guess::known(Role::LinkPosition);
                self.open.push(words);
            }
            return;
        }
        if is_far(slope(u, y)) {
            return;
        }
        self.found[motor].role = Guess::known(Role::MotorPosition);
        self.found[link].role = Guess::known(Role::LinkPosition);
    }
}

impl Channels {
    /// A guessed velocity of the motor in m/s beside a position that is an angle, or the other way round, is the link's.
    pub(super) fn other_kind(&mut self) {
        let dimension =
            |own: &Channel| super::units::unit(&own.unit.value).map(|unit| unit.dimension);
        let motor = self
            .found
            .iter()
            .find(|own| own.role.value == Role::MotorPosition);
        let other = match motor.and_then(dimension) {
            Some(Dimension::Angle) => Dimension::Velocity,
            Some(Dimension::Length) => Dimension::AngularVelocity,
            _ => return,
        };
        let is_one = |own: &&mut Channel| {
            let is_guess = own.role.value == Role::MotorVelocity && own.role.why.is_some();
            is_guess && dimension(own) == Some(other)
        };
        if let Some(own) = self.found.iter_mut().find(is_one) {
            own.role.value = Role::LinkVelocity;
        }
    }

    /// A sentence on a second column that may be a position of the motor side, where nothing else shows the link.
    pub(super) fn second_position(&self, content: &Content) -> Option<String> {
        let link = [
            Role::LinkPosition,
            Role::Deformation,
            Role::TipPosition,
            Role::TipAcceleration,
            Role::LinkAcceleration,
            Role::LinkVelocity,
        ];
        if self.found.iter().any(|own| link.contains(&own.role.value)) {
            return None;
        }
        let mut motor = self
            .found
            .iter()
            .filter(|own| own.role.value == Role::MotorPosition);
        let (one, None) = (motor.next()?, motor.next()) else {
            return None;
        };
        let first = &content.columns[one.columns[0]];
        let is_second = |&&index: &&usize| {
            let own = &content.columns[index];
            let role = super::roles::role(content, index);
            let is_position = role.is_some_and(|(role, _)| role == Role::MotorPosition);
            is_position && own.name.unit == first.name.unit && own.numbers != first.numbers
        };
        let second = self.unused.iter().find(is_second)?;
        Some(format!(
            "what {:?} is beside {:?}: if it is of the link, add a [[channel]] block with role = \"link_position\"",
            content.columns[*second].title, first.title
        ))
    }
}

/// A sentence on a length that follows the angle of a motor, or an angle a length: more of it is explained by that than is
/// left. A deformation has the slope 0 over the motor side.
fn geared(u: &Column, y: &Column) -> Option<String> {
    let [own, its] = [u, y].map(|column| column.name.unit.as_deref());
    let known = |unit: Option<&str>| unit.and_then(super::units::unit);
    let [from, to] = [known(own)?, known(its)?];
    let is_motion = |unit: &Unit| matches!(unit.dimension, Dimension::Angle | Dimension::Length);
    let ratio = slope(u, y);
    let follows = ratio * slope(y, u) > 0.5;
    let told = follows && from.dimension != to.dimension && is_motion(from) && is_motion(to);
    told.then(|| {
        let (unit, per) = (to.names[0], from.names[0]);
        format!(
            "how many {unit} {:?} goes for each {per} of {:?}: write the exact number as scale, with unit = \"{unit}\", for \
             motor_position; it follows with about {ratio:.4}",
            y.title, u.title
        )
    })
}

/// The slope of one column over another, by least squares.
fn slope(over: &Column, of: &Column) -> f64 {
    let pairs = || {
        let both = over.numbers.iter().zip(&of.numbers);
        both.filter(|(x, y)| x.is_finite() && y.is_finite())
    };
    let count = pairs().count() as f64;
    if count == 0.0 {
        // Each row has the one or the other: how far they go tells it.
        let gone = |column: &Column| {
            let values = column.numbers.iter().copied().filter(|own| own.is_finite());
            range(&values.collect::<Vec<_>>())
        };
        return gone(of) / gone(over);
    }
    let (x, y) = pairs().fold((0.0, 0.0), |sum, (x, y)| {
        (sum.0 + x / count, sum.1 + y / count)
    });
    let product: f64 = pairs().map(|(a, b)| (a - x) * (b - y)).sum();
    product / pairs().map(|(a, _)| (a - x).powi(2)).sum::<f64>()
}
