//! Registration of a tip sensor's frame and clock from the first moves that it sees, off the tick.

use std::sync::mpsc::{Receiver, channel};

use nalgebra::Point3;
use quell_shapers::Mode;

use super::Engine;
use crate::service::contract::{Measured, Quantity};
use crate::service::tick::ToTick;
use crate::signal::{
    ArcRegistration, CubicSpline, DeformationSensor, End, JointArc, SignalError, register_arc,
};

/// Seconds of samples for the registration, at least, and at most twice that: a few moves, with the rest
/// between them.
const KEPT: f64 = 10.0;
/// Relative difference of the fitted radius from the description's above which a warning is given: the
/// deformation is wrong by the same share.
const WRONG_RADIUS: f64 = 0.05;

/// The registration, or the reason why there is none.
type Learned = Result<ArcRegistration, SignalError>;

/// Collects samples of encoder and tip sensor until the frame of the sensor is known.
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

    /// Whether any sample of a tip sensor has arrived.
    pub fn sees_the_tip(&self) -> bool {
        !self.tip.0.is_empty()
    }

    /// Starts the registration on a thread of its own, since it would block the engine for too long. Does
    /// nothing while it is running, or without tip samples.
    fn begin(&mut self, arc: JointArc, belief: Mode) {
        if self.working.is_some() || !self.sees_the_tip() {
            return;
        }
        let (motor, tip) = (self.motor.clone(), self.tip.clone());
        let (tell, hear) = channel();
        let learn = move || {
            let learned = CubicSpline::new(&motor.0, &motor.1, End::NotAKnot)
                .and_then(|motor| register_arc(&arc, &motor, &tip.0, &tip.1, Some(belief)));
            // The engine may have ended in the meantime.
            let _ = tell.send(learned);
        };
        let thread = std::thread::Builder::new().name("quell-register".into());
        match thread.spawn(learn) {
            Ok(_) => self.working = Some(hear),
            Err(error) => tracing::warn!("the tip's sensor cannot be registered now: {error}"),
        }
    }

    /// The registration, once it is finished.
    fn finished(&mut self) -> Option<Learned> {
        let learned = self.working.as_ref()?.try_recv().ok()?;
        self.working = None;
        Some(learned)
    }
}

/// Keeps a sample; a stamp that is not newer than the last means that the clock was restarted.
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
    /// Starts a registration after a move, if the frame of the tip's sensor is not known.
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

    /// Hands a registered sensor to the tick.
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
