//! From motor position and registered tip position to the deformation of the joint.

use nalgebra::{Isometry3, Point3};
use quell_shapers::Mode;

use super::arc_registration::ArcRegistration;
use super::tip_registration::TipRegistration;
use super::{Aligner, Clock, CubicSpline, End, JointArc, Measurement, SignalError};
use quell_recording::{Channel, Recording, Role};

/// Deformation of a joint whose motor side is at `u` and whose tip is at `p` in the base frame, rad.
///
/// `delta = J . (p - FK(u)) / |J|^2` with `J = dFK/du`. For a tip that stays on its arc this is
/// `sin delta`: low by `delta^3 / 6`, 5 nrad at 3 mrad.
pub fn deformation(arc: &JointArc, motor_position: f64, tip: &Point3<f64>) -> f64 {
    let (expected, jacobian) = arc.tip_and_tangent(motor_position);
    jacobian.dot(&(tip - expected)) / jacobian.norm_squared()
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

/// On-line sensor of the deformation: turns encoder and tip measurements, in the order of arrival, into
/// deformation samples.
///
/// It accepts a sensor of the tip, of the link position or of the deformation itself, and does not allocate,
/// block or fail. If the tip's arc is not known, a sensor of the tip is ignored, and the
/// deformation along the arc is NaN.
#[derive(Clone, Debug)]
pub struct DeformationSensor {
    aligner: Aligner,
    arc: Option<JointArc>,
    sensor_to_base: Isometry3<f64>,
}

impl DeformationSensor {
    /// A sensor with the frame `sensor_to_base` in the robot's base frame, on `clock`.
    pub fn new(arc: JointArc, sensor_to_base: Isometry3<f64>, clock: Clock) -> Self {
        Self {
            aligner: Aligner::new(clock),
            arc: Some(arc),
            sensor_to_base,
        }
    }

    /// A sensor of a joint whose tip's arc is not known, on `clock`.
    pub fn without_arc(clock: Clock) -> Self {
        Self {
            aligner: Aligner::new(clock),
            arc: None,
            sensor_to_base: Isometry3::identity(),
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
                    let Some(arc) = &self.arc else { continue };
                    let tip = self.sensor_to_base * Point3::from(position);
                    deformation(arc, u, &tip)
                }
                Measurement::LinkPosition { position, .. } => position - u,
                Measurement::Deformation { deformation, .. } => deformation,
                Measurement::MotorPosition { .. } => continue,
            };
            return Some(DeformationSample {
                time: aligned.time,
                motor_position: u,
                deformation,
                tip_deformation: self.arc.map_or(f64::NAN, |arc| deformation * arc.radius()),
            });
        }
    }

    /// The arc of the tip, in the base frame, where it is known.
    pub fn arc(&self) -> Option<&JointArc> {
        self.arc.as_ref()
    }

    /// Discards every sample.
    pub fn restart(&mut self) {
        self.aligner.restart();
    }
}

/// Deformation over a whole recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedDeformation {
    /// Samples at the stamps of the sensor of the tip, link or deformation, those within the
    /// encoder's span; times on the encoder's clock.
    pub samples: Vec<DeformationSample>,
    /// Frame and clock of the tip sensor, if the recording has one and they were determined from it.
    pub registration: Option<ArcRegistration>,
}

/// Deformation over a recording, from whichever sensor it has beside the motor position: the
/// deformation itself, the link position, or the tip.
///
/// A tip sensor needs the tip's `arc`; its frame and clock are determined from the recording itself, in the
/// requested way. A deformation in m is divided by the arc's radius. Without an arc the tip deformation is NaN.
///
/// # Errors
/// [`SignalError`] where a channel is missing or bad, or the registration fails.
pub fn recorded_deformation(
    recording: &Recording,
    arc: Option<&JointArc>,
    belief: Option<Mode>,
    registration: TipRegistration,
) -> Result<RecordedDeformation, SignalError> {
    let missing = |channel| SignalError::MissingChannel {
        recording: recording.name.clone(),
        channel,
    };
    let motor = recording
        .channel(Role::MotorPosition)
        .ok_or_else(|| missing("motor_position"))?;
    let motor = CubicSpline::new(&motor.time, scalar(motor, &missing)?, End::NotAKnot)?;
    if let Some(channel) = recording.channel(Role::Deformation) {
        let scale = match (channel.unit.as_str(), arc) {
            ("m", Some(arc)) => 1.0 / arc.radius(),
            ("m", None) => {
                return Err(missing(
                    "deformation in rad; one in m takes a model with lever_arm_m (--model FILE)",
                ));
            }
            _ => 1.0,
        };
        let values = scalar(channel, &missing)?;
        let at = |k: usize, _: f64| scale * values[k];
        return Ok(unregistered(&motor, &channel.time, arc, at));
    }
    if let Some(channel) = recording.channel(Role::LinkPosition) {
        let values = scalar(channel, &missing)?;
        let at = |k: usize, u: f64| values[k] - u;
        return Ok(unregistered(&motor, &channel.time, arc, at));
    }
    let channel = recording
        .channel(Role::TipPosition)
        .ok_or_else(|| missing("deformation, link_position or tip_position"))?;
    let arc = arc.ok_or_else(|| {
        missing("link_position; tip_position alone takes a model with lever_arm_m (--model FILE)")
    })?;
    let tip = points(channel, &missing)?;
    let registration = registration.register(arc, &motor, &channel.time, &tip, belief)?;
    let samples = tip_deformation(arc, &registration, &motor, &channel.time, &tip);
    Ok(RecordedDeformation {
        samples,
        registration: Some(registration),
    })
}

/// Deformation samples from tip positions in the sensor's frame, once frame and clock are known.
pub fn tip_deformation(
    arc: &JointArc,
    registration: &ArcRegistration,
    motor: &CubicSpline,
    stamps: &[f64],
    tip: &[Point3<f64>],
) -> Vec<DeformationSample> {
    let instants: Vec<f64> = stamps.iter().map(|&t| registration.clock.time(t)).collect();
    let at = |k: usize, u: f64| deformation(arc, u, &(registration.sensor_to_base * tip[k]));
    unregistered(motor, &instants, Some(arc), at).samples
}

fn unregistered(
    motor: &CubicSpline,
    time: &[f64],
    arc: Option<&JointArc>,
    deformation: impl Fn(usize, f64) -> f64,
) -> RecordedDeformation {
    let (first, last) = motor.span();
    let inside = time
        .iter()
        .enumerate()
        .filter(|(_, t)| (first..=last).contains(*t));
    let samples = inside.map(|(k, &time)| {
        let motor_position = motor.value(time);
        let deformation = deformation(k, motor_position);
        let tip_deformation = arc.map_or(f64::NAN, |arc| deformation * arc.radius());
        DeformationSample {
            time,
            motor_position,
            deformation,
            tip_deformation,
        }
    });
    RecordedDeformation {
        samples: samples.collect(),
        registration: None,
    }
}

fn scalar<'a>(
    channel: &'a Channel,
    missing: &impl Fn(&'static str) -> SignalError,
) -> Result<&'a [f64], SignalError> {
    let values = channel
        .columns
        .first()
        .ok_or_else(|| missing("with a column"))?;
    super::spline::check_series("channel", &channel.time, values)?;
    Ok(values)
}

fn points(
    channel: &Channel,
    missing: &impl Fn(&'static str) -> SignalError,
) -> Result<Vec<Point3<f64>>, SignalError> {
    let [x, y, z] = channel.columns.as_slice() else {
        return Err(missing("tip_position with three columns"));
    };
    for column in [x, y, z] {
        super::spline::check_series("tip_position", &channel.time, column)?;
    }
    Ok(x.iter()
        .zip(y)
        .zip(z)
        .map(|((x, y), z)| Point3::new(*x, *y, *z))
        .collect())
}
