//! The laws of the catalogue in the chain: what the integration makes of them.

use nalgebra::Complex;
use quell::effects::{EFFECTS, Effect, Law, Memory, ParameterRole, Place, Resonance, Scales};
use quell::model::chain::{Chain, ForceElement, FrictionElement};
use quell::model::{FurtherModes, Grid, Hold, Kind, Timed, Trace, integrate};
use quell::recording::Role;
use std::f64::consts::TAU;

const NATURAL_FREQUENCY: f64 = 8.5 * TAU;
const DAMPING_RATIO: f64 = 0.06;
/// Steps of a model: 0.15 rad of its mode.
const STEP: f64 = 0.15 / NATURAL_FREQUENCY;

/// A smooth move from 0 to 1 while `s` goes from 0 to 1.
fn rise(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s.powi(4) * (35.0 - 84.0 * s + 70.0 * s * s - 20.0 * s.powi(3))
}

/// Position of the motor side: moves of several sizes, with rests between them.
fn motor(t: f64) -> f64 {
    let moves = [(0.6, 0.6), (-0.9, 0.8), (0.3, 0.4), (0.5, 0.9), (-0.8, 0.6)];
    let moved = moves
        .iter()
        .enumerate()
        .map(|(k, (size, duration))| size * rise((t - 0.5 - 1.2 * k as f64) / duration));
    0.3 + moved.sum::<f64>()
}

fn grid(step: f64) -> Grid {
    let time: Vec<f64> = (0..=1625).map(|k| 0.004 * f64::from(k)).collect();
    let values: Vec<f64> = time.iter().map(|t| motor(*t)).collect();
    Grid::new(&time, &values, Hold::Spline, step).unwrap()
}

/// The flexible joint, forces divided by its stiffness.
fn joint() -> Chain {
    let joint = Kind::from_name("flexible_joint").unwrap();
    let keys = [NATURAL_FREQUENCY / TAU, DAMPING_RATIO];
    Chain::new((joint.linear)(&keys, Role::MotorPosition))
}

/// A motion, and the further mode that it drives.
type Motion = (Trace, FurtherModes);

/// Simulates the joint with a law, or nothing where the law is not in the chain.
fn simulate(law: Option<(Law, Place)>, grid: &Grid) -> Option<Motion> {
    let (mut chain, mut timed) = (joint(), Timed::default());
    let start = grid.input[0].at(0.0);
    let mut modes = FurtherModes {
        rest: [start[0], 0.0],
        ..FurtherModes::default()
    };
    match law {
        None => {}
        Some((Law::Force(law), place)) => {
            timed.breaks.extend(law.breaks());
            let memory = Memory::default();
            chain.forces.push(ForceElement { place, law, memory });
        }
        Some((Law::Friction(law), place)) => {
            let slides = 0.0;
            chain.frictions.push(FrictionElement { place, law, slides });
        }
        Some((Law::Kinematic(error), _)) => chain.kinematics.push(error),
        Some((Law::Inertia(inertia), _)) => {
            timed.breaks.extend(inertia.breaks());
            chain.inertias.push(inertia);
        }
        Some((Law::Resonance(mode), _)) => modes.laws.push(Resonance { share: 1.0, ..mode }),
        Some((Law::Impulse(impulse), _)) => timed.impulses.push(impulse),
        Some((Law::Drive(_) | Law::Sensor(_), _)) => return None,
    }
    let trace = integrate(&mut chain, grid, [0.0, 0.0, start[0], 0.0], &timed);
    Some((trace, modes))
}

/// Deformation at the samples of the input, and that of the further mode.
fn deformation((trace, modes): &Motion) -> Vec<f64> {
    let mut at_samples = Vec::new();
    let still = vec![[0.0; 2]; trace.time.len()];
    let nodes = 0..=trace.time.len() - 1;
    let seen = modes.seen(trace, nodes, (&still, 0), &mut modes.start());
    let mut further = seen.time.iter().zip(&seen.curve);
    for k in 0..trace.time.len() {
        // Of the nodes at a kick, and where something turns at a sample, the last one.
        let sample = |time: f64| {
            let nearest = (time / 0.004).round();
            ((time / 0.004 - nearest).abs() < 1e-6).then_some(nearest)
        };
        let own = sample(trace.time[k]);
        let next = trace.time.get(k + 1).and_then(|time| sample(*time));
        if own.is_some() && own != next {
            let u = trace.motor[k][0];
            at_samples.push(trace.link[k][0] - u);
            let at = further.find(|(time, _)| **time == trace.time[k]);
            let further = at
                .filter(|_| !modes.laws.is_empty())
                .map_or(u, |at| at.1[0]);
            at_samples.push(further - u);
        }
    }
    at_samples
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

fn scales((base, _): &Motion) -> Scales {
    let nodes = 0..base.time.len();
    let difference = |i: usize| {
        let nodes = nodes.clone();
        largest(nodes.map(move |k| base.link[k][i] - base.motor[k][i]))
    };
    let links = || base.link.iter().map(|link| link[0]);
    let deformation = difference(0);
    Scales {
        deformation,
        deformation_rate: difference(1),
        position: (
            links().fold(f64::MAX, f64::min),
            links().fold(f64::MIN, f64::max),
        ),
        velocity: largest(base.link.iter().map(|link| link[1])),
        acceleration: largest(base.link.iter().map(|link| link[2])),
        force: deformation,
        input: largest(base.motor.iter().map(|motor| motor[0])),
        natural_frequency: NATURAL_FREQUENCY,
        damping_ratio: DAMPING_RATIO,
        span: (0.0, 6.5),
        sample_time: 0.003,
        ..Scales::default()
    }
}

/// Entries of the catalogue behind a measured motor side.
fn behind_the_motor() -> impl Iterator<Item = (&'static Effect, Place)> {
    EFFECTS.iter().flat_map(|effect| {
        let places = effect.places.iter().filter(|place| **place != Place::Drive);
        places.map(|place| (*effect, *place))
    })
}

#[test]
fn steps_are_finer_than_any_noise() {
    let (coarse, fine) = (grid(STEP), grid(STEP / 16.0));
    let scales = scales(&simulate(None, &coarse).unwrap());
    for (effect, place) in behind_the_motor() {
        let typical: Vec<f64> = effect
            .parameters
            .iter()
            .map(|p| (p.typical)(&scales))
            .collect();
        let run = |grid: &Grid| simulate(Some(((effect.law)(&typical), place)), grid);
        let (Some(coarse), Some(fine)) = (run(&coarse), run(&fine)) else {
            continue;
        };
        let error = rms_difference(&deformation(&coarse), &deformation(&fine)) / scales.deformation;
        println!("{} in the {}: {error:.1e}", effect.name, place.name());
        // A tracker of 5 um on a lever of 2 m and deformations of 3 mrad: noise of 8e-4. The error
        // of the classical method at 0.15 rad is 4e-6 a radian where a law is smooth; bristles of a
        // tenth of the deformation are the sharpest law here.
        assert!(
            error < 1e-4,
            "{} in the {}: {error:.1e}",
            effect.name,
            place.name()
        );
    }
}

/// Bristles of the shortest presliding distance, with two of the frictions that are tried: they vibrate at 8
/// and 16 times the mode.
#[test]
fn the_stiffest_bristles_are_resolved() {
    let (coarse, fine) = (grid(STEP), grid(STEP / 64.0));
    let scales = scales(&simulate(None, &coarse).unwrap());
    let effect = Effect::from_name("presliding_hysteresis").unwrap();
    let shortest = (effect.parameters[1].bounds)(&scales).0;
    for size in [0.06, 0.25] {
        let values = [size * scales.force, shortest, 0.0, 0.0, 0.0];
        let run = |grid: &Grid| {
            let law = Some(((effect.law)(&values), Place::Link));
            deformation(&simulate(law, grid).unwrap())
        };
        let error = rms_difference(&run(&coarse), &run(&fine)) / scales.deformation;
        println!("{size}: {error:.1e}");
        assert!(error < 1e-4, "{size}: {error:.1e}");
    }
}

#[test]
fn everything_tried_is_finite_and_seen() {
    let grid = grid(STEP);
    let base = simulate(None, &grid).unwrap();
    let scales = scales(&base);
    let seen = deformation(&base);
    for (effect, place) in behind_the_motor() {
        let corners = (0..1usize << effect.parameters.len()).map(|corner| {
            let value = |(index, p): (usize, &quell::effects::Parameter)| {
                let (low, high) = (p.bounds)(&scales);
                if corner >> index & 1 == 1 { high } else { low }
            };
            effect
                .parameters
                .iter()
                .enumerate()
                .map(value)
                .collect::<Vec<_>>()
        });
        let starts = (effect.starts)(&scales);
        for (values, tried) in starts
            .into_iter()
            .map(|s| (s, true))
            .chain(corners.map(|c| (c, false)))
        {
            let Some(trace) = simulate(Some(((effect.law)(&values), place)), &grid) else {
                break;
            };
            let found = deformation(&trace);
            let change = rms_difference(&found, &seen) / scales.deformation;
            let what = format!(
                "{} in the {} at {values:?}: {change:.1e}",
                effect.name,
                place.name()
            );
            // At a corner of its bounds a stop in which the whole motion lies is faster than this grid: a fit turns back from
            // a motion that diverges.
            let is_stop = effect.index(ParameterRole::Border).is_some();
            let fast = is_stop && !tried;
            assert!(change.is_finite() || fast, "{what}");
            // What happens after the last move need not be seen.
            let time = effect.index(ParameterRole::Time);
            let late = time.is_some_and(|time| values[time] > 6.0);
            assert!(!tried || late || change > 1e-5, "{what}");
        }
    }
}

#[test]
fn neutral_laws_in_the_chain_change_nothing_to_the_bit() {
    let grid = grid(STEP);
    let base = simulate(None, &grid).unwrap();
    let scales = scales(&base);
    for (effect, place) in behind_the_motor() {
        let mut values: Vec<f64> = effect
            .parameters
            .iter()
            .map(|p| (p.typical)(&scales))
            .collect();
        values[effect.size()] = effect.parameters[effect.size()].neutral;
        let law = (effect.law)(&values);
        // What a share of 0 leaves out is up to the output; an impulse of 0 and friction that can hold
        // nothing split steps: a model leaves them out.
        if matches!(law, Law::Resonance(_) | Law::Impulse(_) | Law::Friction(_)) {
            continue;
        }
        let Some(trace) = simulate(Some((law, place)), &grid) else {
            continue;
        };
        let same = deformation(&trace) == deformation(&base);
        assert!(same, "{} in the {}", effect.name, place.name());
    }
}

/// `x'' + 2 xi n x' + n^2 x = n^2 A sin(w t + p)` from rest: what swings with the force, and the mode that makes up for it
/// at the start.
#[test]
fn val_a_harmonic_disturbance_is_the_forced_vibration() {
    let base = deformation(&simulate(None, &grid(STEP)).unwrap());
    let effect = Effect::from_name("harmonic_disturbance").unwrap();
    let (n, xi) = (NATURAL_FREQUENCY, DAMPING_RATIO);
    for (ratio, phase) in [(0.3, 0.0), (1.0, 0.7), (2.5, -2.0)] {
        let (amplitude, w) = (0.01, ratio * n);
        let law = (effect.law)(&[amplitude, w, phase]);
        let shaken = simulate(Some((law, Place::Environment)), &grid(STEP)).unwrap();
        let gain = Complex::new(1.0 - ratio * ratio, 2.0 * xi * ratio).inv() * amplitude;
        let forced = |t: f64| gain * Complex::from_polar(1.0, w * t + phase);
        let turns = n * (1.0 - xi * xi).sqrt();
        let (x, v) = (-forced(0.0).im, -(forced(0.0) * Complex::i() * w).im);
        let expected = |t: f64| {
            let free = x * (turns * t).cos() + (v + xi * n * x) / turns * (turns * t).sin();
            forced(t).im + (-xi * n * t).exp() * free
        };
        let apart = deformation(&shaken).into_iter().zip(&base).step_by(2);
        let errors = apart
            .enumerate()
            .map(|(k, (own, base))| own - base - expected(0.004 * k as f64));
        let error = largest(errors) / gain.norm();
        assert!(error < 1e-3, "{ratio}: {error:.1e}");
    }
}

/// Lagrange's equations of a joint with a load on a string, `y` the link, `phi` the load's angle over `a`: both
/// accelerations solved from the 2 x 2 mass matrix.
fn hung([y, v, phi, rate]: [f64; 4], t: f64, [mass, w, damping, tilt]: [f64; 4]) -> [f64; 4] {
    let a = w * w * tilt;
    let (sin, cos) = (a * phi).sin_cos();
    let slope = (motor(t + 1e-5) - motor(t - 1e-5)) / 2e-5;
    let n = NATURAL_FREQUENCY;
    let elastic = n * n * (y - motor(t)) + 2.0 * DAMPING_RATIO * n * (v - slope);
    let forces = [
        mass * a * rate * rate * sin - elastic,
        -mass * (w * w * sin / a + 2.0 * damping * w * rate),
    ];
    let [first, across, last] = [1.0 + mass, mass * cos, mass];
    let determinant = first * last - across * across;
    [
        v,
        (last * forces[0] - across * forces[1]) / determinant,
        rate,
        (first * forces[1] - across * forces[0]) / determinant,
    ]
}

#[test]
fn val_a_swinging_load_follows_lagrange() {
    const FINE: f64 = 2e-4;
    let scales = scales(&simulate(None, &grid(STEP)).unwrap());
    let load = Effect::from_name("swinging_load").unwrap();
    // Swings of some degrees, and of about a right angle.
    for tilt in [0.05, 1.0] {
        let values = [0.3, 1.3 * TAU, 0.04, tilt / scales.acceleration];
        let found = simulate(Some(((load.law)(&values), Place::Link)), &grid(STEP / 8.0)).unwrap();
        let found: Vec<f64> = deformation(&found).into_iter().step_by(2).collect();
        let mut state = [motor(0.0), 0.0, 0.0, 0.0];
        let mut expected = vec![0.0];
        for step in 0..1625 * 20 {
            let t = FINE * f64::from(step);
            let ahead = |k: [f64; 4], h: f64| std::array::from_fn(|i| state[i] + h * k[i]);
            let first = hung(state, t, values);
            let second = hung(ahead(first, FINE / 2.0), t + FINE / 2.0, values);
            let third = hung(ahead(second, FINE / 2.0), t + FINE / 2.0, values);
            let fourth = hung(ahead(third, FINE), t + FINE, values);
            let slope = |i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0;
            state = ahead(std::array::from_fn(slope), FINE);
            if (step + 1) % 20 == 0 {
                expected.push(state[0] - motor(t + FINE));
            }
        }
        let error = rms_difference(&found, &expected) / scales.deformation;
        assert!(error < 3e-5, "tilt {tilt}: {error:.1e}");
    }
}
