//! Laws whose shape is learned: conformance of the table, and the laws of the catalogue as curves.

use proptest::prelude::*;
use quell_model::chain::{Chain, ForceElement, FrictionElement, Linear, MotorSide, State};
use quell_model::curves::knots;
use quell_model::effects::{
    CandidateStop, Effect, KNOTS, LEARNED, Law, Memory, Motion, ParameterRole, Place, Scales, Slot,
    Visited,
};
use quell_model::{Grid, Hold, Timed, Trace, integrate};

fn effect(name: &str) -> &'static Effect {
    Effect::from_name(name).unwrap_or_else(|| panic!("no effect {name}"))
}

/// A smooth move from 0 to 1 while `s` goes from 0 to 1.
fn rise(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s.powi(4) * (35.0 - 84.0 * s + 70.0 * s * s - 20.0 * s.powi(3))
}

/// A joint of 1 rad/s whose motor side is prescribed; forces are divided by its stiffness.
const JOINT: Linear = Linear {
    motor: MotorSide::Prescribed,
    link: Some((1.0, 0.0)),
    stiffness: 1.0,
    damping: 0.1,
    motor_gain: 0.0,
    link_gain: 0.0,
    position_loop: None,
    link_is_input: false,
    held_inertia: 0.0,
    unit_force: 1.0,
};

/// A mass that a force pushes.
const MASS: Linear = Linear {
    motor: MotorSide::Free {
        inertia: 1.0,
        viscous: 0.1,
    },
    link: None,
    stiffness: 0.0,
    damping: 0.0,
    motor_gain: 1.0,
    link_gain: 0.0,
    position_loop: None,
    link_is_input: false,
    held_inertia: 0.0,
    unit_force: 1.0,
};

/// The input of a chain: moves of the motor side, or a force that pushes to and fro.
fn grid(linear: Linear, step: f64) -> Grid {
    let time: Vec<f64> = (0..=200).map(|k| f64::from(k) * 0.2).collect();
    let input = |t: &f64| match linear == MASS {
        true => 1.2 * (0.7 * t).sin() + 0.5 * (2.1 * t).cos(),
        false => rise(t / 6.0) - 0.6 * rise((t - 12.0) / 5.0) + 0.4 * rise((t - 25.0) / 4.0),
    };
    let values: Vec<f64> = time.iter().map(input).collect();
    Grid::new(&time, &values, Hold::Spline, step * (1.0 + 1e-9)).unwrap()
}

fn simulate(linear: Linear, law: Law, place: Place, step: f64) -> Trace {
    let (mut chain, mut timed) = (Chain::new(linear), Timed::default());
    match law {
        Law::Force(law) => {
            let memory = Memory::default();
            chain.forces.push(ForceElement { place, law, memory });
        }
        Law::Friction(law) => chain.frictions.push(FrictionElement {
            place,
            law,
            slides: 0.0,
        }),
        Law::Inertia(inertia) => {
            timed.breaks.extend(inertia.breaks());
            chain.inertias.push(inertia);
        }
        _ => {}
    }
    let state: State = [0.0; 4];
    integrate(&mut chain, &grid(linear, step), state, &timed)
}

fn law_of(name: &str, values: &[f64]) -> Law {
    (effect(name).law)(values)
}

/// Positions of the link at the knots of the input.
fn at_knots(trace: &Trace) -> Vec<f64> {
    let node = |k: u32| {
        let time = f64::from(k) * 0.2 + 1e-9;
        trace.time.partition_point(|t| *t < time) - 1
    };
    (0..=200).map(|k| trace.link[node(k)][0]).collect()
}

/// Largest difference of two motions, and the largest of the first from that of the bare chain.
fn differences(linear: Linear, a: &Trace, b: &Trace) -> (f64, f64) {
    let largest = |a: &Trace, b: &Trace| {
        let pairs = at_knots(a).into_iter().zip(at_knots(b));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let bare = integrate(
        &mut Chain::new(linear),
        &grid(linear, 0.1),
        [0.0; 4],
        &Timed::default(),
    );
    (largest(a, b), largest(a, &bare))
}

/// Ordinates of a function at the knots of a range, with the range.
fn sampled(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let knot = |k: usize| from + (to - from) * k as f64 / (KNOTS - 1) as f64;
    let mut values: Vec<f64> = (0..KNOTS).map(|k| f(knot(k))).collect();
    values.extend([from, to]);
    values
}

/// Levels of friction at the knots of both directions up to a speed.
fn levels(fastest: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let half = KNOTS / 2;
    let forward: Vec<f64> = (0..half)
        .map(|k| f(fastest * k as f64 / (half - 1) as f64))
        .collect();
    let mut values: Vec<f64> = forward.iter().rev().chain(&forward).copied().collect();
    values.extend([-fastest, fastest]);
    values
}

fn scales() -> Scales {
    Scales {
        deformation: 0.05,
        deformation_rate: 0.05,
        position: (-0.5, 1.5),
        velocity: 0.3,
        acceleration: 0.1,
        force: 0.05,
        input: 1.0,
        natural_frequency: 1.0,
        damping_ratio: 0.05,
        span: (0.0, 40.0),
        sample_time: 0.05,
        candidate_events: vec![11.03],
        candidate_frequencies: vec![2.5],
        candidate_orders: vec![30.0],
        candidate_stops: vec![CandidateStop::at(0.5, 1.0)],
        visited: Visited {
            deformation: (-0.3, 0.4),
            motor_position: (-5.0, 5.0),
            motor_velocity: (-2.0, 3.0),
            deformation_rate: (-0.2, 0.3),
            ..Visited::default()
        },
        ..Scales::default()
    }
}

#[test]
fn every_learned_law_is_well_formed() {
    for effect in LEARNED {
        let name = effect.name;
        assert!(effect.is_learned() && effect.slot().is_some(), "{name}");
        assert_eq!(Effect::from_name(name), Some(*effect));
        let ends = effect.parameters.iter().map(|p| (p.name, p.role));
        let ends: Vec<_> = ends.rev().take(2).collect();
        let range = ParameterRole::Range;
        assert_eq!(ends, [("to", range), ("from", range)], "{name}");
        let [coordinate, law] = effect.slot().unwrap().quantities();
        let of = |role| effect.parameters[effect.index(role).unwrap()].quantity;
        assert_eq!(of(range), coordinate, "{name}");
        // Ordinates of a hysteresis are stiffnesses of its elements.
        let is_law = effect.slot() == Some(Slot::Hysteresis) || of(ParameterRole::Ordinate) == law;
        assert!(is_law, "{name}");
        // One start for each place, in their order, all of them neutral.
        let starts = (effect.starts)(&scales());
        assert_eq!(starts.len(), effect.places.len(), "{name}");
        for start in &starts {
            assert_eq!(start.len(), effect.parameters.len(), "{name}");
            assert!(effect.vanishes(start), "{name}: {start:?}");
            assert!(effect.is_negligible(start, &scales()), "{name}");
            // A curve that begins at 0 and goes on is there.
            let mut later = start.clone();
            later[1] = (effect.parameters[1].typical)(&scales());
            assert!(!effect.is_negligible(&later, &scales()), "{name}");
            let [.., from, to] = start[..] else { panic!() };
            assert!(from < to, "{name}: {start:?}");
        }
        for parameter in effect.parameters {
            let (low, high) = (parameter.bounds)(&scales());
            let typical = (parameter.typical)(&scales());
            let what = format!("{name} {}: {low} .. {high}, {typical}", parameter.name);
            assert!(low < high && low <= typical && typical <= high, "{what}");
            let ordinate = parameter.role == ParameterRole::Ordinate;
            assert!(
                !ordinate || typical > 0.0 && low <= 0.0 && 0.0 <= high,
                "{what}"
            );
        }
    }
}

#[test]
fn a_neutral_learned_law_is_the_baseline_to_the_bit() {
    for effect in LEARNED {
        for (&place, start) in effect.places.iter().zip((effect.starts)(&scales())) {
            let linear = if place == Place::Drive { MASS } else { JOINT };
            let law = (effect.law)(&start);
            // Friction that holds nothing ends steps; a model leaves it out.
            if !matches!(law, Law::Friction(_)) {
                let found = simulate(linear, law, place, 0.1);
                let grid = grid(linear, 0.1);
                let bare = integrate(&mut Chain::new(linear), &grid, [0.0; 4], &Timed::default());
                assert!(found.link == bare.link, "{} {}", effect.name, place.name());
            }
        }
    }
}

fn force_of(law: &Law, motion: &Motion, x: f64, v: f64) -> f64 {
    let Law::Force(law) = law else { panic!() };
    law.force(motion, x, v, &Memory::default())
}

proptest! {
    /// Whatever was learned, beyond what was visited a spring pulls back, a force over the position pushes no
    /// farther away, a damper brakes, a spring that changes with time stays one, and more input gives more.
    #[test]
    fn a_learned_law_does_not_drive_where_nobody_has_been(
        ordinates in prop::array::uniform12(-0.9..3.0f64),
        beyond in 1e-6..20.0f64,
        above: bool,
    ) {
        let (from, to) = (-0.7, 0.9);
        let values: Vec<f64> = ordinates.into_iter().chain([from, to]).collect();
        let (end, side) = if above { (to, 1.0) } else { (from, -1.0) };
        let [near, far] = [beyond, 1.5 * beyond].map(|way| end + side * way);
        let motion = Motion { stiffness: 1.0, damping: 0.2, ..Motion::default() };
        let at = |name: &str, x: f64, v: f64| force_of(&law_of(name, &values), &motion, x, v);
        let spring = |x: f64| x + at("learned_spring", x, 0.0);
        prop_assert!(side * (spring(far) - spring(near)) > 0.0);
        let over = |x: f64| at("learned_position_force", x, 0.0);
        prop_assert!(side * (over(far) - over(near)) >= 0.0);
        prop_assert!(motion.damping + at("learned_damping", far, 1.0) >= 0.0);
        prop_assert!(at("learned_position_damping", far, 1.0) >= 0.0);
        let Law::Friction(friction) = law_of("learned_position_friction", &values) else { panic!() };
        prop_assert!(friction.level(side, far, 1.0) >= 0.0);
        let later = Motion { time: far, ..motion };
        prop_assert!(1.0 + force_of(&law_of("learned_drift", &values), &later, 1.0, 0.0) > 0.0);
        let damping = force_of(&law_of("learned_damping_drift", &values), &later, 0.0, 1.0);
        prop_assert!(motion.damping + damping >= 0.0);
        let there = Motion { motor: [far, 0.0], ..motion };
        let damping = force_of(&law_of("learned_joint_damping", &values), &there, 0.0, 1.0);
        prop_assert!(motion.damping + damping >= 0.0);
        prop_assert!(1.0 + force_of(&law_of("learned_position_stiffness", &values), &there, 1.0, 0.0) > 0.0);
        let fast = Motion { motor: [0.0, far], ..motion };
        prop_assert!(1.0 + force_of(&law_of("learned_speed_stiffness", &values), &fast, 1.0, 0.0) > 0.0);
        let Law::Drive(drive) = law_of("learned_drive", &values) else { panic!() };
        prop_assert!(side * (drive.map(far) - drive.map(near)) > 0.0);
    }
}

/// A spring whose last knot nothing determined falls steeply there: a link that is thrown beyond it comes back.
#[test]
fn a_link_comes_back_from_beyond_what_was_visited() {
    let values = sampled(-0.02, 0.02, |x| if x > 0.019 { -0.1 } else { 0.6 * x });
    let mut chain = Chain::new(JOINT);
    let Law::Force(law) = law_of("learned_spring", &values) else {
        panic!()
    };
    let (place, memory) = (Place::Transmission, Memory::default());
    chain.forces.push(ForceElement { place, law, memory });
    let state: State = [0.0, 0.0, 0.5, 0.0];
    let zeros = [0.0; 401];
    let time: Vec<f64> = (0..401).map(|k| f64::from(k) * 0.2).collect();
    let grid = Grid::new(&time, &zeros, Hold::Spline, 0.05).unwrap();
    let trace = integrate(&mut chain, &grid, state, &Timed::default());
    let farthest = trace
        .link
        .iter()
        .fold(0.0f64, |m, link| m.max(link[0].abs()));
    assert!(farthest <= 0.5 + 1e-9, "{farthest}");
}

/// A spline holds every cubic polynomial, so that nothing but rounding is left.
#[test]
fn val_a_learned_spring_of_a_cubic_is_the_cubic_stiffness() {
    let named = simulate(
        JOINT,
        law_of("cubic_stiffness", &[2.0]),
        Place::Transmission,
        0.1,
    );
    let values = sampled(-0.6, 0.7, |x| 2.0 * x * x * x);
    let learned = simulate(
        JOINT,
        law_of("learned_spring", &values),
        Place::Transmission,
        0.1,
    );
    let (off, seen) = differences(JOINT, &named, &learned);
    assert!(seen > 1e-3 && off < 1e-14, "{off:e} of {seen:e}");
}

#[test]
fn val_a_learned_friction_of_one_level_is_coulomb_friction_to_the_bit() {
    for (linear, place) in [(MASS, Place::Drive), (JOINT, Place::Transmission)] {
        let level = if linear == MASS { 0.9 } else { 0.01 };
        let named = simulate(linear, law_of("coulomb_friction", &[level]), place, 0.1);
        let learned = law_of("learned_friction", &levels(1.0, |_| level));
        let learned = simulate(linear, learned, place, 0.1);
        assert!(differences(linear, &named, &named).1 > 1e-3);
        assert!(named == learned, "{}", place.name());
        // It sticks and slides.
        let still = named
            .motor
            .windows(2)
            .filter(|w| w[0][1] == 0.0 && w[1][1] == 0.0);
        assert!(linear == JOINT || still.count() > 3);
    }
}

/// Knots a third of the Stribeck velocity apart: the spline errs by some thousandths of the excess.
#[test]
fn val_a_learned_friction_of_stribecks_levels_is_stribeck_friction() {
    let (friction, excess, velocity) = (0.3, 0.5, 1.2);
    let level = |v: f64| friction * (1.0 + excess * (-(v / velocity) * (v / velocity)).exp());
    let named = law_of("stribeck_friction", &[friction, excess, velocity]);
    let named = simulate(MASS, named, Place::Drive, 0.1);
    let learned = law_of("learned_friction", &levels(2.0, level));
    let learned = simulate(MASS, learned, Place::Drive, 0.1);
    let (off, seen) = differences(MASS, &named, &learned);
    let fastest = named.motor.iter().map(|m| m[1].abs()).fold(0.0, f64::max);
    assert!(
        seen > 0.1 && fastest < 2.0 && off < 5e-3 * seen,
        "{off:e} of {seen:e}, {fastest}"
    );
}

/// Knots that are dense about rest resolve a level that rises from 0 within a hundredth of the speeds: it does not stick.
#[test]
fn val_dense_levels_of_a_hyperbolic_tangent_are_smooth_coulomb_friction() {
    let (friction, transition) = (0.3, 0.02);
    let named = law_of("smooth_coulomb_friction", &[friction, transition]);
    let named = simulate(MASS, named, Place::Drive, 0.1);
    let fine = effect("learned_friction").resolutions().nth(1).unwrap();
    let mut values = fine.neutral();
    let count = values.len();
    values[count - 2..].copy_from_slice(&[-2.0, 2.0]);
    let speeds = knots(fine, &values);
    assert_eq!(speeds.len(), count - 2);
    for (level, speed) in values.iter_mut().zip(&speeds) {
        *level = friction * (speed.abs() / transition).tanh();
    }
    let learned = simulate(MASS, (fine.law)(&values), Place::Drive, 0.1);
    let (off, seen) = differences(MASS, &named, &learned);
    assert!(seen > 0.1 && off < 5e-3 * seen, "{off:e} of {seen:e}");
}

/// A level that is the same everywhere is Coulomb's friction, which the law contains.
#[test]
fn val_a_constant_level_over_the_position_is_coulomb_friction() {
    let level = 0.02;
    let [own, coulomb] = ["learned_position_friction", "coulomb_friction"]
        .map(|name| Effect::from_name(name).unwrap());
    assert!(own.resolutions().all(|own| own.contains(coulomb)));
    for (linear, place) in [
        (MASS, Place::Drive),
        (JOINT, Place::Transmission),
        (JOINT, Place::Link),
    ] {
        let run = |law| at_knots(&simulate(linear, law, place, 0.1));
        let constant = run(law_of(own.name, &sampled(-1.0, 1.0, |_| level)));
        let expected = run(law_of(coulomb.name, &[level]));
        let pairs = constant.iter().zip(&expected);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{place:?}: {off:e}");
    }
}

#[test]
fn learned_laws_converge_as_steps_are_halved() {
    for effect in LEARNED {
        for (&place, mut values) in effect.places.iter().zip((effect.starts)(&scales())) {
            // Any shape: ordinates that go up and down, of a size that matters.
            for (k, parameter) in effect.parameters.iter().enumerate().take(values.len() - 2) {
                let typical = 2.0 * (parameter.typical)(&scales());
                values[k] = typical * (1.5 + (1.3 * k as f64).sin());
            }
            let linear = if place == Place::Drive { MASS } else { JOINT };
            let run =
                |parts: f64| at_knots(&simulate(linear, (effect.law)(&values), place, 0.2 / parts));
            if matches!((effect.law)(&values), Law::Drive(_) | Law::Sensor(_)) {
                continue;
            }
            let reference = run(64.0);
            let size = if linear == MASS { 1.0 } else { 0.2 };
            let error = |parts: f64| {
                let off = run(parts)
                    .into_iter()
                    .zip(&reference)
                    .map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max) / size
            };
            let errors = [2.0, 4.0, 8.0].map(error);
            let told = errors.map(|error| format!("{error:.1e}")).join(" ");
            println!("{:28} {:14} {told}", effect.name, place.name());
            assert!(
                errors[0] < 1e-3 && errors[0] / errors[2] > 16.0,
                "{}: {told}",
                effect.name
            );
        }
    }
}

/// Stiffnesses and slip distances of elements in parallel: 1 to 128 thousandths.
const STIFFNESSES: [f64; 8] = [3.0, 0.0, 2.0, 0.5, 0.0, 1.0, 0.7, 0.2];

fn maxwell_slip() -> Vec<f64> {
    [&STIFFNESSES[..], &[1e-3, 128e-3]].concat()
}

/// What the elements make of a first way from rest: each its stiffness up to where it slips.
fn virgin(x: f64) -> f64 {
    let force = |(k, stiffness): (usize, f64)| {
        let slip = 1e-3 * 2f64.powi(k as i32);
        stiffness * x.clamp(-slip, slip)
    };
    STIFFNESSES.into_iter().enumerate().map(force).sum()
}

/// Masing's rule: after a turn at `a` the loop is the first way, twice as large. The closed area is
/// `sum 4 k r (a - r)` over the elements that slip.
#[test]
fn val_the_loop_of_maxwell_slip_is_that_of_prandtl_and_ishlinskii() {
    let Law::Force(law) = law_of("maxwell_slip", &maxwell_slip()) else {
        panic!("no force");
    };
    let motion = Motion {
        stiffness: 1.0,
        ..Motion::default()
    };
    let a = 0.1;
    let mut memory = Memory::default();
    let mut walk = |from: f64, to: f64, expected: &dyn Fn(f64) -> f64| {
        let (mut area, steps) = (0.0, 1000);
        let mut before = law.force(&motion, from, 0.0, &memory);
        for k in 1..=steps {
            let x = from + (to - from) * f64::from(k) / f64::from(steps);
            let force = law.force(&motion, x, to - from, &memory);
            assert!(
                (force - expected(x)).abs() < 1e-14,
                "{x}: {force}, not {}",
                expected(x)
            );
            law.remember(&motion, x, to - from, &mut memory);
            area += 0.5 * (force + before) * (to - from) / f64::from(steps);
            before = force;
        }
        area
    };
    walk(0.0, a, &virgin);
    let down = walk(a, -a, &|x| virgin(a) - 2.0 * virgin(0.5 * (a - x)));
    // A small loop on the way back closes, and the large one goes on as if it had not been.
    let up = |x: f64| -virgin(a) + 2.0 * virgin(0.5 * (x + a));
    let mut taken = down + walk(-a, 0.02, &up);
    let turn = up(0.02);
    let small = walk(0.02, -0.01, &|x| turn - 2.0 * virgin(0.5 * (0.02 - x)));
    let low = turn - 2.0 * virgin(0.015);
    let back = walk(-0.01, 0.02, &|x| low + 2.0 * virgin(0.5 * (x + 0.01)));
    assert!(small + back > 0.0);
    taken += walk(0.02, a, &up);
    let loss = |(k, stiffness): (usize, f64)| {
        let slip = 1e-3 * 2f64.powi(k as i32);
        4.0 * stiffness * slip * (a - slip).max(0.0)
    };
    let expected: f64 = STIFFNESSES.into_iter().enumerate().map(loss).sum();
    // Straight lines between 1000 points, corners between them.
    assert!(
        (taken - expected).abs() < 1e-3 * expected,
        "{taken}, not {expected}"
    );
}

/// Elements that slip take energy in every swing, until none does.
#[test]
fn free_vibration_dies_out_in_maxwell_slip() {
    let law = law_of("maxwell_slip", &maxwell_slip());
    let linear = Linear {
        damping: 0.0,
        ..JOINT
    };
    let mut chain = Chain::new(linear);
    let Law::Force(law) = law else { panic!() };
    chain.forces.push(ForceElement {
        place: Place::Transmission,
        law,
        memory: Memory::default(),
    });
    let time: Vec<f64> = (0..=400).map(|k| 0.1 * f64::from(k)).collect();
    let grid = Grid::new(&time, &vec![0.0; time.len()], Hold::Linear, 0.1).unwrap();
    let mut start: State = [0.0; 4];
    start[3] = 0.1;
    let trace = integrate(&mut chain, &grid, start, &Timed::default());
    let amplitudes: Vec<f64> = trace
        .link
        .windows(2)
        .filter(|w| w[0][1] > 0.0 && w[1][1] <= 0.0)
        .map(|w| w[0][0])
        .collect();
    let slips = amplitudes.iter().take_while(|a| **a > 1e-3).count();
    let (large, small) = amplitudes.split_at(slips);
    assert!(
        slips > 3 && large.is_sorted_by(|a, b| a > b),
        "{amplitudes:?}"
    );
    assert!(
        small.len() > 5 && small.iter().all(|a| *a > 8e-4),
        "{amplitudes:?}"
    );
}

/// Outside of the range a spring that stays one goes on with the slope that it has at the end.
#[test]
fn learned_laws_are_straight_outside_of_what_was_visited() {
    let values = sampled(-1.0, 2.0, |x| (1.3 * x).sin() + x * x);
    let Law::Force(law) = law_of("learned_spring", &values) else {
        panic!("no force");
    };
    let motion = Motion {
        stiffness: 2.0,
        ..Motion::default()
    };
    let at = |x: f64| law.force(&motion, x, 0.0, &Memory::default());
    for (end, out) in [(-1.0, -1.0), (2.0, 1.0)] {
        let slope = (at(end) - at(end - 1e-6 * out)) / (1e-6 * out);
        for far in [0.5, 10.0] {
            let expected = at(end) + slope * far * out;
            assert!(
                (at(end + far * out) - expected).abs() < 1e-4 * far,
                "{end} {far}"
            );
        }
    }
}

/// Whatever a file may say, a law has a value or none, and does not panic.
#[test]
fn odd_ranges_do_no_harm() {
    for effect in LEARNED {
        for (from, to) in [
            (0.0, 0.0),
            (1.0, -1.0),
            (-1.0, 1.0),
            (0.0, 1.0),
            (f64::MIN, f64::MAX),
        ] {
            let mut values = vec![0.1; effect.parameters.len() - 2];
            values.extend([from, to]);
            if let Law::Force(law) = (effect.law)(&values) {
                let mut memory = Memory::default();
                law.remember(&Motion::default(), 0.5, 1.0, &mut memory);
                law.force(&Motion::default(), -0.5, 1.0, &memory);
            }
        }
    }
}
