//! From motor position and registered tip position to the deformation of the joint.

use nalgebra::{Isometry3, Point3};

use super::{Aligner, Clock, JointArc, Measurement};

/// Deformation of a joint whose motor side is at `u` and whose tip is at `p` in the base frame, rad.
///
/// `delta = J . (p - FK(u)) / |J|^2` with `J = dFK/du`. For a tip that stays on its arc this is
/// `sin delta`: low by `delta^3 / 6`, 5 nrad at 3 mrad.
pub fn deformation(arc: &JointArc, motor_position: f64, tip: &Point3<f64>) -> f64 {
    let jacobian = arc.tangent(motor_position);
    jacobian.dot(&(tip - arc.tip(motor_position))) / jacobian.norm_squared()
}

/// Deformation at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeformationSample {
    /// Instant on the controller's clock, s.
    pub time: f64,
    /// Motor-side position `u`, rad.
    pub motor_position: f64,
    /// `delta = y - u` at the joint, rad.
    pub deformation: f64,
    /// The same along the tip's arc, `delta |J|`, m.
    pub tip_deformation: f64,
}

/// On-line: encoder and tip measurements in the order of arrival become deformation samples.
///
/// It accepts a sensor of the tip, of the link position or of the deformation itself, and does not
/// allocate, block or fail.
#[derive(Clone, Debug)]
pub struct DeformationSensor {
    aligner: Aligner,
    arc: JointArc,
    sensor_to_base: Isometry3<f64>,
}

impl DeformationSensor {
    /// A sensor whose frame lies in the robot's base frame as `sensor_to_base` says, on `clock`.
    pub fn new(arc: JointArc, sensor_to_base: Isometry3<f64>, clock: Clock) -> Self {
        Self {
            aligner: Aligner::new(clock),
            arc,
            sensor_to_base,
        }
    }

    /// Takes a measurement; afterwards call [`next_sample`](Self::next_sample) until it is `None`.
    pub fn observe(&mut self, measurement: Measurement) {
        self.aligner.observe(measurement);
    }

    /// The next deformation sample, once the encoder brackets its instant.
    pub fn next_sample(&mut self) -> Option<DeformationSample> {
        loop {
            let aligned = self.aligner.next_aligned()?;
            let u = aligned.motor_position;
            let deformation = match aligned.measurement {
                Measurement::TipPosition { position, .. } => {
                    let tip = self.sensor_to_base * Point3::from(position);
                    deformation(&self.arc, u, &tip)
                }
                Measurement::LinkPosition { position, .. } => position - u,
                Measurement::Deformation { deformation, .. } => deformation,
                Measurement::MotorPosition { .. } => continue,
            };
            return Some(DeformationSample {
                time: aligned.time,
                motor_position: u,
                deformation,
                tip_deformation: deformation * self.arc.radius(),
            });
        }
    }

    /// The arc of the tip, in the base frame.
    pub fn arc(&self) -> &JointArc {
        &self.arc
    }

    /// Replaces the arc, as after another joint has changed the pose.
    pub fn set_arc(&mut self, arc: JointArc) {
        self.arc = arc;
    }

    /// Replaces frame and clock, as after a new registration.
    pub fn set_registration(&mut self, sensor_to_base: Isometry3<f64>, clock: Clock) {
        self.sensor_to_base = sensor_to_base;
        self.aligner.set_clock(clock);
    }

    /// The aligner within.
    pub fn aligner(&self) -> &Aligner {
        &self.aligner
    }

    /// Forgets every sample.
    pub fn restart(&mut self) {
        self.aligner.restart();
    }
}
