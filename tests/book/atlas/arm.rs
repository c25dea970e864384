//! The two machines of the atlas in a standard motion, with an effect in them or without.

use nalgebra::{DMatrix, DVector};
use quell::effects::{
    CandidateStop, Coordinate, EFFECTS, Effect, Law, Place, Quantity, Scales, Units, Visited,
};
use quell::model::{Departure, Experiment, Model, Term, simulate};
use quell::recording::{Channel, Recording, Role};
use quell::signal::SingularValues;
use std::f64::consts::TAU;

const RATE: f64 = 500.0;
const SECONDS: f64 = 5.0;
/// Start, length and travel of each move: large there and back, then small.
pub const MOVES: [[f64; 3]; 4] = [
    [0.2, 0.35, 0.5],
    [1.4, 0.35, -0.5],
    [2.6, 0.35, 0.25],
    [3.8, 0.35, -0.25],
];

/// A machine, and what its sensors show of the motion.
pub struct Arm {
    pub model: Model,
    pub scales: Scales,
    /// What it is called.
    pub name: &'static str,
    /// The same in a word or two.
    pub short: &'static str,
    /// The places of its effects.
    pub places: &'static [Place],
    /// Unit of positions.
    pub unit: &'static str,
    /// One experiment for each sensor.
    pub sensors: Vec<Experiment>,
    /// Keys that a diagnosis refits.
    free: &'static [usize],
}

/// An effect at its typical size, as a sensor sees it.
pub struct Fingerprint {
    /// What is seen with the effect, minus without.
    pub change: DVector<f64>,
    /// What is left of it when the keys of the model and an offset are refitted.
    pub misfit: DVector<f64>,
}

/// A joint of 8 Hz whose motor side is measured, and an axis under a position loop for what the drive does.
pub fn arms() -> [Arm; 2] {
    let joint = Arm::new(
        "flexible joint of 8 Hz, 5 % damping, behind a measured motor side",
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n",
        (Role::MotorPosition, "rad"),
        &[
            (Role::LinkPosition, "rad"),
            (Role::LinkAcceleration, "rad/s^2"),
        ],
        &[0, 1],
    );
    let axis = Arm::new(
        "rigid axis of 10 kg under a position loop",
        "kind = \"rigid_axis\"\nmass = 10.0\nviscous = 50.0\nposition_gain = 60.0\nvelocity_gain = 1000.0\n",
        (Role::CommandPosition, "m"),
        &[(Role::MotorPosition, "m")],
        &[0, 1],
    );
    [
        Arm {
            short: "flexible joint",
            places: &[
                Place::Transmission,
                Place::Link,
                Place::Base,
                Place::Sensor,
                Place::Environment,
            ],
            ..joint
        },
        Arm {
            short: "axis",
            places: &[Place::Drive],
            ..axis
        },
    ]
}

/// Stamps of the samples.
pub fn stamps() -> Vec<f64> {
    (0..(SECONDS * RATE) as usize)
        .map(|k| k as f64 / RATE)
        .collect()
}

/// Position of the moves; velocity, acceleration and jerk vanish at both ends of each.
pub fn position(time: f64) -> f64 {
    let smooth = |s: f64| s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)));
    let moves = MOVES.iter();
    moves
        .map(|[start, length, travel]| travel * smooth(((time - start) / length).clamp(0.0, 1.0)))
        .sum()
}

impl Arm {
    /// Units of the model: its forces are positions where they are divided by the stiffness.
    pub fn units(&self) -> Units {
        let force = match self.model.kind.normalised {
            true => self.unit,
            false => "N",
        };
        Units {
            force: force.into(),
            position: self.unit.into(),
            input: force.into(),
            reference: self.unit.into(),
        }
    }

    /// A name with the unit of its quantity; of a number the name alone.
    pub fn with_unit(&self, name: &str, quantity: Quantity) -> String {
        match quantity.unit(&self.units()).as_str() {
            "1" => name.into(),
            unit => format!("{name}, {unit}"),
        }
    }

    fn new(
        name: &'static str,
        model: &str,
        input: (Role, &str),
        outputs: &[(Role, &str)],
        free: &'static [usize],
    ) -> Self {
        let model = Model::from_toml(model, "model.toml").unwrap();
        let unit = if input.1 == "m" { "m" } else { "rad" };
        let channel = |(role, unit): (Role, &str), values: Vec<f64>| Channel {
            role,
            unit: unit.into(),
            time: stamps(),
            columns: vec![values],
        };
        let sensor = |&output: &(Role, &str)| {
            let moves = stamps().iter().map(|&time| position(time)).collect();
            let channels = vec![
                channel(input, moves),
                channel(output, vec![0.0; stamps().len()]),
            ];
            let recording = Recording {
                payload: None,
                name: "standard motion".into(),
                channels,
            };
            Experiment::new(&model, &recording).unwrap()
        };
        let sensors: Vec<Experiment> = outputs.iter().map(sensor).collect();
        let scales = scales(&model, &sensors[0]);
        Self {
            model,
            scales,
            name,
            short: "",
            places: &[],
            unit,
            sensors,
            free,
        }
    }

    /// The effects that it may have, each at the first of its places that the machine has.
    pub fn effects(&self) -> Vec<(&'static Effect, Place)> {
        let at = |effect: &&'static Effect| {
            let mut places = effect.places.iter().copied();
            Some((*effect, places.find(|place| self.places.contains(place))?))
        };
        EFFECTS.iter().filter_map(at).collect()
    }

    /// The effect at its typical size.
    pub fn typical(&self, (effect, place): (&'static Effect, Place)) -> Term {
        let sized = |scales: &Scales| {
            let values = effect.parameters.iter().map(|own| (own.typical)(scales));
            Term::new(effect, place, values.collect())
        };
        let term = sized(&self.scales);
        match (effect.law)(&term.values) {
            // What depends on the past of its input gets the recorded one: under a loop the command, and not the force.
            Law::Drive(drive) if !drive.is_static() => {
                let input = &self.sensors[0].input_values;
                let input = input.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
                sized(&Scales {
                    input,
                    ..self.scales.clone()
                })
            }
            _ => term,
        }
    }

    /// What a sensor shows for values of the keys and effects.
    pub fn shown(&self, sensor: usize, keys: &[f64], terms: &[Term]) -> DVector<f64> {
        let experiment = &self.sensors[sensor];
        let start = Departure::default();
        let motion = simulate(self.model.kind, keys, terms, experiment, &start);
        DVector::from_vec(motion.predict(&experiment.outputs[0], 0.0).values)
    }

    /// What a sensor shows of an effect.
    pub fn fingerprint(&self, sensor: usize, term: &Term) -> Fingerprint {
        let keys = self.model.keys();
        let change =
            self.shown(sensor, &keys, std::slice::from_ref(term)) - self.shown(sensor, &keys, &[]);
        let misfit = without(&change, &self.refit(sensor));
        Fingerprint { change, misfit }
    }

    /// What a refit of keys and offset can explain.
    pub fn refit(&self, sensor: usize) -> Vec<DVector<f64>> {
        let keys = self.model.keys();
        let here = self.shown(sensor, &keys, &[]);
        let slope = |&key: &usize| {
            let mut moved = keys.clone();
            moved[key] *= 1.0 + 1e-5;
            self.shown(sensor, &moved, &[]) - &here
        };
        let mut columns: Vec<_> = self.free.iter().map(slope).collect();
        columns.push(DVector::repeat(here.len(), 1.0));
        columns
    }

    /// The range of a coordinate that the motion visits.
    pub fn range(&self, coordinate: Coordinate) -> (f64, f64) {
        let visited = &self.scales.visited;
        match coordinate {
            Coordinate::Deformation | Coordinate::Displacement => visited.deformation,
            Coordinate::Speed if self.scales.rigid => visited.motor_velocity,
            Coordinate::Speed => visited.deformation_rate,
            Coordinate::MotorSpeed => visited.motor_velocity,
            Coordinate::Position => self.scales.position,
            Coordinate::Input => visited.input,
            Coordinate::Reading => visited.reading,
            Coordinate::Time => self.scales.span,
        }
    }
}

/// A series without what columns explain of it.
pub fn without(series: &DVector<f64>, columns: &[DVector<f64>]) -> DVector<f64> {
    let scaled: Vec<_> = columns
        .iter()
        .map(|own| own / own.norm().max(f64::MIN_POSITIVE))
        .collect();
    let matrix = DMatrix::from_columns(&scaled);
    let solved = SingularValues::of(&matrix).unwrap().solve(series, 1e-9);
    series - matrix * solved
}

/// How large the motion is without an effect.
fn scales(model: &Model, experiment: &Experiment) -> Scales {
    let keys = model.keys();
    let trace = simulate(model.kind, &keys, &[], experiment, &Departure::default()).trace;
    let of = |value: &dyn Fn(usize) -> f64| -> (f64, f64) {
        let values = (0..trace.time.len()).map(value);
        values.fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let largest = |(low, high): (f64, f64)| high.max(-low);
    let deformation = of(&|k| trace.link[k][0] - trace.motor[k][0]);
    let rate = of(&|k| trace.link[k][1] - trace.motor[k][1]);
    let (position, velocity) = (of(&|k| trace.link[k][0]), of(&|k| trace.link[k][1]));
    let rigid = model.mode().is_none();
    let force = of(&|k| trace.force[k]);
    let (frequency, damping_ratio) = model.mode().unwrap_or((1.0 / 0.35 / TAU, 0.1));
    Scales {
        deformation: if rigid {
            0.01 * (position.1 - position.0)
        } else {
            largest(deformation)
        },
        deformation_rate: if rigid {
            largest(velocity)
        } else {
            largest(rate)
        },
        position,
        velocity: largest(velocity),
        acceleration: largest(of(&|k| trace.link[k][2])),
        force: if rigid {
            largest(force)
        } else {
            largest(deformation)
        },
        // Under a loop a static law of the drive is given a force.
        input: if rigid { largest(force) } else { 0.5 },
        natural_frequency: frequency * TAU,
        damping_ratio,
        span: (0.0, SECONDS),
        sample_time: 1.0 / RATE,
        candidate_events: vec![1.5],
        candidate_frequencies: vec![19.0 * TAU],
        candidate_orders: vec![40.0],
        candidate_stops: vec![CandidateStop::at(0.45, 1.0)],
        rigid,
        visited: Visited {
            deformation,
            deformation_rate: rate,
            motor_position: position,
            motor_velocity: velocity,
            input: if rigid { force } else { position },
            reading: position,
        },
        ..Scales::default()
    }
}
