//! Static laws as curves: against the forces in the chain, in words, and the nearest named law.

use nalgebra::DMatrix;
use quell_model::chain::{Chain, ForceElement, FrictionElement, Linear, MotorSide, State};
use quell_model::curves::{Curve, NamedLaws, Nearest, Trend};
use quell_model::effects::{
    Catalogue, EFFECTS, Effect, KNOTS, LEARNED, Law, Memory, Motion, Place, Scales, Slot, Units,
    curve,
};

fn effect(name: &str) -> &'static Effect {
    Effect::from_name(name).unwrap_or_else(|| panic!("no effect {name}"))
}

const STIFFNESS: f64 = 3.0;

/// What laws see of a joint of that stiffness at rest.
fn still() -> Motion {
    Motion {
        stiffness: STIFFNESS,
        damping: 0.2,
        ..Motion::default()
    }
}

fn scales() -> Scales {
    Scales {
        deformation: 0.1,
        deformation_rate: 0.5,
        position: (-0.8, 1.0),
        velocity: 0.5,
        acceleration: 5.0,
        force: 0.3,
        input: 2.0,
        natural_frequency: 1.7,
        damping_ratio: 0.05,
        span: (0.0, 40.0),
        sample_time: 0.05,
        ..Scales::default()
    }
}

/// A link of mass 1 and a motor side of mass 2 with the spring between them.
fn linear() -> Linear {
    Linear {
        motor: MotorSide::Free {
            inertia: 2.0,
            viscous: 0.0,
        },
        link: Some((1.0, 0.0)),
        stiffness: STIFFNESS,
        damping: 0.2,
        motor_gain: 1.0,
        link_gain: 0.0,
        position_loop: None,
        link_is_input: false,
        held_inertia: 0.0,
        unit_force: 1.0,
    }
}

/// Values that a law may have, with a shape: ordinates that differ.
fn values(effect: &Effect) -> Vec<f64> {
    let mut values = (effect.starts)(&scales()).remove(0);
    if effect.is_learned() {
        let ordinates = values.len() - 2;
        for (k, parameter) in effect.parameters.iter().enumerate().take(ordinates) {
            values[k] = (parameter.typical)(&scales()) * (1.0 + (0.9 * k as f64).sin());
        }
    }
    values
}

/// Force on the link that the law makes, against motion, where the chain is in this state.
fn felt(effect: &Effect, place: Place, values: &[f64], state: &State, time: f64) -> f64 {
    let bare = Chain::new(linear()).instant(time, state, [0.0; 3]);
    let mut chain = Chain::new(linear());
    match (effect.law)(values) {
        Law::Force(law) => {
            let (mut memory, motion) = (Memory::default(), bare.motion);
            let [x, v] = match place {
                Place::Drive => motion.motor,
                Place::Transmission => motion.deformation(),
                _ => motion.link,
            };
            // A hysteresis comes from rest; what has branches has that of where it is.
            if effect.slot() != Some(Slot::Hysteresis) {
                memory.position = x;
                law.remember(&motion, x, v, &mut memory);
            }
            chain.forces.push(ForceElement { place, law, memory });
        }
        Law::Friction(law) => {
            let slides = match place {
                Place::Drive => state[1],
                _ => state[3] - state[1],
            };
            let slides = slides.signum();
            chain.frictions.push(FrictionElement { place, law, slides });
        }
        Law::Inertia(inertia) => chain.inertias.push(inertia),
        Law::Kinematic(error) => chain.kinematics.push(error),
        _ => panic!("{} is not in the chain", effect.name),
    }
    let there = chain.instant(time, state, [0.0; 3]);
    match place {
        Place::Drive => 2.0 * (bare.motor - there.motor),
        _ => bare.link - there.link,
    }
}

/// The chain where an effect of a slot sees a coordinate and nothing else moves.
fn state_of(slot: Slot, place: Place, x: f64) -> (State, f64) {
    let (mut state, mut time): (State, f64) = ([0.0; 4], 0.0);
    match (slot, place) {
        (Slot::Friction, Place::Drive) => (state[1], state[3]) = (x, x),
        (Slot::Friction, _) => state[3] = x,
        (Slot::PositionForce, Place::Drive) => (state[0], state[2]) = (x, x),
        (Slot::Hysteresis, Place::Drive) => state[0] = x,
        (Slot::PositionFriction, Place::Drive) => (state[0], state[1]) = (x, 1.0),
        (Slot::PositionFriction, Place::Transmission) => {
            (state[0], state[2], state[3]) = (x, x, 1.0)
        }
        (Slot::PositionFriction, _) => (state[2], state[3]) = (x, 1.0),
        (Slot::PositionDamping, Place::Drive) => (state[0], state[1]) = (x, 1.0),
        (Slot::PositionDamping, _) => (state[2], state[3]) = (x, 1.0),
        (Slot::StiffnessDrift, _) => (state[2], time) = (1.0, x),
        (Slot::Damping, _) => (state[2], state[3]) = (x, 1.0),
        (Slot::SpeedStiffness, _) => (state[1], state[2], state[3]) = (x, 1.0, x),
        (Slot::JointStiffness, _) => (state[0], state[2]) = (x, x + 1.0),
        (Slot::TransmissionError, _) => (state[0], state[2]) = (x, x),
        (Slot::JointDamping, _) => (state[0], state[2], state[3]) = (x, x, 1.0),
        (Slot::DampingDrift, _) => (state[3], time) = (1.0, x),
        _ => state[2] = x,
    }
    (state, time)
}

#[test]
fn a_curve_is_the_force_that_the_chain_feels() {
    let mut tested = 0;
    for effect in EFFECTS.iter().chain(LEARNED) {
        let Some(slot) = effect.slot() else { continue };
        if matches!(
            slot,
            Slot::Drive | Slot::Sensor | Slot::SensorDrift | Slot::Clock | Slot::Inertia
        ) {
            continue;
        }
        for &place in effect.places {
            let values = values(effect);
            for x in [-0.09, -0.03, 0.011, 0.08] {
                let x = if slot == Slot::Hysteresis {
                    f64::abs(x)
                } else {
                    x
                };
                let found = curve(effect, &values, &still(), &[x]).unwrap()[0];
                let (state, time) = state_of(slot, place, x);
                let mut expected = felt(effect, place, &values, &state, time);
                if matches!(
                    slot,
                    Slot::StiffnessDrift | Slot::SpeedStiffness | Slot::JointStiffness
                ) {
                    expected /= STIFFNESS;
                }
                // The spring pulls the link after the error.
                if slot == Slot::TransmissionError {
                    expected /= -STIFFNESS;
                }
                let close = (found - expected).abs() < 1e-12;
                let name = effect.name;
                assert!(
                    close,
                    "{name} {} at {x}: {found}, not {expected}",
                    place.name()
                );
                tested += 1;
            }
        }
    }
    assert!(tested > 80);
}

#[test]
fn curves_outside_of_the_chain_are_what_is_added() {
    let at = |name: &str, values: &[f64], x: f64| {
        curve(effect(name), values, &still(), &[x]).unwrap()[0]
    };
    assert_eq!(at("dead_zone", &[0.5], 2.0), -0.5);
    assert_eq!(at("saturation", &[1.5], 2.0), -0.5);
    assert!((at("sensor_gain", &[0.1], 2.0) - 0.2).abs() < 1e-15);
    assert_eq!(at("sensor_drift", &[0.1, 0.3, 0.0], 2.0), 0.2);
    assert_eq!(
        at("pose_dependent_frequency", &[0.5, 1.0, 1.0, 0.0], 3.0),
        2.0
    );
    let folded = at("pose_dependent_frequency", &[0.5, 1.0, 1.0, 1.0], 3.0);
    assert!((folded - (1.0 - 2.0_f64.cos())).abs() < 1e-15);
    for name in [
        "learned_drive",
        "learned_sensor",
        "learned_sensor_drift",
        "learned_clock",
        "learned_frequency",
    ] {
        let values = values(effect(name));
        let [.., from, to] = values[..] else { panic!() };
        let knot = from + (to - from) * 3.0 / (KNOTS - 1) as f64;
        assert!(
            (at(name, &values, knot) - values[3]).abs() < 1e-12,
            "{name}"
        );
    }
    // What has a frequency of its own is no curve.
    assert!(curve(effect("second_mode"), &[1.0, 0.1, 0.1], &still(), &[1.0]).is_none());
}

/// A learned law through a function of its coordinate, its ordinates known to `std`.
fn learned(name: &str, range: (f64, f64), std: f64, f: impl Fn(f64) -> f64) -> Curve {
    let effect = effect(name);
    let count = effect.parameters.len() - 2;
    let known = DMatrix::identity(count, count) * (std * std);
    let mut values = vec![0.0; count];
    values.extend([range.0, range.1]);
    let neutral = Curve::new(effect, &values, &known, &still()).unwrap();
    for (k, x) in neutral.knots().into_iter().enumerate() {
        // Noise of an even size, this way and that.
        let noise = 0.8 * std * if (k * k) % 3 == 1 { 1.0 } else { -1.0 };
        values[k] = f(x) + noise;
    }
    Curve::new(effect, &values, &known, &still()).unwrap()
}

fn units() -> Units {
    Units {
        force: "N".into(),
        position: "m".into(),
        input: "N".into(),
        reference: "N".into(),
    }
}

#[test]
fn a_cubic_spring_is_told_in_words() {
    let curve = learned("learned_spring", (-0.1, 0.1), 0.001, |x| 500.0 * x.powi(3));
    let shape = curve.shape();
    assert_eq!(
        (shape.odd, shape.jump, shape.dissipated),
        (Some(1.0), None, None)
    );
    assert_eq!(shape.trend, Some(Trend::Rises));
    let growth = shape.growth.unwrap();
    assert!(
        (growth.exponent.value - 3.0).abs() < growth.exponent.band(),
        "{growth:?}"
    );
    let said = shape.sentence(&curve, &units());
    assert!(said.starts_with("The learned spring is odd"), "{said}");
    assert!(
        said.contains("grows like |deformation|^") && said.ends_with("only rises."),
        "{said}"
    );
    println!("{said}");
}

#[test]
fn an_even_curve_rises_and_falls() {
    let curve = learned("learned_position_force", (-0.8, 1.0), 0.01, |x| 2.0 * x * x);
    let shape = curve.shape();
    assert!(shape.odd.is_none_or(|odd| odd < 0.01));
    assert_eq!((shape.trend, shape.slope), (Some(Trend::Both), None));
    println!("{}", shape.sentence(&curve, &units()));
}

#[test]
fn friction_is_told_with_its_jump_and_its_loss() {
    let level = |v: f64| 0.2 + 0.3 * v.abs().powf(0.6);
    let curve = learned("learned_friction", (-2.0, 2.0), 0.002, level);
    let shape = curve.shape();
    let jump = shape.jump.unwrap();
    assert!((jump.value - 0.4).abs() < 3.0 * jump.std, "{jump:?}");
    assert_eq!((shape.odd, shape.trend), (Some(1.0), Some(Trend::Rises)));
    // 0.2 + 0.3 times the mean of v^0.6 up to 2.
    let mean = 0.2 + 0.3 * 2f64.powf(0.6) / 1.6;
    let loss = shape.dissipated.unwrap();
    assert!(
        (loss.value - mean).abs() < 0.02 * mean,
        "{loss:?}, not {mean}"
    );
    // Without the jump it grows like the power.
    let curve = learned("learned_friction", (-2.0, 2.0), 1e-4, |v| {
        0.3 * v.abs().powf(0.6)
    });
    let growth = curve.shape().growth.unwrap();
    assert!((growth.exponent.value - 0.6).abs() < 0.02, "{growth:?}");
    println!("{}", curve.shape().sentence(&curve, &units()));
}

#[test]
fn nothing_is_said_of_noise() {
    let known = |name: &str, range| {
        let curve = learned(name, range, 0.01, |_| 0.0);
        (curve.shape().sentence(&curve, &units()), curve.shape())
    };
    for name in ["learned_spring", "learned_sensor", "learned_damping"] {
        let (said, shape) = known(name, (-0.1, 0.1));
        assert!(said.contains("nothing is known"), "{said} {shape:?}");
    }
}

#[test]
fn the_energy_of_a_loop_is_that_of_its_elements() {
    let curve = learned("maxwell_slip", (1e-3, 0.128), 1e-9, |_| 2.0);
    let expected: f64 = (0..8)
        .map(|k| 1e-3 * 2f64.powi(k))
        .map(|slip| 4.0 * 2.0 * slip * (0.128 - slip))
        .sum();
    let loss = curve.shape().dissipated.unwrap();
    // Straight lines between 120 points.
    assert!(
        (loss.value / expected - 1.0).abs() < 2e-3,
        "{loss:?}, not {expected}"
    );
    println!("{}", curve.shape().sentence(&curve, &units()));
}

fn near(curve: &Curve, place: Place) -> Vec<Nearest> {
    let (at, scales) = (still(), scales());
    let laws = NamedLaws::of(curve, place, &at, &scales, Catalogue::default());
    laws.unwrap().nearest()
}

/// Stribeck friction beside a constant force looks like no single law: the constant is a part of friction that differs between
/// the directions.
#[test]
fn a_curve_that_is_the_sum_of_two_named_laws_is_that_sum() {
    let made = [
        (effect("stribeck_friction"), vec![0.1, 0.7, 0.15]),
        (effect("force_offset"), vec![0.04]),
    ];
    let f = |x: f64| {
        let value =
            |(law, values): &(&Effect, Vec<f64>)| curve(law, values, &still(), &[x]).unwrap()[0];
        x.signum() * made.iter().map(value).sum::<f64>()
    };
    let curve = learned("learned_friction", (-0.5, 0.5), 2e-4, f);
    let (at, scales) = (still(), scales());
    let laws = NamedLaws::of(&curve, Place::Drive, &at, &scales, Catalogue::default());
    let sums = laws.unwrap().nearest_sums();
    let found = sums.iter().take(2).find(|sum| {
        made.iter()
            .all(|(law, _)| sum.iter().any(|own| own.0 == *law))
    });
    let found = found.unwrap_or_else(|| panic!("{:?}", &sums[..2]));
    for (law, values) in &made {
        let (_, own) = found.iter().find(|own| own.0 == *law).unwrap();
        for (value, expected) in own.iter().zip(values) {
            assert!((value - expected).abs() <= 0.1 * expected, "{found:?}");
        }
    }
}

/// Learned law, its range, its place; the law that it was made of.
type Case = (
    &'static str,
    (f64, f64),
    Place,
    &'static str,
    &'static [f64],
);

#[test]
fn the_nearest_named_law_of_a_curve_is_the_law_that_it_was_made_of() {
    let cases: [Case; 8] = [
        (
            "learned_spring",
            (-0.1, 0.1),
            Place::Transmission,
            "cubic_stiffness",
            &[30.0],
        ),
        (
            "learned_friction",
            (-0.5, 0.5),
            Place::Drive,
            "coulomb_friction",
            &[0.1],
        ),
        (
            "learned_friction",
            (-0.5, 0.5),
            Place::Drive,
            "stribeck_friction",
            &[0.1, 0.7, 0.15],
        ),
        (
            "learned_friction",
            (-0.5, 0.5),
            Place::Transmission,
            "quadratic_damping",
            &[0.4],
        ),
        (
            "learned_position_force",
            (-0.8, 1.0),
            Place::Link,
            "gravity_load",
            &[0.8, 0.5],
        ),
        (
            "learned_drive",
            (-2.0, 2.0),
            Place::Drive,
            "torque_constant_nonlinearity",
            &[0.1, 2.0],
        ),
        (
            "learned_frequency",
            (-0.8, 1.0),
            Place::Link,
            "pose_dependent_frequency",
            &[0.4, 0.2, 0.0, 2.0],
        ),
        (
            "learned_drift",
            (0.0, 40.0),
            Place::Transmission,
            "stiffness_drift",
            &[0.004, 0.05],
        ),
    ];
    for (name, range, place, law, parameters) in cases {
        let f = |x: f64| {
            let value = curve(effect(law), parameters, &still(), &[x]).unwrap()[0];
            if name == "learned_friction" {
                value.abs()
            } else {
                value
            }
        };
        let std = 2e-3 * if name == "learned_friction" { 0.1 } else { 0.3 };
        let found = near(&learned(name, range, std, f), place);
        let best = &found[0];
        let told = format!(
            "{law}: {} {:?} {}",
            best.effect.name, best.values, best.chi_squared
        );
        println!("{told} {:?}", best.outside);
        let contained = best.effect.contains(effect(law)) || best.effect.name == law;
        assert!(contained && best.chi_squared < 2.0, "{told}");
        let own = found.iter().find(|near| near.effect.name == law).unwrap();
        for (value, expected) in own.values.iter().zip(parameters) {
            assert!(
                (value - expected).abs() <= 0.1 * expected.abs(),
                "{:?} {told}",
                own.values
            );
        }
    }
}

#[test]
fn a_named_law_that_is_not_the_curve_leaves_the_band() {
    // A spring that gives way beyond 0.05 on one side alone.
    let curve = learned("learned_spring", (-0.1, 0.1), 1e-3, |x| 3.0 * x * x);
    let found = near(&curve, Place::Transmission);
    let cubic = found
        .iter()
        .find(|near| near.effect.name == "cubic_stiffness")
        .unwrap();
    assert!(
        cubic.chi_squared > 10.0 && !cubic.outside.is_empty(),
        "{cubic:?}"
    );
    assert!(found.is_sorted_by(|a, b| a.chi_squared <= b.chi_squared));
    assert!(cubic.outside.iter().all(|(from, to)| from <= to));
}

/// Sampled at the knots, a wave that is shorter than twice their distance looks like a longer one.
#[test]
fn a_wave_that_the_knots_do_not_show_is_not_near() {
    let curve = learned("learned_position_force", (-0.8, 1.0), 1e-3, |x| {
        0.05 * (3.0 * x).sin()
    });
    let knots = curve.knots();
    let image = 3.0 + std::f64::consts::TAU / (knots[1] - knots[0]);
    let scales = Scales {
        candidate_orders: vec![image],
        ..scales()
    };
    let at = still();
    let laws = NamedLaws::of(&curve, Place::Link, &at, &scales, Catalogue::default());
    let found = laws.unwrap().nearest();
    let cogging = found
        .iter()
        .find(|near| near.effect.name == "cogging")
        .unwrap();
    let is_image = (cogging.values[1] / image - 1.0).abs() < 0.05;
    assert!(!is_image || cogging.chi_squared > 10.0, "{cogging:?}");
}
