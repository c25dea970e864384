//! The predictions of a model at the stamps of the sensors.

use super::chain::{Chain, ForceElement, FrictionElement, MotorSide, State};
use super::coupling::Pull;
use super::departure::{
    Departure,
    StartComponent::{Deformation, DeformationRate, MotorPosition, MotorVelocity},
};
use super::experiment::{Experiment, Output};
use super::further_modes::FurtherModes;
use super::integrate::{Restart, Timed, integrate, integrate_in_parts};
use super::piecewise::Grid;
use super::reading::{Eyes, Prediction, Reader};
use super::start::start;
use super::trace::{Kinematics, Trace};
use super::{Kind, Model};
use crate::effects::{Drive, Effect, Law, Memory, Place, Resonance, Sensor};
use std::borrow::Cow;
use std::sync::Arc;

/// An effect at a place with values of its parameters.
#[derive(Clone)]
pub struct Term {
    /// The effect.
    pub effect: &'static Effect,
    /// The place.
    pub place: Place,
    /// Its parameters.
    pub values: Vec<f64>,
    /// The [recording](Experiment::recording) of a set in which it happened; `None` for an effect of the
    /// machine.
    pub recording: Option<usize>,
}

impl Term {
    /// An effect of the machine.
    pub fn new(effect: &'static Effect, place: Place, values: Vec<f64>) -> Self {
        Self {
            effect,
            place,
            values,
            recording: None,
        }
    }

    /// The same in one recording only.
    pub fn in_recording(self, recording: Option<usize>) -> Self {
        Self { recording, ..self }
    }

    /// Effect and place.
    pub fn identity(&self) -> (&'static Effect, Place) {
        (self.effect, self.place)
    }

    /// Whether it changes anything: with a neutral size the motion is identical to that without it.
    pub fn acts(&self) -> bool {
        !self.effect.vanishes(&self.values)
    }

    /// Whether it changes anything in an experiment.
    pub fn acts_in(&self, experiment: &Experiment) -> bool {
        self.recording.is_none_or(|own| own == experiment.recording) && self.acts()
    }

    /// The value of its size.
    pub fn size(&self) -> f64 {
        self.values[self.effect.size()]
    }
}

/// A simulated experiment.
pub struct Simulated {
    /// The motion at the nodes.
    pub trace: Arc<Trace>,
    eyes: Eyes,
}

/// Nodes of a part of a motion: at 64 bytes each a megabyte, which fits in a core's cache.
const PART: usize = 16_384;

/// A prepared experiment.
struct Ready<'a> {
    chain: Chain,
    grid: Cow<'a, Grid>,
    state: State,
    timed: Timed,
    eyes: Eyes,
}

/// Simulates an experiment for values of the kind's keys, effects, and a departure from the measured start.
pub fn simulate(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departure: &Departure,
) -> Simulated {
    simulate_windows(
        kind,
        keys,
        terms,
        experiment,
        std::slice::from_ref(departure),
    )
}

/// [`simulate`] with a departure for each window of the experiment, from its measured start. The further modes'
/// departures count in the first window only.
pub fn simulate_windows(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departures: &[Departure],
) -> Simulated {
    let mut ready = ready(kind, keys, terms, experiment, departures);
    let trace = integrate(&mut ready.chain, &ready.grid, ready.state, &ready.timed);
    Simulated {
        trace: Arc::new(trace),
        eyes: ready.eyes,
    }
}

/// The outputs of [`simulate_windows`], each with its clock's offset, identical to the bit. The motion itself
/// is not kept, so that memory is needed for the outputs only.
pub fn predict_windows(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departures: &[Departure],
    clocks: &[f64],
) -> Vec<Prediction> {
    let ready = ready(kind, keys, terms, experiment, departures);
    predict_in_parts(ready, &experiment.outputs, clocks, PART)
}

/// Passes the motion of [`simulate`] part by part.
pub fn see_motion(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departure: &Departure,
    mut see: impl FnMut(&Trace),
) {
    let departures = std::slice::from_ref(departure);
    let mut own = ready(kind, keys, terms, experiment, departures);
    let see = |trace: &Trace, _: bool| see(trace);
    integrate_in_parts(&mut own.chain, &own.grid, own.state, &own.timed, PART, see);
}

fn predict_in_parts(
    mut ready: Ready,
    outputs: &[Output],
    clocks: &[f64],
    nodes: usize,
) -> Vec<Prediction> {
    let pairs = outputs.iter().zip(clocks);
    let mut readers: Vec<Reader> = pairs
        .map(|(output, &clock)| Reader::new(&ready.eyes, output, clock))
        .collect();
    let see = |trace: &Trace, last: bool| {
        for reader in &mut readers {
            reader.read(trace, last);
        }
    };
    let (chain, grid) = (&mut ready.chain, &ready.grid);
    integrate_in_parts(chain, grid, ready.state, &ready.timed, nodes, see);
    readers.into_iter().map(Reader::end).collect()
}

/// Chain, grid, start and sensors for values of the keys, effects and departures.
fn ready<'a>(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &'a Experiment,
    departures: &[Departure],
) -> Ready<'a> {
    super::tally::count();
    let linear = (kind.linear)(keys, experiment.input);
    let mut chain = Chain::new(linear);
    let (mut sensors, mut laws, mut drives) = (Vec::new(), Vec::new(), Vec::new());
    let mut timed = Timed::default();
    for term in terms {
        if !term.acts_in(experiment) {
            continue;
        }
        add(
            (term.effect.law)(&term.values),
            term.place,
            &mut chain,
            (&mut sensors, &mut laws, &mut drives),
            &mut timed,
        );
    }
    // A known quantity needs the force of a newton. An experiment whose keys do not give it was refused before.
    experiment
        .known
        .act_on(&mut chain, (kind.newton)(keys).unwrap_or(0.0));
    if chain.linear.position_loop.is_some() {
        // An effect with a memory acts on the reference; one without acts between the loop and the force.
        let (maps, late) = drives.into_iter().partition(|drive| drive.is_static());
        (chain.maps, drives) = (maps, late);
    }
    let grid = grid(experiment, &drives);
    if let Some(coupling) = &experiment.coupling {
        chain.pull = Some(Pull::new(coupling.over(&grid, &sensors), &grid));
    }
    let mut departures = departures.iter().copied();
    let (state, modes) = start(
        &mut chain,
        &grid,
        experiment,
        &departures.next().unwrap_or_default(),
    );
    for window in &experiment.windows {
        let departure = departures.next().unwrap_or_default();
        let at = |k: usize, component| window.state[k] + departure[component];
        let (u, v) = (at(0, MotorPosition), at(1, MotorVelocity));
        let (d, rate) = (at(2, Deformation), at(3, DeformationRate));
        timed.restarts.push(Restart {
            time: window.time,
            state: [u, v, u + d, v + rate],
        });
    }
    let modes = FurtherModes {
        laws,
        link_gain: chain.linear.link_gain,
        ..modes
    };
    let eyes = Eyes {
        sensors,
        modes,
        prescribed: chain.linear.motor != MotorSide::Fixed,
        elastic: chain.linear.link.is_some(),
    };
    Ready {
        chain,
        grid,
        state,
        timed,
        eyes,
    }
}

/// What is outside the chain: sensors, further modes, the drive.
type Outside<'a> = (
    &'a mut Vec<Box<dyn Sensor>>,
    &'a mut Vec<Resonance>,
    &'a mut Vec<Box<dyn Drive>>,
);

fn add(
    law: Law,
    place: Place,
    chain: &mut Chain,
    (sensors, modes, drives): Outside<'_>,
    timed: &mut Timed,
) {
    match law {
        Law::Force(law) => {
            timed.breaks.extend(law.breaks());
            let memory = Memory::default();
            chain.forces.push(ForceElement { place, law, memory });
        }
        Law::Friction(law) => chain.frictions.push(FrictionElement {
            place,
            law,
            slides: 0.0,
        }),
        Law::Drive(drive) => drives.push(drive),
        Law::Kinematic(error) => chain.kinematics.push(error),
        Law::Inertia(inertia) => {
            timed.breaks.extend(inertia.breaks());
            chain.inertias.push(inertia);
        }
        Law::Resonance(mode) => modes.push(mode),
        Law::Impulse(impulse) => timed.impulses.push(impulse),
        Law::Sensor(sensor) => sensors.push(sensor),
    }
}

/// The experiment's own grid, or one with the effects of the drive in the input.
fn grid<'a>(experiment: &'a Experiment, drives: &[Box<dyn Drive>]) -> Cow<'a, Grid> {
    if drives.is_empty() {
        return Cow::Borrowed(&experiment.grid);
    }
    let mut values = experiment.input_values.clone();
    for drive in drives {
        drive.run(&experiment.input_time, &mut values);
    }
    let step = experiment.grid.step() * (1.0 + 1e-9);
    match Grid::new(&experiment.input_time, &values, experiment.hold, step) {
        Ok(grid) => Cow::Owned(grid),
        Err(_) => Cow::Borrowed(&experiment.grid),
    }
}

impl Simulated {
    /// The same motion, seen by the sensors and with the further modes of these effects in an
    /// experiment.
    pub fn read_by(&self, terms: &[Term], experiment: &Experiment) -> Self {
        let (mut sensors, mut laws) = (Vec::new(), Vec::new());
        for term in terms.iter().filter(|term| term.acts_in(experiment)) {
            match (term.effect.law)(&term.values) {
                Law::Sensor(sensor) => sensors.push(sensor),
                Law::Resonance(mode) => laws.push(mode),
                _ => {}
            }
        }
        let modes = FurtherModes {
            laws,
            ..self.eyes.modes.clone()
        };
        Self {
            trace: Arc::clone(&self.trace),
            eyes: Eyes {
                sensors,
                modes,
                ..self.eyes
            },
        }
    }

    /// Motor side and link at the stamps of a sensor whose clock reads `offset` seconds too much, by
    /// straight lines between the nodes.
    pub fn kinematics(&self, stamps: &[f64], offset: f64) -> (Vec<Kinematics>, Vec<Kinematics>) {
        let time = &self.trace.time;
        let last = time.len() - 1;
        let at = |series: &[Kinematics], stamp: f64| {
            let t = (stamp - offset).clamp(time[0], time[last]);
            let k = time.partition_point(|node| *node <= t).clamp(1, last) - 1;
            let s = (t - time[k]) / (time[k + 1] - time[k]);
            std::array::from_fn(|i| series[k][i] + s * (series[k + 1][i] - series[k][i]))
        };
        let motor = stamps.iter().map(|&t| at(&self.trace.motor, t)).collect();
        let link = stamps.iter().map(|&t| at(&self.trace.link, t)).collect();
        (motor, link)
    }

    /// The output's readings when its clock reads `offset` seconds too much.
    pub fn predict(&self, output: &Output, offset: f64) -> Prediction {
        let mut reader = Reader::new(&self.eyes, output, offset);
        reader.read(&self.trace, true);
        reader.end()
    }
}

impl Model {
    /// The model's effects with their numbers.
    pub fn terms(&self) -> Vec<Term> {
        let term = |effect: &super::ModelEffect| {
            let values = effect.parameters.iter().map(|p| p.value).collect();
            Term::new(effect.effect, effect.place, values)
        };
        self.effects.iter().map(term).collect()
    }

    /// Values of the keys.
    pub fn keys(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.value).collect()
    }
}
