//! Faults of sensors, put on between the arm and the tick.

use quell::service::contract::{Measured, Quantity};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// How a sensor fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    None,
    Stuck,
    Jump,
    Spikes,
    SignFlip,
    Dead,
    Swapped,
    WrongUnit,
    Noise,
    ClockJump,
}

impl Kind {
    pub const ALL: [Self; 10] = [
        Self::None,
        Self::Stuck,
        Self::Jump,
        Self::Spikes,
        Self::SignFlip,
        Self::Dead,
        Self::Swapped,
        Self::WrongUnit,
        Self::Noise,
        Self::ClockJump,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Stuck => "stuck",
            Self::Jump => "jump",
            Self::Spikes => "spikes",
            Self::SignFlip => "sign flip",
            Self::Dead => "dead",
            Self::Swapped => "swapped channels",
            Self::WrongUnit => "wrong unit",
            Self::Noise => "noise times 20",
            Self::ClockJump => "clock jump",
        }
    }
}

/// The kind of a joint's second sensor.
#[derive(Clone, Copy, Debug)]
pub struct Sensor {
    pub quantity: Quantity,
    /// Standard deviation of its noise, rad.
    pub noise: f64,
    /// Distance of the tip from the axis, m.
    pub radius: f64,
}

/// A fault of the first joint's sensors.
#[derive(Clone, Debug)]
pub struct Fault {
    pub kind: Kind,
    sensor: Sensor,
    /// Whether it is the encoder of the motor side that fails, or the second sensor.
    motor: bool,
    /// Whether a channel is swapped with the next joint's, or with the joint's own other one.
    across: bool,
    /// When it begins and ends, s.
    pub from: f64,
    to: f64,
    /// Height of a jump or spike, rad.
    height: f64,
    /// Length of a jump of the clock, s.
    clock: f64,
    /// Factor of a wrong unit.
    unit: f64,
    held: Option<[f64; 3]>,
    random: ChaCha8Rng,
}

/// Standard deviation of the encoder's rounding, rad.
const ENCODER_NOISE: f64 = 0.5e-6;
/// Share of the samples that are spikes: one in fifty.
const SPIKES: f64 = 0.02;

impl Fault {
    /// A fault of this kind, its moment within `duration` (s) and its size drawn.
    pub fn draw(
        kind: Kind,
        duration: f64,
        axes: usize,
        sensor: Sensor,
        mut random: ChaCha8Rng,
    ) -> Self {
        let motor = random.random_bool(0.3);
        // A wire that is crossed or a unit that is wrong is so from the start, as often as not.
        let wired = matches!(kind, Kind::SignFlip | Kind::Swapped | Kind::WrongUnit);
        let begins = random.random_range(0.0..0.9) * duration;
        let from = if wired && random.random_bool(0.5) {
            -1.0
        } else {
            begins
        };
        let lasts = random.random_range(0.05..3.0);
        let passes = random.random_bool(0.3) && from >= 0.0;
        let to = if passes { from + lasts } else { f64::INFINITY };
        let mut between =
            |low: f64, high: f64| low * (high / low).powf(random.random_range(0.0..1.0));
        let (height, clock) = (between(1e-4, 0.3), between(5e-3, 5.0));
        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        // Millimetres for metres, milliradians or degrees for radians, or the other way round.
        let factor = match (motor, sensor.quantity) {
            (true, _) | (false, Quantity::LinkPosition) => 1f64.to_degrees(),
            _ => 1000.0,
        };
        let unit = if random.random_bool(0.7) {
            factor
        } else {
            1.0 / factor
        };
        Self {
            kind,
            sensor,
            motor,
            across: axes > 1 && random.random_bool(0.7),
            from,
            to,
            height: sign * height,
            clock: sign * clock,
            unit,
            held: None,
            random,
        }
    }

    pub fn is_on(&self, time: f64) -> bool {
        self.kind != Kind::None && (self.from..self.to).contains(&time)
    }

    /// The measurements of all joints at `time`, as the fault leaves them.
    pub fn act(&mut self, time: f64, measured: &mut Vec<Measured>) {
        if !self.is_on(time) {
            self.held = None;
            return;
        }
        measured.retain_mut(|sample| self.spoil(sample));
    }

    /// Whether a sample is still to be had.
    fn spoil(&mut self, sample: &mut Measured) -> bool {
        if self.kind == Kind::Swapped {
            self.swap(sample);
            return true;
        }
        let motor = sample.quantity == Quantity::MotorPosition;
        if sample.joint != 0 || motor != self.motor {
            return true;
        }
        let scale = match sample.quantity {
            Quantity::TipPosition => self.sensor.radius,
            _ => 1.0,
        };
        match self.kind {
            Kind::None | Kind::Swapped => {}
            Kind::Stuck => sample.value = *self.held.get_or_insert(sample.value),
            Kind::Jump => sample.value[0] += scale * self.height,
            Kind::Spikes => {
                if self.random.random_bool(SPIKES) {
                    sample.value[0] += scale * self.height;
                }
            }
            Kind::SignFlip => sample.value = sample.value.map(|value| -value),
            Kind::Dead => return false,
            Kind::WrongUnit => sample.value = sample.value.map(|value| value * self.unit),
            Kind::Noise => {
                let whole = if motor {
                    ENCODER_NOISE
                } else {
                    self.sensor.noise
                };
                let entries = match sample.quantity {
                    Quantity::TipPosition => 3,
                    _ => 1,
                };
                for value in &mut sample.value[..entries] {
                    let z: f64 = self.random.sample(StandardNormal);
                    *value += 20.0 * scale * whole * z;
                }
            }
            Kind::ClockJump => sample.stamp += self.clock,
        }
        true
    }

    /// The two sensors of a joint on each other's wires, a tracker's first two axes, or the second
    /// sensors of two joints.
    fn swap(&self, sample: &mut Measured) {
        if self.across {
            if sample.joint < 2 && sample.quantity != Quantity::MotorPosition {
                sample.joint = 1 - sample.joint;
            }
        } else if sample.joint == 0 {
            sample.quantity = match (sample.quantity, self.sensor.quantity) {
                (quantity, Quantity::TipPosition) => {
                    if quantity == Quantity::TipPosition {
                        sample.value.swap(0, 1);
                    }
                    quantity
                }
                (Quantity::MotorPosition, second) => second,
                _ => Quantity::MotorPosition,
            };
        }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let which = if self.motor { "motor" } else { "second" };
        let wires = if self.across { ", across joints" } else { "" };
        write!(
            f,
            "{which} sensor{wires} from {:.2} s to {:.2} s, height {:.2e} rad, clock {:.3} s, unit {:.3e}",
            self.from, self.to, self.height, self.clock, self.unit
        )
    }
}
