//! From a channel to an output of the model. A tip position becomes the angle about the joint's axis.

use super::chain::MotorSide;
use super::circle::{Circle, frame_columns};
use super::experiment::{Experiment, Output};
use super::gain::{Gain, slope};
use super::regression::Regression;
use super::tangent::along_tangent;
use super::{ExperimentError, Model};
use nalgebra::Point3;
use quell_recording::{Channel, Role};
use quell_shapers::Mode;
use quell_signal::{CubicSpline, End, JointArc, noise_floor, register_arc};
use std::f64::consts::{PI, TAU};

/// Fewest samples of an output.
const FEWEST: usize = 10;

/// The channel of a recording of this name as an output.
pub(super) fn output(
    model: &Model,
    experiment: &Experiment,
    (recording, mut channel): (&str, Channel),
) -> Result<Output, ExperimentError> {
    if channel.role == Role::TipPosition {
        return tip(model, experiment, channel);
    }
    let arm = model.value("lever_arm_m").unwrap_or(1.0);
    let (mut scale, mut unit) = (1.0, channel.unit);
    let in_metres = unit == "m" || unit == "m/s^2";
    if in_metres && experiment.position_unit == "rad" || channel.role == Role::TipAcceleration {
        let values = channel.columns.iter_mut().flatten();
        values.for_each(|value| *value /= arm);
        scale = arm;
    }
    let several = channel.columns.split_off(1);
    let values = channel.columns.swap_remove(0);
    if unit == "1" {
        unit = String::new();
    }
    // Forces move this motor side from a start that is free, or that its loop holds: an offset of its encoder is an
    // offset of the machine. A free offset would take the place of a constant force, and shift what depends on the
    // position.
    let motor = (model.kind.linear)(&model.keys(), experiment.input).motor;
    let moved = matches!(motor, MotorSide::Free { .. }) && channel.role == Role::MotorPosition;
    let columns = match moved {
        true => Vec::new(),
        false => vec![vec![1.0; values.len()]],
    };
    let mut output = Output {
        role: match channel.role {
            Role::TipAcceleration => Role::LinkAcceleration,
            role => role,
        },
        channel: channel.role,
        columns,
        witness: Vec::new(),
        radius: None,
        direction: Vec::new(),
        gain: None,
        own_clock: !on_one_clock(model, experiment, &channel.time),
        time: channel.time,
        values,
        scale,
        unit,
        clock_offset: 0.0,
        noise_witness: None,
        coordinate_step: None,
    };
    if !several.is_empty() {
        let columns = [vec![std::mem::take(&mut output.values)], several].concat();
        (output.values, output.direction) =
            along_tangent(model, experiment, (&output, &columns), recording)?;
    }
    Ok(output)
}

/// Whether an output shares the clock of the input. A torque that is given at some of the stamps of a motion
/// shares it, too.
fn on_one_clock(model: &Model, experiment: &Experiment, time: &[f64]) -> bool {
    let held = (model.kind.linear)(&model.keys(), experiment.input).held_inertia > 0.0;
    let mut all = experiment.input_time.iter();
    let mut within = || time.iter().all(|stamp| all.any(|own| own == stamp));
    time == experiment.input_time || held && within()
}

/// The angle of a tip that a tracker follows in a frame of its own.
///
/// Plane, circle and angle come from [`register_arc`]. An error of the circle's centre shows along the arc as
/// `sin` and `cos` of the angle. Both are free coefficients, with the radial coordinate as prior information
/// ([`Circle`]).
fn tip(
    model: &Model,
    experiment: &Experiment,
    channel: Channel,
) -> Result<Output, ExperimentError> {
    let arm = model.value("lever_arm_m").unwrap_or(1.0);
    let arc = JointArc::from_lever_arm(arm, model.value("tip_height_m").unwrap_or(0.0))?;
    let points: Vec<Point3<f64>> = (0..channel.time.len())
        .map(|k| {
            Point3::new(
                channel.columns[0][k],
                channel.columns[1][k],
                channel.columns[2][k],
            )
        })
        .collect();
    let motor = CubicSpline::new(
        &experiment.input_time,
        &experiment.input_values,
        End::NotAKnot,
    )?;
    let belief = model
        .mode()
        .and_then(|(f, xi)| Mode::from_hertz(f, xi.min(0.9)).ok());
    let registration = register_arc(&arc, &motor, &channel.time, &points, belief)?;
    let frame = registration.sensor_to_base;
    let (mut angle, mut radius) = (Vec::new(), Vec::new());
    let (mut turns, mut last) = (0.0, 0.0);
    for (k, point) in points.iter().enumerate() {
        let p = frame * point;
        let raw = p.y.atan2(p.x);
        if k > 0 && (raw + turns - last).abs() > PI {
            turns -= ((raw + turns - last) / TAU).round() * TAU;
        }
        last = raw + turns;
        angle.push(last);
        radius.push(p.x.hypot(p.y));
    }
    let turn = ((motor.value(experiment.input_time[0]) - angle[0]) / TAU).round() * TAU;
    angle.iter_mut().for_each(|a| *a += turn);
    let step = coordinate_step(&channel.columns);
    let moved = channel.time.iter();
    let (first, last) = motor.span();
    let moved = moved.map(|time| (time - registration.clock.offset).clamp(first, last));
    let motion = moved.map(|time| (motor.derivative(time), motor.second_derivative(time)));
    let (speed, acceleration): (Vec<f64>, Vec<f64>) = motion.unzip();
    let arc = [&angle[..], &radius];
    let motion = [&speed[..], &acceleration];
    let circle = Circle::new(&channel.time, arc, motion, arm, step.unwrap_or(0.0));
    Ok(Output {
        role: Role::LinkPosition,
        channel: Role::TipPosition,
        time: channel.time,
        witness: circle.as_ref().map_or_else(Vec::new, Circle::witness),
        radius: circle.map(|circle| circle.radius),
        direction: Vec::new(),
        gain: None,
        columns: frame_columns(&angle),
        values: angle,
        scale: arm,
        unit: "m".into(),
        own_clock: true,
        clock_offset: registration.clock.offset,
        noise_witness: Some(registration.normal_rms / arm),
        coordinate_step: step.map(|step| step / arm),
    })
}

/// Root mean square of the steps of the rounded coordinates. Along an arc the error is as large as that of
/// each.
fn coordinate_step(coordinates: &[Vec<f64>]) -> Option<f64> {
    let steps = coordinates
        .iter()
        .filter_map(|own| noise_floor(own).quantisation);
    let squares: Vec<f64> = steps.map(|step| step * step).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    (!squares.is_empty()).then(|| mean.sqrt())
}

impl Output {
    /// Drops samples outside of the input's time range, unless that leaves too few.
    pub(super) fn keep_within(&mut self, (first, last): (f64, f64)) {
        let at = |instant: f64| instant + self.clock_offset;
        let from = self.time.partition_point(|stamp| *stamp < at(first));
        let to = self.time.partition_point(|stamp| *stamp <= at(last));
        if to.saturating_sub(from) < FEWEST.min(self.time.len()) {
            return;
        }
        let cut = |values: &mut Vec<f64>| {
            values.truncate(to);
            values.drain(..from);
        };
        [&mut self.time, &mut self.values].into_iter().for_each(cut);
        self.columns.iter_mut().for_each(cut);
    }

    /// Drops the samples between two instants.
    pub(super) fn leave_out(&mut self, [from, to]: [f64; 2]) {
        let at = |instant: f64| instant + self.clock_offset;
        let first = self.time.partition_point(|stamp| *stamp <= at(from));
        let last = self
            .time
            .partition_point(|stamp| *stamp < at(to))
            .max(first);
        let cut = |values: &mut Vec<f64>| drop(values.drain(first..last));
        [&mut self.time, &mut self.values].into_iter().for_each(cut);
        self.columns.iter_mut().for_each(cut);
    }

    /// Frees a drift at a constant rate: the zero of the velocity whose integral drives the model is not known.
    pub(super) fn drifts(&mut self) {
        self.columns.push(self.time.clone());
        self.witness
            .iter_mut()
            .for_each(|(weights, _)| weights.push(0.0));
    }

    /// Frees the remaining error of a gain. Errors are reported in the unit of the reading.
    pub(super) fn scaled_by(&mut self, (gain, motor): (Gain, Vec<f64>)) {
        self.columns.push(motor);
        self.scale *= gain.value.abs();
        self.unit.clone_from(&gain.unit);
        self.gain = Some(gain);
    }

    /// Whether only a model tells its gain.
    pub(super) fn is_of_any_size(&self) -> bool {
        self.gain.is_some() && self.channel == Role::Deformation
    }

    /// How closely it follows a prediction, whatever its gain: the slope over its standard deviation, squared.
    pub(super) fn follows(&self, predicted: &[f64]) -> f64 {
        let slope = Regression::on(&[predicted]).and_then(|on| on.slope(&self.values));
        slope.map_or(0.0, |slope| {
            slope.value * slope.value / slope.variance.max(f64::MIN_POSITIVE)
        })
    }

    /// Refines an unknown gain with a prediction, which becomes the column of the remaining error.
    pub(super) fn refine_gain(&mut self, predicted: Vec<f64>) {
        let (Some(gain), Some(column)) = (&mut self.gain, self.columns.last_mut()) else {
            return;
        };
        if let Some(slope) = slope(&[&predicted], &self.values) {
            gain.value *= slope;
            self.scale *= slope.abs();
            self.values.iter_mut().for_each(|value| *value /= slope);
            *column = predicted;
        }
    }

    /// The same sensor with other values, which need no correction of its frame, offset or gain.
    pub fn showing(&self, time: Vec<f64>, values: Vec<f64>) -> Self {
        let columns = match (self.channel, &self.gain) {
            (Role::TipPosition, _) => frame_columns(&values),
            (_, Some(_)) => vec![vec![1.0; values.len()], values.clone()],
            (_, None) => vec![vec![1.0; values.len()]; self.columns.len()],
        };
        let witness = self.witness.iter();
        Self {
            witness: witness.map(|(weights, _)| (weights.clone(), 0.0)).collect(),
            time,
            values,
            columns,
            unit: self.unit.clone(),
            gain: self.gain.clone(),
            direction: self.direction.clone(),
            ..*self
        }
    }
}
