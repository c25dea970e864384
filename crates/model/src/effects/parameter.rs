//! A parameter of an effect: a number with a unit and a range.

use super::Scales;

/// A unit as a product of the model's units of force, position, input and reference and of seconds.
///
/// A damping coefficient is `Quantity::new(1, -1, 1)`: N.s/m on a linear axis, N.m.s/rad on a joint, and
/// s where forces are divided by a stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Power of the unit of force.
    pub force: i8,
    /// Power of the unit of position.
    pub position: i8,
    /// Power of the second.
    pub time: i8,
    /// Power of the unit of the drive's input: a force, a current, a voltage, a position.
    pub input: i8,
    /// Power of the unit of the reference: what the machine is commanded.
    pub reference: i8,
}

/// The units of a model for a given input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Units {
    /// Of force.
    pub force: String,
    /// Of position.
    pub position: String,
    /// Of the drive's input: within a position loop the loop's output, else what the machine is commanded.
    pub input: String,
    /// Of what the machine is commanded. A drive with a memory acts on it, in front of a position loop.
    pub reference: String,
}

impl Quantity {
    /// A number.
    pub const NUMBER: Self = Self::new(0, 0, 0);
    /// A force or a torque.
    pub const FORCE: Self = Self::new(1, 0, 0);
    /// A position or a deformation.
    pub const POSITION: Self = Self::new(0, 1, 0);
    /// A velocity.
    pub const VELOCITY: Self = Self::new(0, 1, -1);
    /// A time.
    pub const TIME: Self = Self::new(0, 0, 1);
    /// A frequency or an angular frequency.
    pub const FREQUENCY: Self = Self::new(0, 0, -1);
    /// The force that a unit of the input makes.
    pub const GAIN: Self = Self {
        force: 1,
        position: 0,
        time: 0,
        input: -1,
        reference: 0,
    };
    /// The drive's input.
    pub const INPUT: Self = Self::driven(1, 0);

    /// The product of these powers.
    pub const fn new(force: i8, position: i8, time: i8) -> Self {
        Self {
            force,
            position,
            time,
            input: 0,
            reference: 0,
        }
    }

    /// The product of a power of the input's unit and one of the second.
    pub const fn driven(input: i8, time: i8) -> Self {
        Self {
            force: 0,
            position: 0,
            time,
            input,
            reference: 0,
        }
    }

    /// The product of a power of the reference's unit and one of the second.
    pub const fn commanded(reference: i8, time: i8) -> Self {
        Self {
            reference,
            ..Self::driven(0, time)
        }
    }

    /// The unit's name, for a model whose units are given.
    ///
    /// # Example
    /// ```
    /// use quell_model::effects::{Quantity, Units};
    /// let units = |force: &str, position: &str, input: &str| Units {
    ///     force: force.into(),
    ///     position: position.into(),
    ///     input: input.into(),
    ///     reference: "rad".into(),
    /// };
    /// let damping = Quantity::new(1, -1, 1);
    /// assert_eq!(damping.unit(&units("N", "m", "N")), "N.s/m");
    /// // Forces divided by a stiffness are positions.
    /// assert_eq!(damping.unit(&units("rad", "rad", "rad")), "s");
    /// assert_eq!(Quantity::NUMBER.unit(&units("N", "m", "N")), "1");
    /// assert_eq!(Quantity::driven(1, -1).unit(&units("N.m", "rad", "A")), "A/s");
    /// assert_eq!(Quantity::commanded(1, -1).unit(&units("N.m", "rad", "N.m")), "rad/s");
    /// ```
    pub fn unit(self, units: &Units) -> String {
        let mut factors: Vec<(&str, i8)> = Vec::new();
        for (name, power) in [
            (units.force.as_str(), self.force),
            (&units.position, self.position),
            (&units.input, self.input),
            (&units.reference, self.reference),
            ("s", self.time),
        ] {
            match factors.iter_mut().find(|factor| factor.0 == name) {
                Some(factor) => factor.1 += power,
                None => factors.push((name, power)),
            }
        }
        let side = |sign: i8| -> Vec<String> {
            let of = |&(name, power): &(&str, i8)| match power * sign {
                1 => Some(name.to_string()),
                power if power > 1 => Some(format!("{name}^{power}")),
                _ => None,
            };
            factors.iter().filter_map(of).collect()
        };
        let (above, below) = (side(1), side(-1));
        let above = match above.is_empty() {
            true => "1".to_string(),
            false => above.join("."),
        };
        match below.len() {
            0 => above,
            1 => format!("{above}/{}", below[0]),
            _ => format!("{above}/({})", below.join(".")),
        }
    }
}

/// The role of a parameter in its effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterRole {
    /// Its size: the effect vanishes at the neutral value for any values of the other parameters. Every effect
    /// of the catalogue has one.
    Size,
    /// Time of an event.
    Time,
    /// Position at which it acts.
    Position,
    /// Position of a border of the motion. A machine is kept clear of its borders, but nobody says how far.
    Border,
    /// Angular frequency of a mode of its own.
    Frequency,
    /// Radians per unit of position.
    Order,
    /// Phase of a periodic effect.
    Phase,
    /// The shape of its law at a given size: a ratio, an exponent, a length, a time constant.
    Shape,
    /// Value of a learned law at a knot; the effect vanishes where all values are neutral.
    Ordinate,
    /// End of the range of a learned law's knots: the range that was visited when it was learned. It is never
    /// fitted.
    Range,
    /// The side on which it acts: the sign of the value. It is chosen, never fitted.
    Side,
}

impl ParameterRole {
    /// Whether a fit varies it.
    pub fn is_fitted(self) -> bool {
        !matches!(self, Self::Range | Self::Side)
    }
}

/// One number that describes an effect.
#[derive(Clone, Copy)]
pub struct Parameter {
    /// Name in files.
    pub name: &'static str,
    /// Its role in the effect.
    pub role: ParameterRole,
    /// Its unit.
    pub quantity: Quantity,
    /// Least and greatest value that physics allows for a motion of these scales.
    pub bounds: fn(&Scales) -> (f64, f64),
    /// For the size, the value at which the effect vanishes; for other parameters a harmless one.
    pub neutral: f64,
    /// Typical value in practice, for a motion of these scales; never 0, since it is the unit of a fit's steps.
    pub typical: fn(&Scales) -> f64,
}
