//! Where a sensor of the tip stands and how its clock reads: learned from the first moves that it
//! sees, off the tick.

use std::sync::mpsc::{Receiver, channel};

use nalgebra::Point3;
use quell_shapers::Mode;

use super::Engine;
use crate::service::contract::{Measured, Quantity};
use crate::service::tick::ToTick;
use crate::signal::{
    ArcRegistration, CubicSpline, DeformationSensor, End, JointArc, SignalError, register_arc,
};

/// Seconds of samples that are learned from, at least, and at most twice that: a few moves, with the
/// rest between them.
const KEPT: f64 = 10.0;
/// Difference of the radius that the points choose from the description's, as a share, from which on
/// people are told: the deformation is wrong by the same share.
const WRONG_RADIUS: f64 = 0.05;

/// The registration, or the reason why there is none.
type Learned = Result<ArcRegistration, SignalError>;

/// Collects what encoder and tip sensor say until the frame of the sensor is known.
#[derive(Debug, Default)]
pub struct Registrar {
    motor: (Vec<f64>, Vec<f64>),
    tip: (Vec<f64>, Vec<Point3<f64>>),
    working: Option<Receiver<Learned>>,
    told: bool,
}

impl Registrar {
    /// Takes a measurement that was not refused.
    pub fn take(&mut self, measured: &Measured) {
        let value = measured.value;
        match measured.quantity {
            Quantity::MotorPosition => keep(&mut self.motor, measured.stamp, value[0]),
            Quantity::TipPosition => keep(&mut self.tip, measured.stamp, Point3::from(value)),
            _ => {}
        }
    }

    /// Whether a sensor of the tip has said anything.
    pub fn sees_the_tip(&self) -> bool {
        !self.tip.0.is_empty()
    }

    /// Begins to learn from what there is, on a thread of its own: it takes longer than the engine
    /// may be away. Does nothing while it is at work, or where no tip was seen.
    fn begin(&mut self, arc: JointArc, belief: Mode) {
        if self.working.is_some() || !self.sees_the_tip() {
            return;
        }
        let (motor, tip) = (self.motor.clone(), self.tip.clone());
        let (tell, hear) = channel();
        let learn = move || {
            let learned = CubicSpline::new(&motor.0, &motor.1, End::NotAKnot)
                .and_then(|motor| register_arc(&arc, &motor, &tip.0, &tip.1, Some(belief)));
            // The engine may have ended meanwhile.
            let _ = tell.send(learned);
        };
        let thread = std::thread::Builder::new().name("quell-register".into());
        match thread.spawn(learn) {
            Ok(_) => self.working = Some(hear),
            Err(error) => tracing::warn!("the tip's sensor cannot be registered now: {error}"),
        }
    }

    /// The registration, once it is learned.
    fn finished(&mut self) -> Option<Learned> {
        let learned = self.working.as_ref()?.try_recv().ok()?;
        self.working = None;
        Some(learned)
    }
}

/// Keeps a sample; a stamp that is not younger than the last is of a clock that has started anew.
fn keep<T>((stamps, values): &mut (Vec<f64>, Vec<T>), stamp: f64, value: T) {
    if stamps.last().is_some_and(|last| stamp <= *last) {
        stamps.clear();
        values.clear();
    }
    if stamps
        .first()
        .is_some_and(|first| stamp - first > 2.0 * KEPT)
    {
        let old = stamps.partition_point(|t| stamp - t > KEPT);
        stamps.drain(..old);
        values.drain(..old);
    }
    stamps.push(stamp);
    values.push(value);
}

impl Engine {
    /// A move has rung out: learns from it where the tip's sensor stands, if that is not known.
    pub(super) fn begin_registration(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        let Some(registrar) = &mut joint.registrar else {
            return;
        };
        match joint.config.arc {
            Some(arc) => registrar.begin(arc, joint.mode),
            None if registrar.sees_the_tip() && !registrar.told => {
                registrar.told = true;
                tracing::warn!(
                    joint = joint.config.name,
                    "tip_position is of no use without a description of the robot, which says where \
                     the tip goes"
                );
            }
            None => {}
        }
    }

    /// Hands a sensor that has been registered to the tick.
    pub(super) fn end_registration(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        let learned = joint.registrar.as_mut().and_then(Registrar::finished);
        let (Some(learned), Some(arc)) = (learned, joint.config.arc) else {
            return;
        };
        let found = match learned {
            Ok(found) => found,
            Err(error) => {
                let joint = &joint.config.name;
                tracing::warn!(joint, "the tip's sensor waits for a longer move: {error}");
                return;
            }
        };
        let sensor = DeformationSensor::new(arc, found.sensor_to_base, found.clock);
        let order = ToTick::Sensor(index, Box::new(sensor.clone()));
        self.rings.orders.push(order);
        (joint.sensor, joint.registrar) = (sensor, None);
        tracing::info!(
            joint = joint.config.name,
            clock_offset_s = found.clock.offset,
            noise_m = found.normal_rms,
            "the tip's sensor is registered"
        );
        if (found.fitted_radius / arc.radius() - 1.0).abs() > WRONG_RADIUS {
            tracing::warn!(
                joint = joint.config.name,
                seen_m = found.fitted_radius,
                described_m = arc.radius(),
                "the tip's distance from the axis is not as described"
            );
        }
    }
}
