//! What a model predicts at the stamps of the sensors.

use super::chain::{Chain, ForceElement, FrictionElement, MotorSide, State};
use super::experiment::{Experiment, Output, RADIANS_A_STEP};
use super::integrate::{Kick, Restart, Timed, integrate};
use super::piecewise::Grid;
use super::trace::{Kinematics, Trace, hermite, sloped};
use super::{Kind, Model};
use crate::effects::{Drive, Effect, Law, Memory, Place, Reading, Sensor};
use crate::recording::Role;
use std::borrow::Cow;
use std::sync::Arc;

/// An effect with numbers.
#[derive(Clone)]
pub struct Term {
    /// Which.
    pub effect: &'static Effect,
    /// Where.
    pub place: Place,
    /// Its parameters.
    pub values: Vec<f64>,
}

/// A simulated experiment.
pub struct Simulated {
    /// The motion at the nodes.
    pub trace: Arc<Trace>,
    sensors: Vec<Box<dyn Sensor>>,
    shares: Vec<f64>,
    prescribed: bool,
    /// Whether a link hangs on the motor side.
    elastic: bool,
}

/// What an output shows.
#[derive(Clone, Debug, Default)]
pub struct Prediction {
    /// Values at the stamps, in the unit of the output's values.
    pub values: Vec<f64>,
    /// Their rate of change with time: minus the derivative to the clock's offset.
    pub rates: Vec<f64>,
}

/// Simulates an experiment for values of the kind's keys, effects, and a departure of the start
/// (motor side, its velocity, deformation, its rate, and the same of two further modes) from what was measured.
pub fn simulate(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departure: &[f64; 8],
) -> Simulated {
    simulate_windows(
        kind,
        keys,
        terms,
        experiment,
        std::slice::from_ref(departure),
    )
}

/// [`simulate`] with a departure for each window of the experiment, from what was measured where it
/// starts; those of further modes count in the first alone.
pub fn simulate_windows(
    kind: &Kind,
    keys: &[f64],
    terms: &[Term],
    experiment: &Experiment,
    departures: &[[f64; 8]],
) -> Simulated {
    super::tally::count();
    let linear = (kind.linear)(keys, experiment.input);
    let mut chain = Chain::new(linear);
    let (mut sensors, mut drives, mut timed) = (Vec::new(), Vec::new(), Timed::default());
    for term in terms {
        // An effect whose size is neutral is not there: the baseline is met to the bit.
        if term.values[0] == term.effect.parameters[0].neutral {
            continue;
        }
        add(
            (term.effect.law)(&term.values),
            term.place,
            &mut chain,
            &mut sensors,
            &mut drives,
            &mut timed,
        );
    }
    timed.breaks.sort_by(f64::total_cmp);
    if chain.linear.position_loop.is_some() {
        chain.maps.append(&mut drives);
    }
    let grid = grid(&chain, experiment, &drives);
    let mut departures = departures.iter().copied();
    let state = start(
        &mut chain,
        &grid,
        experiment,
        &departures.next().unwrap_or_default(),
    );
    for window in &experiment.windows {
        let departure = departures.next().unwrap_or_default();
        let [u, v, d, rate] = std::array::from_fn(|k| window.state[k] + departure[k]);
        timed.restarts.push(Restart {
            time: window.time,
            state: [u, v, u + d, v + rate],
        });
    }
    let shares = chain.resonances.iter().map(|mode| mode.share).collect();
    let prescribed = chain.linear.motor != MotorSide::Fixed;
    let trace = integrate(&mut chain, &grid, state, &timed);
    Simulated {
        trace: Arc::new(trace),
        sensors,
        shares,
        prescribed,
        elastic: chain.linear.link.is_some(),
    }
}

fn add(
    law: Law,
    place: Place,
    chain: &mut Chain,
    sensors: &mut Vec<Box<dyn Sensor>>,
    drives: &mut Vec<Box<dyn Drive>>,
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
        Law::Resonance(mode) => chain.resonances.push(mode),
        Law::Impulse { time, size } => timed.kicks.push(Kick { time, size }),
        Law::Sensor(sensor) => sensors.push(sensor),
    }
}

/// The experiment's own grid, or one with the drive's effect in the input or with finer steps.
fn grid<'a>(chain: &Chain, experiment: &'a Experiment, drives: &[Box<dyn Drive>]) -> Cow<'a, Grid> {
    let fastest = chain
        .resonances
        .iter()
        .map(|mode| mode.natural_frequency)
        .fold(0.0, f64::max);
    let coarse = experiment.grid.step();
    // A further mode is smaller than the first; twice the step leaves 16 times the relative error.
    let fine = fastest * coarse > 2.0 * RADIANS_A_STEP;
    if drives.is_empty() && !fine {
        return Cow::Borrowed(&experiment.grid);
    }
    let mut values = experiment.input_values.clone();
    for drive in drives {
        drive.run(&experiment.input_time, &mut values);
    }
    let mut step = coarse * (1.0 + 1e-9);
    while fastest * step > 2.0 * RADIANS_A_STEP * (1.0 + 1e-6) {
        step /= 2.0;
    }
    match Grid::new(&experiment.input_time, &values, experiment.hold, step) {
        Ok(grid) => Cow::Owned(grid),
        Err(_) => Cow::Borrowed(&experiment.grid),
    }
}

/// The state at the first node: at rest in equilibrium on the motor side, and the departure.
fn start(chain: &mut Chain, grid: &Grid, experiment: &Experiment, departure: &[f64; 8]) -> State {
    let mut state = [0.0; size_of::<State>() / size_of::<f64>()];
    let input = grid.input.first().map_or([0.0; 3], |cubic| cubic.at(0.0));
    state[0] = experiment.initial[0] + departure[0];
    state[1] = experiment.initial[1] + departure[1];
    let (motion, _) = chain.motion(grid.time[0], &state, input);
    state[2] = motion.motor[0] + experiment.initial[2];
    state[3] = motion.motor[1] + experiment.initial[3];
    if matches!(chain.linear.motor, MotorSide::Prescribed) {
        state[2] += equilibrium(chain, grid.time[0], &state, input);
        state[3] = motion.motor[1];
    }
    state[2] += departure[2];
    state[3] += departure[3];
    for mode in 0..chain.resonances.len().min(super::chain::RESONANCES) {
        state[4 + 2 * mode] = motion.motor[0] + departure[4 + 2 * mode];
        state[5 + 2 * mode] = motion.motor[1] + departure[5 + 2 * mode];
    }
    state
}

/// Deformation at which nothing accelerates, friction aside: secants from the linear guess.
fn equilibrium(chain: &mut Chain, time: f64, state: &State, input: [f64; 3]) -> f64 {
    if chain.forces.is_empty() {
        return 0.0;
    }
    let frictions = std::mem::take(&mut chain.frictions);
    let stiffness = chain.linear.stiffness;
    let inertia = chain.linear.link.map_or(1.0, |link| link.0);
    let still = [input[0], 0.0, 0.0];
    let pull = |d: f64| {
        let mut state = *state;
        state[2] += d;
        state[3] = 0.0;
        chain.instant(time, &state, still).link * inertia
    };
    let (mut d, mut force) = (0.0, pull(0.0));
    let mut slope = stiffness;
    for _ in 0..20 {
        if force == 0.0 || stiffness == 0.0 {
            break;
        }
        let next = d + force / slope;
        let then = pull(next);
        let secant = (force - then) / (next - d);
        if secant.is_finite() && secant > 0.1 * stiffness {
            slope = secant;
        }
        let done = (next - d).abs() <= 1e-12 * next.abs();
        (d, force) = (next, then);
        if done {
            break;
        }
    }
    chain.frictions = frictions;
    d
}

impl Simulated {
    /// The same motion, read by sensors with these effects.
    pub fn read_by(&self, terms: &[Term]) -> Self {
        let there = |term: &&Term| term.values[0] != term.effect.parameters[0].neutral;
        let laws = terms
            .iter()
            .filter(there)
            .map(|term| (term.effect.law)(&term.values));
        let sensors = laws.filter_map(|law| match law {
            Law::Sensor(sensor) => Some(sensor),
            _ => None,
        });
        Self {
            trace: Arc::clone(&self.trace),
            sensors: sensors.collect(),
            shares: self.shares.clone(),
            ..*self
        }
    }

    /// The quantity that an output measures, at the nodes.
    fn curve(&self, role: Role) -> Vec<[f64; 2]> {
        let trace = &self.trace;
        let first = |k: usize| -> Kinematics {
            let mut seen = trace.link[k];
            for (mode, &share) in self.shares.iter().enumerate() {
                let own = match self.prescribed {
                    true => trace.link[k],
                    false => [0.0; 3],
                };
                for (seen, (further, own)) in
                    seen.iter_mut().zip(trace.modes[k][mode].iter().zip(own))
                {
                    *seen += share * (further - own);
                }
            }
            seen
        };
        let nodes = 0..trace.time.len();
        match role {
            Role::MotorPosition => nodes
                .map(|k| [trace.motor[k][0], trace.motor[k][1]])
                .collect(),
            Role::Deformation => nodes
                .map(|k| {
                    let (seen, motor) = (first(k), trace.motor[k]);
                    [seen[0] - motor[0], seen[1] - motor[1]]
                })
                .collect(),
            Role::LinkVelocity => nodes.map(|k| [first(k)[1], first(k)[2]]).collect(),
            Role::LinkAcceleration => sloped(&trace.time, nodes.map(|k| first(k)[2]).collect()),
            Role::Force | Role::Torque | Role::MotorCurrent | Role::MotorVoltage => {
                sloped(&trace.time, trace.force.clone())
            }
            _ => nodes.map(|k| [first(k)[0], first(k)[1]]).collect(),
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

    /// What the output shows when its clock reads `offset` seconds too much.
    pub fn predict(&self, output: &Output, offset: f64) -> Prediction {
        let time = &self.trace.time;
        let mut curve = self.curve(output.role);
        // An encoder on the motor side is what the sensor of the link is compared with.
        let sensors: &[Box<dyn Sensor>] = match output.role == Role::MotorPosition && self.elastic {
            true => &[],
            false => &self.sensors,
        };
        for sensor in sensors.iter().filter(|sensor| sensor.filters()) {
            sensor.filter(time, &mut curve);
        }
        let last = time.len() - 1;
        let (mut k, relative) = (0, output.role == Role::Deformation);
        let mut prediction = Prediction {
            values: Vec::with_capacity(output.time.len()),
            rates: Vec::with_capacity(output.time.len()),
        };
        for &stamp in &output.time {
            let mut at = stamp - offset;
            for sensor in sensors {
                at = sensor.instant(at);
            }
            // Before and after the record everything stays as it was.
            let inside = at.clamp(time[0], time[last]);
            while k + 2 <= last && time[k + 1] < inside {
                k += 1;
            }
            while k > 0 && time[k] > inside {
                k -= 1;
            }
            let (from, to) = (time[k], time[k + 1]);
            let mut value = hermite(from, to, curve[k], curve[k + 1], inside);
            let s = (inside - from) / (to - from);
            let rate = curve[k][1] + s * (curve[k + 1][1] - curve[k][1]);
            if !sensors.is_empty() {
                let u = |k: usize| [self.trace.motor[k][0], self.trace.motor[k][1]];
                let motor = match relative {
                    true => 0.0,
                    false => hermite(from, to, u(k), u(k + 1), inside),
                };
                for sensor in sensors {
                    value = sensor.read(&Reading {
                        time: inside,
                        value,
                        motor,
                    });
                }
            }
            prediction.values.push(value);
            prediction.rates.push(rate);
        }
        prediction
    }
}

impl Model {
    /// The model's effects with their numbers.
    pub fn terms(&self) -> Vec<Term> {
        let term = |effect: &super::ModelEffect| Term {
            effect: effect.effect,
            place: effect.place,
            values: effect.parameters.iter().map(|p| p.value).collect(),
        };
        self.effects.iter().map(term).collect()
    }

    /// Values of the keys.
    pub fn keys(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.value).collect()
    }
}
