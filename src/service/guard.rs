//! Plausibility checks of sensors: samples of a stuck, saturated or jumping sensor are refused, and learned
//! modes are kept.

use quell_trajectories::Limits;

use crate::service::contract::{Measured, Quantity};

/// Quantities that are checked, in the order of [`Guard`]'s table.
const QUANTITIES: [Quantity; 5] = [
    Quantity::MotorPosition,
    Quantity::LinkPosition,
    Quantity::Deformation,
    Quantity::TipPosition,
    Quantity::TipAcceleration,
];
/// Number of equal successive readings, while the joint's motion must change them, from which a sensor counts
/// as stuck. A sensor whose noise exceeds its step repeats itself at most every other time: 2^-32 by chance.
const STUCK: u32 = 32;
/// Speed, as a share of its limit, at which a position must change; and change of the acceleration over a tick,
/// as a share of what the jerk limit allows, at which a deformation must change. Below them a sensor may repeat
/// itself within its step.
const MOVING: f64 = 0.05;
/// Speed of a reading, relative to the joint's limit, that is a jump, not a motion: a link that swings against
/// the motion is at most twice as fast as the motor side.
const JUMP: f64 = 4.0;
/// Seconds without a fault after which a sensor is trusted again, and without a number after which that is told.
const RECOVERY: f64 = 0.5;
/// Weight of a new gap in the mean of the gaps.
const RATE_WEIGHT: f64 = 0.02;

/// The fault of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The reading has not changed although the joint moves.
    Stuck,
    /// The reading is at the end of the sensor's scale.
    Saturated,
    /// The reading has changed by more than the joint can have moved, and than it was commanded to.
    Jump,
    /// The reading is no number. It is a sample that is missing: the next one is believed.
    NotFinite,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Stuck, Self::Saturated, Self::Jump, Self::NotFinite];

    /// Name in states and metrics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stuck => "stuck",
            Self::Saturated => "saturated",
            Self::Jump => "jump",
            Self::NotFinite => "not_finite",
        }
    }
}

/// State of one sensor in the guard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorReport {
    /// Samples taken and refused.
    pub samples: u64,
    /// Samples refused, in the order of [`Fault::ALL`].
    pub refused: [u64; 4],
    /// Present fault.
    pub fault: Option<Fault>,
    /// Whether it has jumped, or was not finite, since the guard was restarted: it may measure from another zero.
    pub jumped: bool,
    /// When the last sample came, s.
    pub heard: f64,
    /// When the last sample came that was a number, s.
    pub numbered: f64,
    /// Samples a second, over the last 50 or so, Hz.
    pub rate: f64,
}

/// State of a joint's sensors in the guard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GuardReport {
    sensors: [SensorReport; QUANTITIES.len()],
}

impl SensorReport {
    /// The fault to be told at `now` (s): some readings without a number are none.
    pub fn told_fault(&self, now: f64) -> Option<Fault> {
        let numbers = now - self.numbered < RECOVERY;
        self.fault
            .filter(|&fault| fault != Fault::NotFinite || !numbers)
    }
}

impl GuardReport {
    /// The sensors that have sent any sample.
    pub fn sensors(&self) -> impl Iterator<Item = (Quantity, &SensorReport)> {
        let all = QUANTITIES.into_iter().zip(&self.sensors);
        all.filter(|(_, sensor)| sensor.samples > 0)
    }

    /// The present fault of the sensor of a quantity.
    pub fn fault_of(&self, quantity: Quantity) -> Option<Fault> {
        self.of(quantity)?.fault
    }

    /// Whether the sensor of a quantity has jumped since the guard was restarted.
    pub fn has_jumped(&self, quantity: Quantity) -> bool {
        self.of(quantity).is_some_and(|sensor| sensor.jumped)
    }

    fn of(&self, quantity: Quantity) -> Option<&SensorReport> {
        let index = QUANTITIES.iter().position(|&known| known == quantity)?;
        Some(&self.sensors[index])
    }

    /// Whether what any sensor says cannot be. A sensor that says nothing, having no number, is not at fault.
    pub fn is_at_fault(&self) -> bool {
        let says = |fault: Fault| fault != Fault::NotFinite;
        self.sensors
            .iter()
            .any(|sensor| sensor.fault.is_some_and(says))
    }

    /// The sensor of a quantity whose last reading was no number.
    pub fn without_number(&self, quantity: Quantity) -> Option<&SensorReport> {
        let sensor = self.of(quantity);
        sensor.filter(|sensor| sensor.fault == Some(Fault::NotFinite))
    }
}

/// The range of a joint's readings.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Limits of the joint.
    pub limits: Limits,
    /// Distance of the tip from the axis, m; infinite where it is not known.
    pub radius: f64,
    /// Full scale of the sensor of the deformation, rad.
    pub deformation: f64,
    /// Step of the encoder, rad.
    pub resolution: f64,
}

/// The commanded motion of a joint.
#[derive(Clone, Copy, Debug, Default)]
pub struct CommandedMotion {
    /// Velocity, rad/s.
    pub velocity: f64,
    /// Change of the acceleration over the last tick, rad/s^3.
    pub jerk: f64,
    /// The largest change from one setpoint to the next that the motor side may still follow, rad: after missed
    /// ticks that of all of them.
    pub step: f64,
}

/// Watches the sensors of one joint. No allocation.
#[derive(Clone, Debug)]
pub struct Guard {
    bounds: Bounds,
    last: [Option<Measured>; QUANTITIES.len()],
    equal: [u32; QUANTITIES.len()],
    /// On the service's clock, s: that of a sensor may be restarted.
    faulty_until: [f64; QUANTITIES.len()],
    report: GuardReport,
}

impl Guard {
    /// A guard without samples.
    pub fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            last: [None; QUANTITIES.len()],
            equal: [0; QUANTITIES.len()],
            faulty_until: [f64::NEG_INFINITY; QUANTITIES.len()],
            report: GuardReport::default(),
        }
    }

    /// The report of the faults.
    pub fn report(&self) -> &GuardReport {
        &self.report
    }

    /// Whether a sample may be used, given the commanded motion.
    pub fn admits(&mut self, measured: &Measured, motion: CommandedMotion) -> bool {
        let Some(index) = QUANTITIES.iter().position(|&q| q == measured.quantity) else {
            return false;
        };
        if !is_finite(measured) {
            let sensor = &mut self.report.sensors[index];
            sensor.samples += 1;
            sensor.heard = measured.received;
            sensor.refused[Fault::NotFinite as usize] += 1;
            sensor.jumped = true;
            if measured.received >= self.faulty_until[index] {
                sensor.fault = Some(Fault::NotFinite);
            }
            return false;
        }
        let last = self.last[index].replace(*measured);
        let fault = self.fault(index, measured, last.as_ref(), motion);
        let sensor = &mut self.report.sensors[index];
        sensor.samples += 1;
        (sensor.heard, sensor.numbered) = (measured.received, measured.received);
        if let Some(last) = &last {
            let gap = elapsed(measured, last).max(f64::MIN_POSITIVE);
            let gaps = match sensor.rate {
                0.0 => gap,
                rate => 1.0 / rate + RATE_WEIGHT * (gap - 1.0 / rate),
            };
            sensor.rate = 1.0 / gaps;
        }
        if let Some(fault) = fault {
            sensor.fault = Some(fault);
            sensor.jumped |= fault == Fault::Jump;
            self.faulty_until[index] = measured.received + RECOVERY;
        } else if measured.received >= self.faulty_until[index] {
            sensor.fault = None;
        }
        if let Some(fault) = sensor.fault {
            sensor.refused[fault as usize] += 1;
        }
        sensor.fault.is_none()
    }

    /// Discards the last samples and their faults, for example after a repair.
    pub fn restart(&mut self) {
        self.last = [None; QUANTITIES.len()];
        self.equal = [0; QUANTITIES.len()];
        self.faulty_until = [f64::NEG_INFINITY; QUANTITIES.len()];
        for sensor in &mut self.report.sensors {
            (sensor.fault, sensor.jumped) = (None, false);
        }
    }

    fn fault(
        &mut self,
        index: usize,
        now: &Measured,
        last: Option<&Measured>,
        motion: CommandedMotion,
    ) -> Option<Fault> {
        if now.quantity == Quantity::Deformation && now.value[0].abs() >= self.bounds.deformation {
            return Some(Fault::Saturated);
        }
        let last = last?;
        let changes = match now.quantity {
            Quantity::Deformation | Quantity::TipAcceleration => {
                motion.jerk.abs() > MOVING * self.bounds.limits.jerk
            }
            _ => motion.velocity.abs() > MOVING * self.bounds.limits.velocity,
        };
        self.equal[index] = match now.value == last.value {
            true => self.equal[index] + u32::from(changes),
            false => 0,
        };
        if self.equal[index] >= STUCK {
            return Some(Fault::Stuck);
        }
        self.jumps(now, last, motion.step).then_some(Fault::Jump)
    }

    fn jumps(&self, now: &Measured, last: &Measured, commanded: f64) -> bool {
        let step: f64 = (0..3).map(|i| (now.value[i] - last.value[i]).powi(2)).sum();
        let farthest = JUMP * self.bounds.limits.velocity * elapsed(now, last) + commanded;
        match now.quantity {
            Quantity::TipPosition => step.sqrt() > farthest * self.bounds.radius,
            Quantity::TipAcceleration => false,
            _ => step.sqrt() > farthest + 2.0 * self.bounds.resolution,
        }
    }
}

/// Time between two samples, s. Where the stamps do not go on it is that between their receptions.
fn elapsed(now: &Measured, last: &Measured) -> f64 {
    match now.stamp <= last.stamp {
        true => now.received - last.received,
        false => now.stamp - last.stamp,
    }
}

fn is_finite(measured: &Measured) -> bool {
    measured.stamp.is_finite() && measured.value.iter().all(|value| value.is_finite())
}
