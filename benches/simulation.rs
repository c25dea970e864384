//! Cost of one simulation: the linear joint, and each law of the catalogue as a ratio to it.
//!
//! `cargo bench --bench simulation`: 13 s of moves at 250 Hz on a joint of 8 Hz, all at their typical
//! sizes. Times are the least of many runs.

use quell::effects::{CandidateStop, EFFECTS, LEARNED, Law, Memory, Place, Scales};
use quell::model::chain::{Chain, ForceElement, FrictionElement};
use quell::model::{FurtherModes, Grid, Hold, Kind, Timed, integrate};
use quell::recording::Role;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

const RATE: f64 = 250.0;
const SECONDS: f64 = 13.0;
const FREQUENCY_HZ: f64 = 8.2;
const RUNS: usize = 300;
/// More nodes than a motion has beside those of its grid.
const MOST_EVENTS: usize = 10_000;

/// Jerk-free at its ends.
fn smooth_move(t: f64, duration: f64) -> f64 {
    let s = (t / duration).clamp(0.0, 1.0);
    s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)))
}

fn grid() -> Grid {
    let n = (SECONDS * RATE) as usize;
    let time: Vec<f64> = (0..=n).map(|k| k as f64 / RATE).collect();
    // A move of 0.3 s every 1.3 s, there and back.
    let position = |t: &f64| -> f64 {
        let moves = (0..10).map(|k| (k, smooth_move(t - 1.3 * f64::from(k), 0.3)));
        moves.map(|(k, s)| if k % 2 == 0 { s } else { -s }).sum()
    };
    let values: Vec<f64> = time.iter().map(position).collect();
    let step = 0.15 / (TAU * FREQUENCY_HZ);
    Grid::new(&time, &values, Hold::Spline, step).unwrap()
}

fn scales() -> Scales {
    Scales {
        deformation: 0.05,
        deformation_rate: 2.0,
        position: (0.0, 1.0),
        velocity: 7.0,
        acceleration: 80.0,
        force: 0.05,
        input: 1.0,
        natural_frequency: TAU * FREQUENCY_HZ,
        damping_ratio: 0.06,
        span: (0.0, SECONDS),
        sample_time: 1.0 / RATE,
        candidate_events: vec![4.0],
        candidate_frequencies: vec![TAU * 20.0],
        candidate_orders: vec![30.0],
        candidate_stops: vec![CandidateStop::at(0.5, 1.0)],
        ..Scales::default()
    }
}

/// A chain, what happens to it, and what it drives.
type Machine = (Chain, Timed, FurtherModes);

/// A machine with a law; none where the law is outside it.
fn machine(law: Option<(Law, Place)>) -> Option<Machine> {
    let joint = Kind::from_name("flexible_joint").unwrap();
    let keys = [FREQUENCY_HZ, 0.06, 1.0, 0.0];
    let mut chain = Chain::new((joint.linear)(&keys, Role::MotorPosition));
    let (mut timed, mut modes) = (Timed::default(), FurtherModes::default());
    match law {
        None => {}
        Some((Law::Force(law), place)) => {
            timed.breaks = law.breaks();
            let memory = Memory::default();
            chain.forces.push(ForceElement { place, law, memory });
        }
        Some((Law::Friction(law), place)) => chain.frictions.push(FrictionElement {
            place,
            law,
            slides: 0.0,
        }),
        Some((Law::Inertia(inertia), _)) => {
            timed.breaks = inertia.breaks();
            chain.inertias.push(inertia);
        }
        Some((Law::Kinematic(error), _)) => chain.kinematics.push(error),
        Some((Law::Resonance(mode), _)) => modes.laws.push(mode),
        Some((Law::Impulse(impulse), _)) => timed.impulses.push(impulse),
        Some((Law::Drive(_) | Law::Sensor(_), _)) => return None,
    }
    Some((chain, timed, modes))
}

/// Least time of a simulation, s.
fn time(grid: &Grid, build: impl Fn() -> Option<Machine>) -> Option<f64> {
    let still = vec![[0.0; 2]; grid.time.len() + MOST_EVENTS];
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let (mut chain, timed, modes) = build()?;
        let start = Instant::now();
        let trace = black_box(integrate(&mut chain, grid, [0.0; 4], &timed));
        if !modes.laws.is_empty() {
            let nodes = 0..=trace.time.len() - 1;
            black_box(modes.seen(&trace, nodes, (&still, 0), &mut modes.start()));
        }
        least = least.min(start.elapsed().as_secs_f64());
    }
    Some(least)
}

fn main() {
    let grid = grid();
    let steps = grid.input.len() as f64;
    let Some(linear) = time(&grid, || machine(None)) else {
        return;
    };
    let tell = |name: &str, place: &str, time: f64| {
        println!(
            "{name:28} {place:14} {:7.1} us {:6.1} ns a step {:6.2}",
            1e6 * time,
            1e9 * time / steps,
            time / linear
        );
    };
    tell("linear", "", linear);
    for effect in EFFECTS.iter().chain(LEARNED) {
        for &place in effect.places.iter().filter(|&&place| place != Place::Drive) {
            let scales = scales();
            let values = effect.parameters.iter().map(|p| (p.typical)(&scales));
            let values: Vec<f64> = values.collect();
            if let Some(time) = time(&grid, || machine(Some(((effect.law)(&values), place)))) {
                tell(effect.name, place.name(), time);
            }
        }
    }
}
