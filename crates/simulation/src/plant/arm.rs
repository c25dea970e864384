//! The simulated arm: commands in, measurements out, the truth for reports.

use arrayvec::ArrayVec;
use quell_shapers::Mode;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::axis::{Axis, MAX_MODES};
use super::error::SimulationError;
use super::options::{SimulationOptions, not_negative, oscillators};
use super::robot::Robot;
use quell_signal::{JointArc, Measurement};

/// Tolerance, s, within which a sensor sample after the end of a period still belongs to it, so that rates that
/// divide one another keep their order in spite of rounding.
const SAME_INSTANT: f64 = 1e-9;

/// Target of the joint at the end of a control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Position, rad.
    pub position: f64,
    /// Velocity, rad/s. With it the command is interpolated by a cubic, without it by a straight line.
    pub velocity: Option<f64>,
}

/// A payload and the modes that the joint has with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    payload: f64,
    modes: ArrayVec<Mode, MAX_MODES>,
}

impl Load {
    /// Mass of the payload, kg.
    pub fn payload(&self) -> f64 {
        self.payload
    }

    /// The dominating mode; none for a stiff joint.
    pub fn mode(&self) -> Option<Mode> {
        self.modes.first().copied()
    }
}

/// One joint of a robot that moves, vibrates and is measured; the other joints stand still.
///
/// Time starts at 0 on the controller's clock, which is also the encoder's. The same robot, options
/// and commands give the same measurements to the bit.
#[derive(Clone, Debug)]
pub struct ArmSimulation {
    robot: Robot,
    joint: usize,
    pose: Vec<f64>,
    payload: f64,
    reference: ArrayVec<Mode, MAX_MODES>,
    axis: Axis,
    arc: JointArc,
    time: f64,
    encoder_samples: u64,
    tracker_samples: u64,
    tracker_phase: f64,
    tracker_noise: f64,
    random: ChaCha8Rng,
    measurements: Vec<Measurement>,
}

impl ArmSimulation {
    /// `joint` (counted from 0) of `robot`, at rest.
    ///
    /// # Errors
    /// [`SimulationError`] where the joint does not turn the tip, or an option is out of its range.
    pub fn new(
        robot: &Robot,
        joint: usize,
        options: &SimulationOptions,
    ) -> Result<Self, SimulationError> {
        let pose = options.pose.clone().unwrap_or_else(|| robot.home());
        let arc = robot.arc(&pose, joint)?;
        let oscillators = oscillators(robot, joint, options)?;
        let tracker_noise = not_negative(
            "tracker_noise",
            options.tracker_noise.unwrap_or(robot.tracker.noise),
        )?;
        let mut random = ChaCha8Rng::seed_from_u64(options.seed);
        let drawn = random.random_range(0.0..1.0) / robot.tracker.rate;
        let tracker_phase = not_negative("tracker_phase", options.tracker_phase.unwrap_or(drawn))?;
        let start = pose.get(joint).copied().unwrap_or(0.0);
        let mut arm = Self {
            joint,
            payload: not_negative("payload", options.payload)?,
            reference: oscillators.iter().map(|o| o.mode).collect(),
            axis: Axis::at_rest(robot.servo, oscillators, start),
            robot: robot.clone(),
            pose,
            arc,
            time: 0.0,
            encoder_samples: 0,
            tracker_samples: 0,
            tracker_phase,
            tracker_noise,
            random,
            measurements: Vec::with_capacity(64),
        };
        arm.update_modes()?;
        Ok(arm)
    }

    /// Advances by one control period (s) and returns the measurements in it, in the order of their instants,
    /// each stamped on its sensor's own clock.
    ///
    /// The command leads from the end of the last one to `command`. A command that is not finite holds the last
    /// position; a period that is not a finite number above 0 does nothing.
    pub fn step(&mut self, command: Command, period: f64) -> &[Measurement] {
        self.measurements.clear();
        if !(period.is_finite() && period > 0.0) {
            return &self.measurements;
        }
        let [last, _] = self.axis.command();
        let finite = command.position.is_finite() && command.velocity.is_none_or(f64::is_finite);
        let Command { position, velocity } = if finite {
            command
        } else {
            Command {
                position: last,
                velocity: Some(0.0),
            }
        };
        self.axis.begin_period(position, velocity, period);
        let end = self.time + period;
        loop {
            let encoder = self.encoder_samples as f64 / self.robot.encoder.rate;
            let tracker = self.tracker_instant();
            let next = encoder.min(tracker);
            if next > end + SAME_INSTANT {
                break;
            }
            self.advance_to(next.min(end));
            if encoder <= tracker {
                self.read_encoder(encoder);
            } else {
                self.read_tracker(tracker);
            }
        }
        self.advance_to(end);
        self.axis.end_period(position, velocity);
        &self.measurements
    }

    /// The measurements that the last [`step`](Self::step) returned.
    pub fn last_measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    fn advance_to(&mut self, time: f64) {
        self.axis.advance(time - self.time);
        self.time = self.time.max(time);
    }

    /// Instant of the tracker's next sample on the controller's clock; its rate is that of its own clock.
    fn tracker_instant(&self) -> f64 {
        let period = 1.0 / (self.robot.tracker.rate * (1.0 + self.robot.tracker.clock.skew));
        self.tracker_phase + self.tracker_samples as f64 * period
    }

    fn read_encoder(&mut self, time: f64) {
        self.encoder_samples += 1;
        let step = self.robot.encoder.resolution;
        let [u, _] = self.axis.motor();
        let position = if step > 0.0 {
            (u / step).round() * step
        } else {
            u
        };
        self.measurements
            .push(Measurement::MotorPosition { time, position });
    }

    fn read_tracker(&mut self, time: f64) {
        self.tracker_samples += 1;
        let tip = self.robot.tracker.pose.inverse_transform_point(&self.tip());
        let noise = self.tracker_noise;
        let random = &mut self.random;
        let position = [tip.x, tip.y, tip.z].map(|x| {
            let z: f64 = random.sample(StandardNormal);
            x + noise * z
        });
        let time = self.robot.tracker.clock.stamp(time);
        self.measurements
            .push(Measurement::TipPosition { time, position });
    }

    /// Changes the payload (kg, a point at the tip); the joint's motion is continuous.
    ///
    /// # Errors
    /// [`SimulationError::Option`] where it is negative or not finite.
    pub fn set_payload(&mut self, payload: f64) -> Result<(), SimulationError> {
        let load = self.load(payload)?;
        self.carry(load);
        Ok(())
    }

    /// The joint's modes with a payload (kg) at the present pose, for [`carry`](Self::carry). Allocates.
    ///
    /// # Errors
    /// As [`set_payload`](Self::set_payload).
    pub fn load(&self, payload: f64) -> Result<Load, SimulationError> {
        let payload = not_negative("payload", payload)?;
        let modes = self.modes_with(payload)?;
        Ok(Load { payload, modes })
    }

    /// Changes the payload; the joint's motion is continuous. Does not allocate.
    pub fn carry(&mut self, load: Load) {
        self.payload = load.payload;
        self.axis.set_modes(load.modes);
    }

    /// Sets the deformation (rad) and its velocity (rad/s) of the first mode, as for a free decay.
    pub fn set_deformation(&mut self, deformation: f64, velocity: f64) {
        self.axis.set_deformation(deformation, velocity);
    }

    fn update_modes(&mut self) -> Result<(), SimulationError> {
        let modes = self.modes_with(self.payload)?;
        self.axis.set_modes(modes);
        Ok(())
    }

    fn modes_with(&self, payload: f64) -> Result<ArrayVec<Mode, MAX_MODES>, SimulationError> {
        let mut modes = ArrayVec::new();
        for &reference in &self.reference {
            let robot = &self.robot;
            modes.push(robot.mode_at(reference, self.joint, &self.pose, payload)?);
        }
        Ok(modes)
    }

    /// Time on the controller's clock, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The moved joint, counted from 0.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// The arc of the tip about the moved joint, in the base frame.
    pub fn arc(&self) -> &JointArc {
        &self.arc
    }

    /// Truth: the dominating mode at the present pose and payload; none for a stiff joint.
    pub fn true_mode(&self) -> Option<Mode> {
        self.true_modes().next()
    }

    /// Truth: all modes at the present pose and payload.
    pub fn true_modes(&self) -> impl Iterator<Item = Mode> + '_ {
        self.axis.oscillators().iter().map(|o| o.mode)
    }

    /// Truth: motor position, rad.
    pub fn true_motor_position(&self) -> f64 {
        self.axis.motor()[0]
    }

    /// Truth: deformation of the joint, rad.
    pub fn true_deformation(&self) -> f64 {
        self.axis.deformation()[0]
    }

    /// Truth: link position, rad.
    pub fn true_link_position(&self) -> f64 {
        self.true_motor_position() + self.true_deformation()
    }

    /// Truth: deformation along the tip's arc, m.
    pub fn true_tip_deformation(&self) -> f64 {
        self.true_deformation() * self.arc.radius()
    }

    fn tip(&self) -> nalgebra::Point3<f64> {
        self.arc.tip(self.true_link_position())
    }
}
