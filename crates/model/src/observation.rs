//! From a recording to an experiment: which channel drives the model, and which ones it predicts.

use super::chain::MotorSide;
use super::differentiated;
use super::experiment::{Experiment, Output};
use super::gain;
use super::known::{Equation, Known};
use super::output::output;
use super::piecewise::{Grid, Hold, RADIANS_A_STEP, left_out};
use super::predict::predict_windows;
use super::windows::{unseen, windows};
use super::{Departure, ExperimentError, Model, Term};
use quell_recording::{Channel, Recording, Role};
use quell_signal::{integrated_velocity, noise_floor};

/// Length of a long step, in normal ones. For a linear chain the classical Runge-Kutta method is exact for
/// another chain, whose frequency is wrong by `0.5^4 / 120 = 5e-4`: a fit with long steps finds that chain.
pub(super) const LONG: f64 = 2.0;

/// Share of a force that its means over the steps may leave out: the typical size of a law of the catalogue.
const LEFT_OUT: f64 = 0.1;

/// Largest ratio of a knot distance to its nominal value, since knots are samples.
pub(super) const LONGEST: f64 = 1.3;

/// Largest share of the steps, or samples, that may remain for a reduction to be worth it.
pub(super) const SPARED: f64 = 0.7;
/// Standard deviations of a natural frequency's belief within which it is looked for, and the least relative step.
const BELIEVED: f64 = 3.0;
const FINEST: f64 = 0.005;

impl Experiment {
    /// The recording as the model sees it; the grid is fine enough for the believed mode.
    ///
    /// # Errors
    /// [`ExperimentError`] where the recording has no channel that can drive the model, none that it
    /// predicts, or too few samples.
    pub fn new(model: &Model, recording: &Recording) -> Result<Self, ExperimentError> {
        Self::of(model, recording.clone())
    }

    /// [`Self::new`] for a recording that is not needed any more: its samples are not copied.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(model: &Model, mut recording: Recording) -> Result<Self, ExperimentError> {
        recording
            .channels
            .iter_mut()
            .for_each(Channel::unwrap_turns);
        let input = Self::input(model, &recording)?;
        let input_smoothed = match model.kind.differentiates {
            true => differentiated::smooth(&mut recording, input, model.kind.outputs),
            false => None,
        };
        let mut gain = gain::unify(&mut recording);
        if gain.is_none() && is_prescribed(model, recording.channels[input].role) {
            gain = gain::of_deformation(&mut recording);
        }
        let position_unit = position_unit(model, &recording, recording.channels[input].role);
        let equation = Equation {
            input: recording.channels[input].role,
            input_unit: &recording.channels[input].unit,
            position_unit: &position_unit,
        };
        let known = Known::of(model, &recording, &equation)?;
        let force_unit = equation.force(model, &recording);
        let (mut input, input_walk) = motor_side(recording.channels.remove(input))?;
        let hold = model.hold.unwrap_or((model.kind.hold)(input.role));
        let step = RADIANS_A_STEP / (model.fastest() * hastened(model, input.role, &known));
        let mut experiment = Self {
            grid: Grid::new(&input.time, &input.columns[0], hold, step)?,
            input: input.role,
            input_time: input.time,
            input_values: input.columns.swap_remove(0),
            input_walk,
            input_smoothed,
            hold,
            outputs: Vec::new(),
            initial: [0.0; 4],
            windows: Vec::new(),
            coupling: None,
            known,
            position_unit,
            input_unit: input.unit,
            force_unit,
            payload: recording.payload,
            recording: 0,
        };
        for channel in recording.channels {
            let wanted = model.kind.outputs.contains(&channel.role);
            if wanted && channel.role != experiment.input {
                let mut output = output(model, &experiment, (&recording.name, channel))?;
                if input_walk.is_some() && output.role.is_position() {
                    output.drifts();
                }
                if let Some(gain) = gain.take_if(|(gain, _)| gain.channel == output.channel) {
                    output.scaled_by(gain);
                }
                output.keep_within(experiment.span());
                experiment.outputs.push(output);
            }
        }
        if experiment.outputs.is_empty() {
            return Err(ExperimentError::NothingPredicted {
                recording: recording.name,
                kind: model.kind.name,
                outputs: names(model.kind.outputs),
            });
        }
        experiment.measure_start((model.kind.linear)(&model.keys(), input.role).motor);
        experiment.windows = windows(model, &experiment);
        let unseen: Vec<[f64; 2]> = unseen(model, &experiment).collect();
        let outputs = experiment.outputs.iter_mut();
        outputs.for_each(|output| unseen.iter().for_each(|gap| output.leave_out(*gap)));
        let _ = experiment.refine_gain(model);
        experiment.smoothen(model);
        Ok(experiment)
    }

    /// Refines an unknown gain with the model's prediction, if the motor side is prescribed: this includes the
    /// link's deformation. Returns the model that predicted it: of a gain that only a model tells, the one at the
    /// natural frequency around its own that the reading follows most closely.
    pub fn refine_gain(&mut self, model: &Model) -> Model {
        let known = self.outputs.iter().all(|output| output.gain.is_none());
        if known || !is_prescribed(model, self.input) {
            return model.clone();
        }
        let model = match self.outputs.iter().position(Output::is_of_any_size) {
            Some(output) => self.in_step(model, output),
            None => model.clone(),
        };
        let predicted = self.predicted(&model, &model.terms());
        for (output, predicted) in self.outputs.iter_mut().zip(predicted) {
            output.refine_gain(predicted);
        }
        model
    }

    /// The model at the natural frequency around its own at which an output follows its prediction most closely. At
    /// another one a vibration that lasts is soon out of step, and a gain too small.
    fn in_step(&self, model: &Model, output: usize) -> Model {
        let free = model.kind.mode.filter(|(key, _)| !model.values[*key].fixed);
        let Some((key, damping)) = free else {
            return model.clone();
        };
        let (own, ratio) = (&model.values[key], model.values[damping].value);
        let spread = own
            .std
            .map_or(model.kind.keys[key].belief, |std| std / own.value);
        // Half of the half-power width, within which a vibration stays in step while it lasts.
        let step = ratio.max(FINEST);
        let steps = (BELIEVED * spread / step).ceil() as i32;
        let at = |k: i32| {
            let mut other = model.clone();
            other.values[key].value *= (f64::from(k) * step).exp();
            let predicted = self.predicted(&other, &other.terms());
            (self.outputs[output].follows(&predicted[output]), other)
        };
        let best = (-steps..=steps).map(at).max_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| model.clone(), |best| best.1)
    }

    /// The same with long steps, halved so many times, for a search that fits the keys with them; `None` where that saves none.
    #[must_use]
    pub fn in_long_steps(&self, model: &Model, halved: i32) -> Option<Self> {
        let step = self.longest_step(model) * 0.5f64.powi(halved);
        let (hold, length) = match self.hold {
            Hold::ZeroOrder | Hold::Linear => (Hold::Mean(step), step),
            hold => (hold, LONGEST * step),
        };
        let grid = Grid::new(&self.input_time, &self.input_values, hold, length).ok()?;
        let spared = (grid.input.len() as f64) < SPARED * self.grid.input.len() as f64;
        spared.then(|| {
            let mut long = self.clone();
            long.hold = hold;
            long.set_grid(grid);
            long
        })
    }

    /// The longest step of a search, s. Within one a force does not change by more than the laws that act on it.
    fn longest_step(&self, model: &Model) -> f64 {
        let (from, until) = self.span();
        let mut step = (LONG * RADIANS_A_STEP / self.fastest(model)).min(until - from);
        let is_force = matches!(self.hold, Hold::ZeroOrder | Hold::Linear);
        while is_force && left_out(&self.input_time, &self.input_values, step) > LEFT_OUT {
            step *= 0.5;
        }
        step
    }

    /// The prediction of each output, with the first guess of its clock.
    pub(super) fn predicted(&self, model: &Model, terms: &[Term]) -> Vec<Vec<f64>> {
        let clocks: Vec<f64> = self.outputs.iter().map(|o| o.clock_offset).collect();
        let start = &[Departure::default()];
        let all = predict_windows(model.kind, &model.keys(), terms, self, start, &clocks);
        all.into_iter().map(|one| one.values).collect()
    }

    /// Fastest angular frequency of the chain, rad/s, at the least known inertia, with its coupling.
    pub(super) fn fastest(&self, model: &Model) -> f64 {
        let own = model.fastest() * hastened(model, self.input, &self.known);
        self.coupling
            .as_ref()
            .map_or(own, |coupling| own.max(coupling.rate))
    }

    /// Index of the channel that drives the model.
    fn input(model: &Model, recording: &Recording) -> Result<usize, ExperimentError> {
        let of = |role| recording.channels.iter().position(|c| c.role == role);
        let mut roles = model.kind.inputs.iter();
        let found = roles.find_map(|&role| of(role).filter(|_| model.takes(role)));
        found.ok_or_else(|| ExperimentError::NoInput {
            recording: recording.name.clone(),
            kind: model.kind.name,
            inputs: names(model.kind.inputs),
        })
    }

    /// Sets the start of the chain: the first samples of its sensors, for a motor side or a link that the input
    /// does not prescribe. A link on a prescribed motor side starts at rest on it.
    fn measure_start(&mut self, motor: MotorSide) {
        let first = |role| {
            let mut outputs = self.outputs.iter();
            outputs.find(|o| o.role == role).map(|o| o.values[0])
        };
        let (motor_position, link) = (first(Role::MotorPosition), first(Role::LinkPosition));
        let deformation = first(Role::Deformation);
        self.initial = match motor {
            MotorSide::Prescribed => [0.0; 4],
            MotorSide::Fixed => [0.0, 0.0, link.or(deformation).unwrap_or(0.0), 0.0],
            MotorSide::Free { .. } => {
                let start = motor_position.or(link).unwrap_or(0.0);
                let bent = deformation.or(link.map(|link| link - start));
                [
                    start,
                    first(Role::MotorVelocity).unwrap_or(0.0),
                    bent.unwrap_or(0.0),
                    0.0,
                ]
            }
        };
    }
}

/// Factor of a known inertia on the fastest natural frequency of a model.
fn hastened(model: &Model, input: Role, known: &Known) -> f64 {
    let keys = model.keys();
    let newton = (model.kind.newton)(&keys).unwrap_or(0.0);
    known.hastens(&(model.kind.linear)(&keys, input), newton)
}

/// The unit of positions: that of the first channel that is a position and is input or predicted, or that of a
/// velocity. Where none is a position, that of what is predicted.
fn position_unit(model: &Model, recording: &Recording, input: Role) -> String {
    let is_one = |channel: &&Channel| {
        let role = channel.role;
        let predicted = role != input && model.kind.outputs.contains(&role);
        predicted && role != Role::MotorVelocity || role.is_position()
    };
    let is_place = |channel: &&Channel| {
        let role = channel.role;
        is_one(channel) && role.is_motion() && !role.is_acceleration()
    };
    let channels = || recording.channels.iter();
    let position = channels()
        .find(is_place)
        .or_else(|| channels().find(is_one));
    let velocity = recording.channel(Role::MotorVelocity);
    match (position, velocity) {
        (Some(channel), _) => channel.unit.clone(),
        (None, Some(velocity)) if velocity.unit == "m/s" => "m".into(),
        _ => "rad".into(),
    }
}

/// The motion of a motor side, and of one of which only the velocity was measured the noise that each interval adds.
fn motor_side(channel: Channel) -> Result<(Channel, Option<f64>), ExperimentError> {
    if channel.role != Role::MotorVelocity {
        return Ok((channel, None));
    }
    let (time, velocity) = (&channel.time, &channel.columns[0]);
    let last = time.len() - 1;
    let interval = (time[last] - time[0]) / last.max(1) as f64;
    let noise = noise_floor(velocity).standard_deviation;
    Ok((integrated_velocity(&channel)?, Some(noise * interval)))
}

fn names(roles: &[Role]) -> String {
    roles
        .iter()
        .map(|role| role.name())
        .collect::<Vec<_>>()
        .join(", ")
}

/// Whether the motor side is known, driven by this input.
fn is_prescribed(model: &Model, input: Role) -> bool {
    (model.kind.linear)(&model.keys(), input).motor == MotorSide::Prescribed
}
