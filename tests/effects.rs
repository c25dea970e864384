//! Conformance of the catalogue of effects, and its laws against closed forms.

use proptest::prelude::*;
use quell::effects::{
    CandidateStop, Drive, EFFECTS, Effect, Force, Friction, Inertia, Law, Memory, Motion,
    ParameterRole, Place, Property, Reading, Scales, Sensor, Units,
};
use std::collections::HashSet;
use std::f64::consts::PI;
use std::path::Path;

fn effect(name: &str) -> &'static Effect {
    Effect::from_name(name).unwrap_or_else(|| panic!("no effect {name}"))
}

fn force(name: &str, parameters: &[f64]) -> Box<dyn Force> {
    match (effect(name).law)(parameters) {
        Law::Force(force) => force,
        _ => panic!("{name} is no force"),
    }
}

fn drive(name: &str, parameters: &[f64]) -> Box<dyn Drive> {
    match (effect(name).law)(parameters) {
        Law::Drive(drive) => drive,
        _ => panic!("{name} is not in the drive"),
    }
}

fn sensor(name: &str, parameters: &[f64]) -> Box<dyn Sensor> {
    match (effect(name).law)(parameters) {
        Law::Sensor(sensor) => sensor,
        _ => panic!("{name} is not in the sensor"),
    }
}

fn inertia(name: &str, parameters: &[f64]) -> Box<dyn Inertia> {
    match (effect(name).law)(parameters) {
        Law::Inertia(inertia) => inertia,
        _ => panic!("{name} is no inertia"),
    }
}

/// The drive's answer to a current is told in amperes and seconds. In front of a position loop its rate is that of the
/// commanded position.
#[test]
fn drives_are_told_in_the_unit_of_their_input() {
    let units = |input: &str, reference: &str| Units {
        force: "N.m".into(),
        position: "rad".into(),
        input: input.into(),
        reference: reference.into(),
    };
    let of = |name: &str, units: &Units| effect(name).parameters[0].quantity.unit(units);
    let current = units("A", "A");
    assert_eq!(of("dead_zone", &current), "A");
    assert_eq!(of("saturation", &current), "A");
    assert_eq!(of("rate_limit", &current), "A/s");
    assert_eq!(of("torque_constant_nonlinearity", &current), "1/A");
    assert_eq!(of("drive_lag", &current), "s");
    let looped = units("N.m", "rad");
    assert_eq!(of("saturation", &looped), "N.m");
    assert_eq!(of("rate_limit", &looped), "rad/s");
}

/// A motion of unit stiffness.
fn motion() -> Motion {
    Motion {
        stiffness: 1.0,
        damping: 0.1,
        ..Motion::default()
    }
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (found - expected).abs();
    assert!(error <= tolerance, "{what}: {found}, not {expected}");
}

prop_compose! {
    /// Scales of joints and linear axes, of motion from barely there to violent.
    fn scales()(
        logs in prop::array::uniform8(-3.0..2.0f64),
        start in -5.0..5.0f64,
        begin in prop_oneof![Just(0.0), -5.0..1000.0f64],
        suspects in prop::array::uniform4(0.01..0.99f64),
        found in 0..=4usize,
    ) -> Scales {
        let [deformation, velocity, acceleration, force, input, frequency, travel, _] =
            logs.map(|log| 10f64.powf(log));
        let natural_frequency = 10.0 * frequency;
        let deformation = 0.01 * deformation;
        let duration = 20.0 / frequency;
        let end = begin + duration;
        Scales {
            deformation,
            deformation_rate: deformation * natural_frequency,
            position: (start, start + if found == 3 { 0.0 } else { travel }),
            velocity,
            acceleration,
            force,
            input,
            natural_frequency,
            damping_ratio: 0.05,
            span: (begin, end),
            sample_time: 1e-4 * duration,
            candidate_events: suspects[..found].iter().map(|s| begin + s * duration).collect(),
            candidate_frequencies: suspects[..found].iter().map(|s| 50.0 * s * natural_frequency).collect(),
            candidate_orders: suspects[..found].iter().map(|s| 500.0 * s / travel).collect(),
            candidate_stops: suspects[..found].iter().map(|s| CandidateStop::at(start + 3.0 * (s - 0.5) * travel, (s - 0.5).signum())).collect(),
            ..Scales::default()
        }
    }
}

/// Values within bounds, at these parts of each range.
fn within(effect: &Effect, scales: &Scales, parts: &[f64]) -> Vec<f64> {
    let value = |(parameter, part): (&quell::effects::Parameter, &f64)| {
        let (low, high) = (parameter.bounds)(scales);
        low + part * (high - low)
    };
    effect.parameters.iter().zip(parts).map(value).collect()
}

#[test]
fn every_entry_is_well_formed() {
    let names: HashSet<_> = EFFECTS.iter().map(|effect| effect.name).collect();
    assert_eq!(names.len(), EFFECTS.len(), "a name is there twice");
    let titles: HashSet<_> = EFFECTS.iter().map(|effect| effect.title).collect();
    assert_eq!(titles.len(), EFFECTS.len(), "a title is there twice");
    let word = |name: &str| {
        name.chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/model/src/effects");
    for effect in EFFECTS {
        let name = effect.name;
        assert!(word(name), "{name}");
        assert!(
            room.join(format!("{name}.rs")).exists(),
            "{name} has no file of its own"
        );
        assert!(!effect.places.is_empty(), "{name} is nowhere");
        let source = effect.physics.split_once("Source: ");
        let (physics, source) = source.unwrap_or_else(|| panic!("{name} has no source"));
        assert!(physics.len() > 80, "{name}: {physics}");
        assert!(
            source.contains("(1") || source.contains("(2") || source.contains("ISO"),
            "{name}: {source}"
        );
        let sentence = |text: &str| text.ends_with('.') && text.starts_with(char::is_uppercase);
        assert!(sentence(effect.remedy), "{name}: {}", effect.remedy);
        let sizes = effect.parameters.iter();
        let sizes = sizes.filter(|p| p.role == ParameterRole::Size).count();
        assert_eq!(sizes, 1, "{name} vanishes with one of its parameters");
        let keys: HashSet<_> = effect.parameters.iter().map(|p| p.name).collect();
        assert_eq!(keys.len(), effect.parameters.len(), "{name}");
        assert!(keys.iter().all(|key| word(key)), "{name}");
        assert_eq!(Effect::from_name(name).map(|e| e.name), Some(name));
    }
}

/// The declaration of an effect holds for its parameters.
#[test]
fn properties_fit_the_parameters() {
    for effect in EFFECTS {
        let name = effect.name;
        for property in effect.properties {
            match *property {
                Property::Optional(left_out) => {
                    let there = effect.parameters.iter().any(|p| p.name == left_out);
                    assert!(there, "{name} has no {left_out}");
                }
                Property::Recurs => assert!(effect.happens(), "{name} is of the machine"),
                Property::Parts(_) => {
                    let parts = effect.parts(&effect.neutral()).into_iter().flatten();
                    for (part, values) in parts {
                        assert!(
                            part.vanishes(&values),
                            "{name}, of which {} is left",
                            part.name
                        );
                    }
                }
                _ => {}
            }
        }
    }
}

proptest! {
    /// A walk over the sizes goes from one to the next by a factor.
    #[test]
    fn sizes_of_many_minima_are_in_order_and_above_zero(scales in scales()) {
        for effect in EFFECTS.iter().filter(|effect| effect.has_many_minima()) {
            let starts = (effect.starts)(&scales);
            let sizes: Vec<f64> = starts.iter().map(|values| values[effect.size()]).collect();
            let in_order = sizes.is_sorted() || sizes.iter().rev().is_sorted();
            let least = sizes.iter().copied().fold(f64::INFINITY, f64::min);
            prop_assert!(least > 0.0 && in_order, "{}: {sizes:?}", effect.name);
        }
    }
}

#[test]
fn places_have_names() {
    for effect in EFFECTS {
        for place in effect.places {
            assert_eq!(Place::from_name(place.name()), Some(*place));
        }
    }
}

proptest! {
    #[test]
    fn bounds_hold_what_is_met_and_tried(scales in scales()) {
        for effect in EFFECTS {
            let bounds: Vec<_> = effect.parameters.iter().map(|p| (p.bounds)(&scales)).collect();
            for (parameter, &(low, high)) in effect.parameters.iter().zip(&bounds) {
                let what = format!("{} {}: {low} .. {high}", effect.name, parameter.name);
                prop_assert!(low < high && low.is_finite() && high.is_finite(), "{what}");
                let typical = (parameter.typical)(&scales);
                prop_assert!(typical != 0.0 && low <= typical && typical <= high, "{what}: {typical}");
                // The others only need a harmless value: a frequency of 0 is none that a fit may try.
                if parameter.role == ParameterRole::Size {
                    prop_assert!(low <= parameter.neutral && parameter.neutral <= high, "{what}");
                }
            }
            let starts = (effect.starts)(&scales);
            let most = [12, 48, 24, 40, 48][effect.parameters.len() - 1];
            prop_assert!((1..=most).contains(&starts.len()), "{}: {}", effect.name, starts.len());
            for start in &starts {
                prop_assert_eq!(start.len(), effect.parameters.len());
                prop_assert!(!effect.vanishes(start), "{}: {start:?}", effect.name);
                let inside = start.iter().zip(&bounds).all(|(v, (low, high))| low <= v && v <= high);
                prop_assert!(inside, "{}: {start:?} not in {bounds:?}", effect.name);
            }
        }
    }

    #[test]
    fn neutral_changes_nothing_to_the_bit(
        scales in scales(),
        parts in prop::array::uniform5(0.0..=1.0f64),
        series in prop::collection::vec(-3.0..3.0f64, 12),
    ) {
        for effect in EFFECTS {
            let mut values = within(effect, &scales, &parts);
            values[effect.size()] = effect.parameters[effect.size()].neutral;
            for parameters in [values, effect.neutral()] {
                let law = (effect.law)(&parameters);
                let result = changes_nothing(&law, &series);
                prop_assert!(result.is_ok(), "{} at {parameters:?}: {result:?}", effect.name);
            }
        }
    }

    #[test]
    fn laws_keep_their_promises(scales in scales(), parts in prop::array::uniform5(0.0..=1.0f64)) {
        for effect in EFFECTS {
            let parameters = within(effect, &scales, &parts);
            match (effect.law)(&parameters) {
                Law::Friction(Friction { kinetic, breakaway, stribeck_velocity, transition_velocity, .. }) => {
                    prop_assert!(stribeck_velocity > 0.0);
                    let creeps = transition_velocity > 0.0;
                    prop_assert!((0..2).all(|k| 0.0 <= kinetic[k] && (creeps || kinetic[k] <= breakaway[k])));
                }
                Law::Inertia(inertia) => {
                    for y in [scales.position.0, scales.position.1] {
                        prop_assert!(inertia.factor(scales.span.1, y) > 0.0, "{}", effect.name);
                    }
                }
                Law::Resonance(mode) => {
                    prop_assert!(mode.natural_frequency > 0.0 && (0.0..=0.5).contains(&mode.damping_ratio));
                }
                Law::Force(force) => {
                    let memory = Memory { time: scales.span.0, ..Memory::default() };
                    let (x, v) = (0.3 * scales.deformation, 0.2 * scales.deformation_rate);
                    let motion = Motion { time: scales.span.0 + scales.sample_time, ..motion() };
                    prop_assert!(force.force(&motion, x, v, &memory).is_finite(), "{}", effect.name);
                    prop_assert!(force.advance(&motion, x, v, &memory).is_finite(), "{}", effect.name);
                }
                _ => {}
            }
        }
    }
}

/// Whether a law leaves the chain as it was, as far as the law alone can tell.
fn changes_nothing(law: &Law, series: &[f64]) -> Result<(), String> {
    let same = |found: f64, expected: f64, what: &str| match found == expected {
        true => Ok(()),
        false => Err(format!("{what}: {found}, not {expected}")),
    };
    let time: Vec<f64> = (0..series.len()).map(|k| 0.1 * k as f64).collect();
    match law {
        Law::Force(force) => {
            if !force.breaks().is_empty()
                || force
                    .switch(&motion(), 0.1, 0.2, &Memory::default())
                    .is_some()
            {
                return Err("steps are split".into());
            }
            let mut memory = Memory::default();
            for (&time, pair) in time.iter().zip(series.windows(2)) {
                let motion = Motion { time, ..motion() };
                same(
                    force.force(&motion, pair[0], pair[1], &memory),
                    0.0,
                    "force",
                )?;
                force.remember(&motion, pair[0], pair[1], &mut memory);
            }
        }
        Law::Friction(friction) => {
            for k in 0..2 {
                same(friction.kinetic[k], 0.0, "kinetic")?;
                same(friction.breakaway[k], 0.0, "breakaway")?;
            }
        }
        Law::Drive(drive) => {
            let mut values = series.to_vec();
            drive.run(&time, &mut values);
            for (found, expected) in values.iter().zip(series) {
                same(*found, *expected, "series")?;
                same(drive.map(*expected), *expected, "map")?;
            }
        }
        Law::Kinematic(error) => {
            for u in series {
                let [shift, slope] = error(*u);
                same(shift, 0.0, "shift")?;
                same(slope, 0.0, "slope")?;
            }
        }
        Law::Inertia(inertia) => {
            if !inertia.breaks().is_empty() {
                return Err("steps are split".into());
            }
            for (time, y) in time.iter().zip(series) {
                same(inertia.factor(*time, *y), 1.0, "factor")?;
                same(inertia.slope(*time, *y), 0.0, "slope")?;
            }
        }
        Law::Resonance(mode) => same(mode.share, 0.0, "share")?,
        Law::Impulse(own) => same(own.size, 0.0, "size")?,
        Law::Sensor(sensor) => {
            let curve: Vec<_> = series.iter().map(|v| [*v, 0.5 * v]).collect();
            let mut filtered = curve.clone();
            sensor.filter(&time, &mut filtered, None);
            if sensor.filters() || filtered != curve {
                return Err("filters".into());
            }
            for (time, pair) in time.iter().zip(series.windows(2)) {
                let [value, motor] = [pair[0], pair[1]];
                let time = *time;
                same(sensor.instant(time), time, "instant")?;
                for tracked in [false, true] {
                    let reading = Reading {
                        time,
                        value,
                        motor,
                        tracked,
                    };
                    same(sensor.read(&reading), value, "value")?;
                }
            }
        }
    }
    Ok(())
}

/// State of a law after a walk through these positions.
fn walk(force: &dyn Force, start: Memory, positions: &[f64], duration: f64) -> Memory {
    let step = duration / positions.len() as f64;
    positions.iter().fold(start, |mut memory, &position| {
        let time = memory.time + step;
        let motion = Motion { time, ..motion() };
        force.remember(&motion, position, 0.0, &mut memory);
        memory
    })
}

/// Positions from `from` to `to` in equal steps.
fn line(from: f64, to: f64, steps: usize) -> Vec<f64> {
    (1..=steps)
        .map(|k| from + (to - from) * k as f64 / steps as f64)
        .collect()
}

proptest! {
    #[test]
    fn hysteresis_and_creep_do_not_depend_on_the_steps(
        distance in 0.05..3.0f64,
        shape in 0.0..3.0f64,
        sharpness in 0.0..=1.0f64,
        turns in prop::collection::vec(-2.0..2.0f64, 1..6),
        steps in 2..9usize,
    ) {
        for (name, parameters) in [
            ("presliding_hysteresis", vec![1.0, distance, 0.0, 0.0, 0.0]),
            ("hysteretic_stiffness", vec![0.5, distance, shape, sharpness]),
            ("viscoelastic_creep", vec![0.5, distance]),
        ] {
            let law = force(name, &parameters);
            let (mut coarse, mut fine) = (Memory::default(), Memory::default());
            for &turn in &turns {
                fine = walk(&*law, fine, &line(fine.position, turn, steps), 1.0);
                coarse = walk(&*law, coarse, &[turn], 1.0);
                // Rounding of a handful of exponentials.
                prop_assert!((fine.state - coarse.state).abs() < 1e-12, "{name}: {fine:?} {coarse:?}");
            }
        }
    }

    #[test]
    fn a_closed_loop_never_gives_energy(
        distance in 0.02..3.0f64,
        shape in 0.0..3.0f64,
        sharpness in 0.0..=1.0f64,
        inner in -1.0..1.0f64,
    ) {
        for (name, parameters) in [
            ("presliding_hysteresis", vec![1.0, distance, 0.0, 0.0, 0.0]),
            ("hysteretic_stiffness", vec![0.5, distance, shape, sharpness]),
        ] {
            let law = force(name, &parameters);
            // Until the loop closes, then once round, with a smaller loop within.
            let round = [1.0, inner, 1.0, -1.0];
            let mut memory = Memory::default();
            for _ in 0..400 {
                for turn in round {
                    memory = walk(&*law, memory, &[turn], 1.0);
                }
            }
            let mut energy = 0.0;
            for turn in round {
                let mut before = law.force(&motion(), memory.position, 0.0, &memory);
                for x in line(memory.position, turn, 400) {
                    let now = law.force(&motion(), x, 0.0, &memory);
                    energy += 0.5 * (before + now) * (x - memory.position);
                    before = now;
                    memory = walk(&*law, memory, &[x], 0.0);
                }
            }
            // The trapezoidal rule at 400 steps a branch of length up to 2: h^2 / 12 F'' x, with
            // F'' up to (1 + sharpness) (1 + shape) / distance of a unit force.
            let steep = (1.0 + sharpness) * (1.0 + shape).powi(2) / distance;
            let rule = 8.0 * (2.0f64 / 400.0).powi(2) / 12.0 * steep;
            prop_assert!(energy > -rule - 1e-9, "{name}: {energy}");
        }
    }

    #[test]
    fn derivatives_are_those_of_their_functions(
        curvature in -0.1..2.0f64, centre in -2.0..2.0f64, y in -2.0..2.0f64, order in 0.0..3.0f64,
    ) {
        let h = 1e-5;
        let inertia = inertia("pose_dependent_frequency", &[curvature, centre, 1.0, order]);
        let slope = (inertia.factor(0.0, y + h) - inertia.factor(0.0, y - h)) / (2.0 * h);
        // Rounding of 1e-16 * 30 over 2e-5.
        prop_assert!((inertia.slope(0.0, y) - slope).abs() < 1e-9);
        let Law::Kinematic(ripple) = (effect("transmission_ripple").law)(&[curvature, 5.0, centre])
        else { panic!("no kinematic law") };
        let slope = (ripple(y + h)[0] - ripple(y - h)[0]) / (2.0 * h);
        // h^2 / 6 times the third derivative, 2 * 5^3.
        prop_assert!((ripple(y)[1] - slope).abs() < 1e-8);
    }
}

#[test]
fn val_bouc_wen_against_fine_integration() {
    let (share, yields, unloading) = (0.4, 0.3, 0.35);
    for sharpness in [0.0, 0.5, 1.0] {
        let law = force(
            "hysteretic_stiffness",
            &[share, yields, unloading, sharpness],
        );
        let mut memory = Memory::default();
        let (mut z, mut x) = (0.0f64, 0.0f64);
        for turn in [0.8, 0.1, 0.5, -0.9, -0.6, 0.2, -0.1] {
            let steps = 20_000;
            let h = (turn - x) / f64::from(steps);
            // Wen's law for the exponents 1 and 2: beta sign(x') z |z|^(n - 1) + gamma |z|^n.
            let power = |z: f64, n: i32| {
                let (beta, gamma) = (0.5 * (1.0 + unloading), 0.5 * (1.0 - unloading));
                let own = (z / yields).abs().powi(n);
                beta * h.signum() * z.signum() * own + gamma * own
            };
            let rate = |z: f64| 1.0 - (1.0 - sharpness) * power(z, 1) - sharpness * power(z, 2);
            for _ in 0..steps {
                let middle = z + 0.5 * h * rate(z);
                z += h * rate(middle);
            }
            x = turn;
            let force = law.force(&motion(), x, 0.0, &memory);
            memory = walk(&*law, memory, &[x], 0.0);
            // Second order at steps of 1e-4 and rates of 4: 1e-8 and less.
            assert_near(memory.state, z, 2e-8, "hysteretic part");
            assert_near(force, share * (z - x), 2e-8, "force");
        }
    }
}

/// Bristles of the LuGre model, `z' = v - |v| z / g(v)`: against steps of a thousandth where the velocity swings through the
/// Stribeck curve, and at a constant velocity, where the force is `F g(v)`.
#[test]
fn val_lugre_bristles_against_fine_integration() {
    let (friction, distance, excess, stribeck, bent) = (0.7, 0.02, 0.4, 0.3, 2e-3);
    let law = force(
        "presliding_hysteresis",
        &[friction, distance, excess, stribeck, bent],
    );
    let level = |v: f64| 1.0 + excess * (-(v / stribeck).powi(2)).exp();
    let rate = |v: f64, z: f64| v * (1.0 - v.signum() * z / level(v)) / distance;
    let (mut memory, mut z, mut t) = (Memory::default(), 0.0f64, 0.0f64);
    law.remember(&motion(), 0.0, 1.0, &mut memory);
    // Steps end where the motion turns.
    let step = PI / 2000.0;
    for _ in 0..4000 {
        for _ in 0..1000 {
            let h = 1e-3 * step;
            let middle = z + 0.5 * h * rate(t.cos(), z);
            z += h * rate((t + 0.5 * h).cos(), middle);
            t += h;
        }
        let (x, v) = (t.sin(), t.cos());
        let now = law.force(&motion(), x, v, &memory);
        law.remember(
            &Motion {
                time: t,
                ..motion()
            },
            x,
            v,
            &mut memory,
        );
        assert_near(memory.state, z, 2e-6, "deflection");
        let force = friction * (z + bent * rate(v, z));
        assert_near(now, force, 2e-6, "force");
    }
    for v in [0.05, 0.3, -2.0] {
        let mut memory = Memory {
            states: [v; 8],
            ..Memory::default()
        };
        for k in 1..=4000 {
            let time = f64::from(k) * 0.01;
            law.remember(&Motion { time, ..motion() }, v * time, v, &mut memory);
        }
        let steady = law.force(&motion(), v * 40.0, v, &memory);
        assert_near(steady, friction * level(v) * v.signum(), 1e-12, "steady");
    }
}

#[test]
fn val_dahl_loop_closes_at_tanh_and_dissipates_its_area() {
    let (friction, distance, amplitude) = (0.7, 0.3f64, 0.5f64);
    let law = force(
        "presliding_hysteresis",
        &[friction, distance, 0.0, 0.0, 0.0],
    );
    let mut memory = Memory::default();
    for _ in 0..40 {
        memory = walk(&*law, memory, &[-amplitude, amplitude], 0.0);
    }
    let end = (amplitude / distance).tanh();
    assert_near(memory.state, end, 1e-14, "end of the loop");
    let mut energy = 0.0;
    for turn in [-amplitude, amplitude] {
        let path = line(memory.position, turn, 4000);
        let mut before = law.force(&motion(), memory.position, 0.0, &memory);
        for x in path {
            let now = law.force(&motion(), x, 0.0, &memory);
            energy += 0.5 * (before + now) * (x - memory.position);
            (before, memory) = (now, walk(&*law, memory, &[x], 0.0));
        }
    }
    // 4 F (A - x_s tanh(A / x_s)), by hand; the trapezoidal rule at 4000 steps.
    let area = 4.0 * friction * (amplitude - distance * end);
    assert_near(energy, area, 1e-6, "energy of the loop");
}

#[test]
fn val_maxwell_branch_relaxes_and_creeps() {
    let (stiffness, tau) = (0.5, 0.2f64);
    let law = force("viscoelastic_creep", &[stiffness, tau]);
    // A step at once, then held: exp(-t / T).
    let held = walk(&*law, Memory::default(), &[1.0], 0.0);
    assert_near(held.state, 1.0, 1e-15, "at once");
    let later = Motion {
        time: 0.3,
        ..motion()
    };
    assert_near(
        law.force(&later, 1.0, 0.0, &held),
        stiffness * (-0.3 / tau).exp(),
        1e-15,
        "held",
    );
    // A ramp of rate 2: the damper carries T x' in the end.
    let ramp = walk(&*law, Memory::default(), &line(0.0, 20.0, 7), 10.0);
    assert_near(ramp.state, 2.0 * tau, 1e-12, "ramp");
}

#[test]
fn val_backlash_is_free_inside_and_pushes_outside() {
    let law = force("backlash", &[0.4, 0.0]);
    let branch = |x: f64, v: f64| Memory {
        position: x,
        state: law.advance(&motion(), x, v, &Memory::default()),
        ..Memory::default()
    };
    let total = |x: f64, v: f64| x + 0.1 * v + law.force(&motion(), x, v, &branch(x, v));
    for (x, v, expected) in [
        (0.15, 3.0, 0.0),
        (-0.19, -3.0, 0.0),
        (0.5, 1.0, 0.4),
        (-0.5, -1.0, -0.4),
        // The flank lifts off where spring and damper would pull: 0.05 - 0.1 < 0.
        (0.25, -1.0, 0.0),
        (-0.25, 1.0, 0.0),
    ] {
        assert_near(total(x, v), expected, 1e-15, "force across the gap");
    }
    // From contact to lift-off at 0.05 - 0.1 / 2, from inside to the flank at 0.2, from a flank straight
    // through the gap.
    let switch = |memory: &Memory, x: f64, v: f64| law.switch(&motion(), x, v, memory).unwrap();
    let (pushing, inside) = (branch(0.5, 0.0), branch(0.1, 0.0));
    assert!(switch(&pushing, 0.25, -0.49) > 0.0 && switch(&pushing, 0.25, -0.51) < 0.0);
    assert!(switch(&inside, 0.19, 1.0) < 0.0 && switch(&inside, 0.21, 1.0) > 0.0);
    assert!(switch(&pushing, -0.5, -1.0) < 0.0);
    // With all of the damper beside the gap the flanks are springs alone.
    let law = force("backlash", &[0.4, 1.0]);
    for (x, v, expected) in [(0.15, 3.0, 0.3), (0.5, 1.0, 0.4), (0.25, -1.0, -0.05)] {
        let memory = Memory {
            state: law.advance(&motion(), x, v, &Memory::default()),
            ..Memory::default()
        };
        let total = x + 0.1 * v + law.force(&motion(), x, v, &memory);
        assert_near(total, expected, 1e-15, "force across the gap with oil");
    }
}

/// tanh(ln 3 / 2) = 1 / 2.
#[test]
fn val_smooth_coulomb_friction_by_hand() {
    let effect = Effect::from_name("smooth_coulomb_friction").unwrap();
    let Law::Friction(law) = (effect.law)(&[2.0, 0.1]) else {
        panic!("it is no friction")
    };
    let half = law.level(-1.0, 0.0, 0.05 * 3f64.ln());
    assert!((half - 1.0).abs() < 1e-15, "{half}");
    assert_eq!(law.breakaway, [0.0; 2]);
}

#[test]
fn val_forces_by_hand() {
    let at = |name: &str, parameters: &[f64], x: f64, v: f64| {
        let motion = Motion {
            time: 2.0,
            ..motion()
        };
        let (law, mut memory) = (force(name, parameters), Memory::default());
        memory.state = law.advance(&motion, x, v, &memory);
        law.force(&motion, x, v, &memory)
    };
    for (name, parameters, x, v, expected) in [
        ("viscous_friction", vec![2.0], 0.3, -0.5, -1.0),
        ("viscous_drag", vec![2.0], 0.3, -0.5, -1.0),
        ("force_offset", vec![2.0], 0.3, -0.5, 2.0),
        (
            "cogging",
            vec![2.0, 5.0, 0.0],
            std::f64::consts::PI / 10.0,
            0.0,
            2.0,
        ),
        ("quadratic_damping", vec![2.0], 0.0, -3.0, -18.0),
        ("quadratic_drag", vec![2.0], 0.0, -3.0, -18.0),
        ("cubic_stiffness", vec![2.0], 0.5, 0.0, 0.25),
        // 0.2 beyond the knee at 0.3, 1 + a = 1.5.
        ("bilinear_stiffness", vec![0.5, 0.3, 0.0], 0.5, 0.0, 0.1),
        ("bilinear_stiffness", vec![0.5, 0.3, 0.0], -0.5, 0.0, -0.1),
        ("bilinear_stiffness", vec![0.5, 0.3, 1.0], 0.5, 0.0, 0.2),
        ("bilinear_stiffness", vec![0.5, 0.3, 1.0], -0.5, 0.0, 0.0),
        ("stiffness_drift", vec![0.1, 0.0], 0.5, 0.0, 0.1),
        ("gravity_load", vec![2.0, 0.0], 0.0, 0.0, 2.0),
        ("end_stop", vec![10.0, 1.0, 0.1, 0.0, 1.0], 0.9, 5.0, 0.0),
        ("end_stop", vec![10.0, 1.0, 0.1, 0.0, 1.0], 1.5, 1.0, 6.0),
        ("end_stop", vec![10.0, 1.0, 0.1, 0.0, 1.0], 1.5, -9.0, 0.0),
        (
            "end_stop",
            vec![10.0, -1.0, 0.1, 0.0, -1.0],
            -1.5,
            -1.0,
            -6.0,
        ),
        (
            "end_stop",
            vec![10.0, -1.0, 0.1, 0.0, -1.0],
            -0.5,
            -1.0,
            0.0,
        ),
        // By Hunt and Crossley: no jump at the contact, no pull on the way back.
        ("end_stop", vec![10.0, 1.0, 0.0, 0.5, 1.0], 1.5, 1.0, 7.5),
        ("end_stop", vec![10.0, 1.0, 0.0, 0.5, 1.0], 1.0, 1.0, 0.0),
        ("end_stop", vec![10.0, 1.0, 0.0, 0.5, 1.0], 1.5, -3.0, 0.0),
    ] {
        assert_near(at(name, &parameters, x, v), expected, 1e-14, name);
    }
}

#[test]
fn val_drives_by_hand() {
    let peak = 1.0 / 0.03f64.sqrt();
    for (name, parameters, value, expected) in [
        ("dead_zone", &[0.3][..], 1.0, 0.7),
        ("dead_zone", &[0.3], -1.0, -0.7),
        ("dead_zone", &[0.3], -0.2, 0.0),
        ("saturation", &[0.3], -1.0, -0.3),
        ("saturation", &[0.3], 0.2, 0.2),
        ("torque_constant_nonlinearity", &[0.1, 1.0], -2.0, -1.6),
        // No less beyond the peak at 1 / (2 a) = 5.
        ("torque_constant_nonlinearity", &[0.1, 1.0], 8.0, 2.5),
        ("torque_constant_nonlinearity", &[0.1, 2.0], -2.0, -1.92),
        // Nor beyond that at 1 / (a sqrt 3), where two thirds of the input arrive.
        (
            "torque_constant_nonlinearity",
            &[0.1, 2.0],
            8.0,
            peak * 2.0 / 3.0,
        ),
    ] {
        assert_near(drive(name, parameters).map(value), expected, 1e-14, name);
    }
    let time: Vec<f64> = (0..=20).map(|k| 0.05 * f64::from(k)).collect();
    let mut step: Vec<f64> = time
        .iter()
        .map(|t| if *t > 0.0 { 1.0 } else { 0.0 })
        .collect();
    drive("rate_limit", &[2.0]).run(&time, &mut step);
    for (t, value) in time.iter().zip(step) {
        assert_near(value, (2.0 * t).min(1.0), 1e-12, "rate_limit");
    }
}

#[test]
fn val_delay_shifts_a_parabola_exactly() {
    let time: Vec<f64> = (0..40)
        .map(|k| 0.1 * f64::from(k) + 0.03 * f64::from(k % 3))
        .collect();
    let curve = |t: f64| 0.3 + t * (2.0 - 0.7 * t);
    let mut values: Vec<f64> = time.iter().map(|t| curve(*t)).collect();
    let delay = 0.23;
    drive("drive_delay", &[delay]).run(&time, &mut values);
    for (t, value) in time.iter().zip(values) {
        // One-sided slopes in the first interval; before it the first value.
        let instant = t - delay;
        if instant > time[1] {
            assert_near(value, curve(instant), 1e-12, "delayed");
        } else if instant <= 0.0 {
            assert_near(value, 0.3, 0.0, "before the start");
        }
    }
}

#[test]
fn val_first_order_lag_of_a_ramp() {
    let (tau, time): (f64, Vec<f64>) = (0.08, (0..60).map(|k| 0.01 * f64::from(k)).collect());
    let expected = |t: f64| 3.0 * (t - tau * (1.0 - (-t / tau).exp()));
    let mut curve: Vec<_> = time.iter().map(|t| [3.0 * t, 3.0]).collect();
    sensor("sensor_lag", &[tau]).filter(&time, &mut curve, None);
    let mut values: Vec<_> = time.iter().map(|t| 3.0 * t).collect();
    drive("drive_lag", &[tau]).run(&time, &mut values);
    for (k, t) in time.iter().enumerate() {
        assert_near(curve[k][0], expected(*t), 1e-13, "sensor_lag");
        assert_near(values[k], expected(*t), 1e-13, "drive_lag");
    }
}

/// Values and rates of `sin(w t)`, and what a filter of this response makes of them in the end.
fn val_of_a_sine(filter: &dyn Sensor, w: f64, response: [f64; 2]) {
    let time: Vec<f64> = (0..8000).map(|k| 0.002 * f64::from(k)).collect();
    let mut curve: Vec<_> = time
        .iter()
        .map(|t| [(w * t).sin(), w * (w * t).cos()])
        .collect();
    filter.filter(&time, &mut curve, None);
    let [real, imaginary] = response;
    for (t, [value, rate]) in time.iter().zip(curve).skip(6000) {
        let (sin, cos) = (w * t).sin_cos();
        // The cubic's error, h^4 / 384 w^4, and what is left of the free motion.
        assert_near(value, real * sin + imaginary * cos, 1e-9, "value");
        assert_near(rate, w * (real * cos - imaginary * sin), 1e-6, "rate");
    }
}

#[test]
fn val_lags_of_a_sine() {
    let w = 9.0;
    // Long and short against the sampling period of 0.002 s: the series and the closed form.
    for tau in [0.05, 0.004, 1e-4] {
        let r = w * tau;
        let size = 1.0 + r * r;
        let law = sensor("sensor_lag", &[tau]);
        val_of_a_sine(&*law, w, [1.0 / size, -r / size]);
        for xi in [0.2, 0.7, 1.0, 1.0 + 1e-9, 2.5] {
            let (a, b) = (1.0 - r * r, 2.0 * xi * r);
            let size = a * a + b * b;
            let law = sensor("sensor_lag_second_order", &[tau, xi]);
            val_of_a_sine(&*law, w, [a / size, -b / size]);
        }
    }
}

#[test]
fn val_second_order_lag_of_a_step_held() {
    // Free motion alone: a jump from 1 to 0 within one short interval, then rest.
    let (tau, xi): (f64, f64) = (0.1, 0.3);
    let time: Vec<f64> = [0.0, 1e-9]
        .into_iter()
        .chain((1..40).map(|k| 0.02 * f64::from(k)))
        .collect();
    let mut curve = vec![[0.0, 0.0]; time.len()];
    curve[0] = [1.0, 0.0];
    sensor("sensor_lag_second_order", &[tau, xi]).filter(&time, &mut curve, None);
    let (w, root) = (1.0 / tau, (1.0 - xi * xi).sqrt());
    for (t, [value, _]) in time.iter().zip(curve).skip(1) {
        let angle = root * w * t;
        let free = (-xi * w * t).exp() * (angle.cos() + xi / root * angle.sin());
        // The jump takes 1e-9 s of a time constant of 0.1 s.
        assert_near(value, free, 1e-6, "free motion");
    }
}

/// A tip on a circle, in a frame that moves by a little in two directions.
#[test]
fn val_a_frame_that_drifts_turns_the_tip_by_its_angle() {
    let (rate, growth, time) = (1e-6, -0.7, 2.0);
    for angle in [-2.5_f64, -0.4, 0.0, 1.1, 3.0] {
        let reading = Reading {
            time,
            value: angle,
            motor: angle,
            tracked: true,
        };
        let seen = sensor("sensor_drift", &[rate, growth, 0.0]).read(&reading);
        let moved = [-rate * growth * time, rate * time];
        let tip = [angle.cos() + moved[0], angle.sin() + moved[1]];
        let turned = (tip[1] * angle.cos() - tip[0] * angle.sin()).asin();
        // The second order of the displacement.
        assert_near(seen - angle, turned, 1e-11, "sensor_drift");
    }
}

#[test]
fn val_sensors_by_hand() {
    let reading = Reading {
        time: 2.0,
        value: 1.5,
        motor: 1.0,
        tracked: false,
    };
    for (name, parameters, expected) in [
        ("sensor_gain", vec![0.1], 1.65),
        ("deformation_gain", vec![0.1], 1.55),
        ("sensor_drift", vec![0.1, 0.0, 0.0], 1.7),
        ("sensor_drift", vec![0.1, 0.5, 0.0], 1.85),
        // (1 - exp(-1)) / 0.5 instead of 2.
        ("sensor_drift", vec![0.1, 0.0, 0.5], 1.626_424_111_765_711_5),
        ("quantisation", vec![0.4], 1.6),
        (
            "misalignment",
            vec![0.1, std::f64::consts::FRAC_PI_2 - 1.5],
            1.6,
        ),
    ] {
        assert_near(
            sensor(name, &parameters).read(&reading),
            expected,
            1e-15,
            name,
        );
    }
    assert_near(
        sensor("sensor_delay", &[0.1]).instant(2.0),
        1.9,
        1e-15,
        "sensor_delay",
    );
    assert_near(
        sensor("clock_skew", &[1e-3]).instant(2.0),
        2.002,
        1e-15,
        "clock_skew",
    );
    let payload = inertia("payload_change", &[0.5, 1.0]);
    assert_eq!(
        (payload.factor(0.9, 0.0), payload.factor(1.0, 0.0)),
        (1.0, 1.5)
    );
    assert_eq!(payload.breaks(), [1.0]);
}
