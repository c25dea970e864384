//! Axes with friction in their bearings, simulated by this file alone: one whose motor side is measured, and one that a
//! torque drives, with a loop that the model does not know.

mod cycloids;

use cycloids::cycloids;
use quell::diagnosis::{Diagnosis, Finding, Options, Outcome, Verdict, diagnose};
use quell::effects::{Effect, Law};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

/// One step of the classical Runge-Kutta method.
fn step<const N: usize>(
    rates: impl Fn(f64, &[f64; N]) -> [f64; N],
    t: f64,
    h: f64,
    x: &mut [f64; N],
) {
    let along = |x: &[f64; N], k: &[f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let k1 = rates(t, x);
    let k2 = rates(t + h / 2.0, &along(x, &k1, h / 2.0));
    let k3 = rates(t + h / 2.0, &along(x, &k2, h / 2.0));
    let k4 = rates(t + h, &along(x, &k3, h));
    *x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
}

/// Position and velocity of moves without a jump of the acceleration, each with rest after it.
fn moves(t: f64) -> [f64; 2] {
    let all = [
        (0.2, 0.5, 0.5),
        (1.1, 0.7, -0.9),
        (2.3, 0.4, 0.3),
        (3.2, 0.8, 0.8),
        (4.5, 0.5, -0.5),
    ];
    cycloids(&all, t)
}

/// Seconds of a recording.
const LENGTH: f64 = 6.0;
/// Standard deviation of the noise of a position, rad.
const NOISE: f64 = 1e-5;

/// Steps of a simulation, s.
const FINE: f64 = 1e-4;

/// A force that a loop computes from the reference and the state, and that is held for `every` steps, and the positions of
/// motor and link that it drives: state `[u, u', y, y']`.
fn in_a_loop(
    rates: impl Fn(f64, &[f64; 4]) -> [f64; 4],
    mut computed: impl FnMut([f64; 2], &[f64; 4]) -> f64,
    every: usize,
) -> [Vec<f64>; 3] {
    let (mut x, mut force) = ([0.0; 4], 0.0);
    let mut seen = [Vec::new(), Vec::new(), Vec::new()];
    for k in 0..(LENGTH / FINE) as usize {
        if k % every == 0 {
            force = computed(moves(k as f64 * FINE), &x);
            let values = [force, x[0], x[2]];
            seen.iter_mut()
                .zip(values)
                .for_each(|(all, value)| all.push(value));
        }
        step(|_, x: &[f64; 4]| rates(force, x), 0.0, FINE, &mut x);
    }
    seen
}

fn diagnosed(model: &str, channels: Vec<(Role, &str, Vec<f64>)>, rate: f64) -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let channels = channels.into_iter().map(|(role, unit, mut values)| {
        if unit == "rad" && role != Role::CommandPosition {
            for value in &mut values {
                *value += NOISE * random.sample::<f64, _>(StandardNormal);
            }
        }
        Channel {
            role,
            unit: unit.into(),
            time: (0..values.len()).map(|k| k as f64 / rate).collect(),
            columns: vec![values],
        }
    });
    let recording = Recording {
        payload: None,
        name: "moves".into(),
        channels: channels.collect(),
    };
    let model = Model::from_toml(model, "model.toml").unwrap();
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    outcome.unwrap()
}

/// The diagnosis of a torque by the motion that it makes. The torque stands first: the unit of positions is not its own.
fn inverted(keys: &str, [torque, position]: [Vec<f64>; 2], rate: f64) -> Diagnosis {
    let channels = vec![
        (Role::Torque, "N.m", torque),
        (Role::MotorPosition, "rad", position),
    ];
    diagnosed(
        &format!("kind = \"inverse_dynamics\"\n{keys}"),
        channels,
        rate,
    )
    .diagnosis
}

/// The value of a parameter of a finding at a place, and whether its interval holds the truth.
fn check(diagnosis: &Diagnosis, effect: &str, place: &str, parameter: &str, truth: f64) {
    let mut findings = diagnosis.findings.iter();
    let finding = findings.find(|own| own.effect == effect && own.place == place);
    let finding = finding.unwrap_or_else(|| panic!("no {effect}: {}", diagnosis.summary));
    let own = finding.parameters.iter().find(|own| own.name == parameter);
    let value = own.unwrap().value;
    assert!(
        (value / truth - 1.0).abs() < 0.05,
        "{parameter} {value}, {truth}"
    );
}

/// Friction `F tanh(v / v_0)` in the link's bearing is neither drag nor friction across the joint.
#[test]
fn a_bearing_that_creeps_is_named() {
    let (w, damping) = (TAU * 7.0, 0.03);
    let (friction, transition) = (0.6, 0.004);
    let rates = |t: f64, x: &[f64; 2]| {
        let [u, v] = moves(t);
        let elastic = w * w * (u - x[0]) + 2.0 * damping * w * (v - x[1]);
        [x[1], elastic - friction * (x[1] / transition).tanh()]
    };
    let (fine, every, mut x) = (1e-4, 40, [0.0; 2]);
    let (mut motor, mut link) = (Vec::new(), Vec::new());
    for k in 0..(LENGTH / fine) as usize {
        let t = k as f64 * fine;
        if k % every == 0 {
            motor.push(moves(t)[0]);
            link.push(x[0]);
        }
        step(rates, t, fine, &mut x);
    }
    let told = diagnosed(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 7.3\ndamping_ratio = 0.04\n",
        vec![
            (Role::MotorPosition, "rad", motor),
            (Role::LinkPosition, "rad", link),
        ],
        1.0 / (fine * every as f64),
    );
    let of = |parameter, truth| {
        check(
            &told.diagnosis,
            "smooth_coulomb_friction",
            "link",
            parameter,
            truth,
        )
    };
    of("friction", friction / (w * w));
    of("transition_velocity", transition);
}

/// The second difference of this noise is 6 rad/s^2 at 500 Hz: seen through it, a lag that smoothes and an advance that takes the lag back
/// were told in the place of the friction.
#[test]
fn inverse_dynamics_sees_friction_through_the_noise_of_a_position() {
    let (mass, friction, viscous, rate) = (0.35, 0.4, 0.25, 500.0);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut torque, mut position) = (Vec::new(), Vec::new());
    for k in 0..(LENGTH * rate) as usize {
        let t = k as f64 / rate;
        let [slow, fast] = [0.4, 0.9].map(|hertz| TAU * hertz);
        let [q, v, acceleration] = [
            0.5 * (slow * t).sin() + 0.3 * (fast * t).sin(),
            0.5 * slow * (slow * t).cos() + 0.3 * fast * (fast * t).cos(),
            -0.5 * slow * slow * (slow * t).sin() - 0.3 * fast * fast * (fast * t).sin(),
        ];
        let noise = 0.05 * random.sample::<f64, _>(StandardNormal);
        torque.push(mass * acceleration + viscous * v + friction * v.signum() + noise);
        position.push(q);
    }
    let told = inverted("mass = 0.35\n", [torque, position], rate);
    let found: Vec<&str> = told
        .findings
        .iter()
        .map(|own| own.effect.as_str())
        .collect();
    assert!(found.len() == 2, "{found:?}: {}", told.summary);
    check(
        &told,
        "coulomb_friction",
        "transmission",
        "friction",
        friction,
    );
    let drag = told
        .findings
        .iter()
        .find(|own| own.effect.starts_with("viscous"));
    let drag = &drag.unwrap().parameters[0];
    assert!((drag.value / viscous - 1.0).abs() < 0.1, "{drag:?}");
    assert_eq!(drag.unit, "N.m.s/rad");
}

/// A smoother leaves out of the acceleration what the noise of the position hides: the corners of planned moves. A lag and an
/// advance of the sensor, which leave them out, too, were told where nothing was missing.
#[test]
fn inverse_dynamics_of_planned_moves_lacks_nothing() {
    let (mass, viscous, rate) = (0.35, 0.25, 500.0);
    // Minimum-jerk moves between these positions, rad, in these times, s.
    let all = [
        (0.6, 0.8),
        (-0.4, 1.1),
        (0.5, 0.7),
        (-0.9, 1.4),
        (0.1, 0.9),
        (0.9, 1.2),
    ];
    let motion = |t: f64| {
        let (mut start, mut from) = (0.4, 0.0);
        for (to, lasts) in all.into_iter().cycle().take(3 * all.len()) {
            let s = (t - start) / lasts;
            if s < 1.0 {
                let (s, way): (f64, f64) = (s.max(0.0), to - from);
                let free = s * (1.0 - s);
                return [
                    from + way * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
                    way / lasts * 30.0 * free * free,
                    way / lasts.powi(2) * 60.0 * free * (1.0 - 2.0 * s),
                ];
            }
            (start, from) = (start + lasts + 0.2, to);
        }
        [from, 0.0, 0.0]
    };
    for (seed, deviation) in [(4, 0.004), (5, 0.02)] {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut torque, mut position) = (Vec::new(), Vec::new());
        for k in 0..(20.0 * rate) as usize {
            let [q, v, acceleration] = motion(k as f64 / rate);
            let noise = deviation * random.sample::<f64, _>(StandardNormal);
            torque.push(mass * acceleration + viscous * v + noise);
            position.push(q);
        }
        let told = inverted("mass = 0.35\nviscous = 0.25\n", [torque, position], rate);
        assert_eq!(told.verdict, Verdict::NoMismatch, "{}", told.summary);
    }
}

/// A torque that a loop makes drives the motor side, and nothing in the model brings it back.
#[test]
fn a_driven_motor_shows_its_friction_and_its_cogging() {
    let (motor, link, stiffness, damping) = (0.8, 1.1, 2200.0, 2.0);
    let (friction, transition, cogging) = (1.8, 0.02, 0.8);
    let rates = |torque: f64, x: &[f64; 4]| {
        let [u, du, y, dy] = *x;
        let elastic = stiffness * (y - u) + damping * (dy - du);
        let rubbing = friction * (du / transition).tanh() + cogging * (12.0 * u + 0.4).sin();
        let force = torque + elastic - 1.5 * du - rubbing;
        [du, force / motor, dy, (-elastic - 0.3 * dy) / link]
    };
    let every = 40;
    let servo = |[r, v]: [f64; 2], x: &[f64; 4]| 900.0 * (r - x[0]) + 60.0 * (v - x[1]);
    let [torque, motor, link] = in_a_loop(rates, servo, every);
    let told = diagnosed(
        "kind = \"two_mass\"\ninput_hold = \"zero_order\"\nmotor_inertia = 0.75\nlink_inertia = 1.2\n\
         motor_viscous = 1.3\nlink_viscous = 0.3\nstiffness = 2000.0\ndamping = 2.5\n",
        vec![
            (Role::Torque, "N.m", torque),
            (Role::MotorPosition, "rad", motor),
            (Role::LinkPosition, "rad", link),
        ],
        1.0 / (FINE * every as f64),
    );
    let told = told.diagnosis;
    check(
        &told,
        "smooth_coulomb_friction",
        "drive",
        "friction",
        friction,
    );
    check(&told, "cogging", "drive", "amplitude", cogging);
    check(&told, "cogging", "drive", "order", 12.0);
}

/// Dry friction that holds at rest, and a cogging of several periods, behind an encoder whose noise hides a hundredth of the
/// force from one sample to the next.
#[test]
fn a_heavy_axis_shows_its_friction_and_its_cogging_through_noise() {
    let (mass, viscous) = (185.0, 120.0);
    let (friction, cogging, order) = (60.0, 90.0, 40.0);
    let (fine, every) = (1e-4, 20);
    let ([mut u, mut v], mut force) = ([0.0; 2], 0.0);
    let mut seen = [Vec::new(), Vec::new()];
    for k in 0..(LENGTH / fine) as usize {
        if k % every == 0 {
            let [r, rate] = moves(k as f64 * fine);
            force = 4e5 * (r - u) + 1.5e4 * (rate - v);
            seen[0].push(force);
            seen[1].push(u);
        }
        let pull = force - viscous * v - cogging * (order * u + 0.3_f64).sin();
        if v == 0.0 && pull.abs() <= friction {
            continue;
        }
        let way = if v == 0.0 { pull.signum() } else { v.signum() };
        let next = v + fine * (pull - friction * way) / mass;
        // It stops where it would turn back. Rectangles instead of trapezia would be a delay of half a step, and are found.
        let next = if next * way < 0.0 { 0.0 } else { next };
        u += 0.5 * fine * (v + next);
        v = next;
    }
    let [force, position] = seen;
    let told = diagnosed(
        "kind = \"rigid_axis\"\nmass = 180.0\nviscous = 150.0\n",
        vec![
            (Role::Torque, "N.m", force),
            (Role::MotorPosition, "rad", position),
        ],
        1.0 / (fine * every as f64),
    );
    let told = told.diagnosis;
    check(&told, "cogging", "drive", "amplitude", cogging);
    check(&told, "cogging", "drive", "order", order);
    // At rest the coupling forgets what a breakaway force would tell: any law of dry friction may be told.
    let dry = |own: &Finding| {
        let effect = Effect::from_name(&own.effect).unwrap();
        own.place == "drive" && matches!((effect.law)(&effect.neutral()), Law::Friction(_))
    };
    assert_eq!(told.findings.iter().filter(|own| dry(own)).count(), 1);
    assert!(told.findings.len() == 2 && told.fit.after.held_out_over_noise < 1.1);
}

/// What is known of the drive decides in which unit its friction is told: that of the channel, or N.m where a key says what
/// torque it makes.
#[test]
fn val_forces_are_in_the_unit_of_what_drives_the_axis() {
    let (inertia, viscous, friction, transition, constant) = (0.02, 0.03, 0.25, 0.4, 0.12);
    let (fine, every, mut x, mut torque) = (1e-4, 40, [0.0; 2], 0.0);
    let (mut drive, mut motor) = (Vec::new(), Vec::new());
    for k in 0..(LENGTH / fine) as usize {
        let t = k as f64 * fine;
        if k % every == 0 {
            torque = 0.8 * (TAU * 0.7 * t).sin() + 0.5 * (TAU * 1.9 * t + 1.0).sin();
            drive.push(torque / constant);
            motor.push(x[0]);
        }
        let rates = |_: f64, x: &[f64; 2]| {
            let rubbing = friction * (x[1] / transition).tanh();
            [x[1], (torque - viscous * x[1] - rubbing) / inertia]
        };
        step(rates, 0.0, fine, &mut x);
    }
    let head = "kind = \"rigid_axis\"\ninput_hold = \"zero_order\"\n";
    let bare = format!("{head}mass = 0.15\nviscous = 0.2\n");
    let told = format!("{head}mass = 0.018\nviscous = 0.02\nforce_gain = {constant}\n");
    for (role, own, model, unit) in [
        (Role::MotorCurrent, "A", &bare, "A"),
        (Role::MotorVoltage, "V", &bare, "V"),
        (Role::MotorCurrent, "A", &told, "N.m"),
    ] {
        let channels = vec![
            (role, own, drive.clone()),
            (Role::MotorPosition, "rad", motor.clone()),
        ];
        let outcome = diagnosed(model, channels, 1.0 / (fine * every as f64));
        let size = if unit == "N.m" {
            friction
        } else {
            friction / constant
        };
        check(
            &outcome.diagnosis,
            "smooth_coulomb_friction",
            "drive",
            "friction",
            size,
        );
        let units: Vec<&str> = outcome.diagnosis.findings[0]
            .parameters
            .iter()
            .map(|one| one.unit.as_str())
            .collect();
        assert_eq!(units, [unit, "rad/s"]);
        let text = outcome.to_toml();
        for comment in [format!("# {unit}.s^2/rad"), format!("# {unit}\n")] {
            assert!(text.contains(&comment), "{comment}: {text}");
        }
        assert_eq!(
            text.contains("force_gain = 0.12  # N.m/A"),
            unit == "N.m",
            "{text}"
        );
        assert_eq!(text.contains("N.m"), unit == "N.m", "{text}");
    }
}

/// A loop that renews its command four times between two recorded samples. A command that was held from one to the next would
/// come one and a half ticks too late, which is no delay of the machine's.
#[test]
fn a_command_that_is_recorded_now_and_then_is_not_taken_for_held() {
    let (mass, position_gain, velocity_gain, tick) = (95.0, 20.0, 3000.0, 1e-3);
    let mut state = [0.0; 2];
    let [mut command, mut position] = [Vec::new(), Vec::new()];
    for k in 0..(LENGTH / tick) as u32 {
        let asked = moves(f64::from(k) * tick)[0];
        if k % 4 == 0 {
            command.push(asked);
            position.push(state[0]);
        }
        let rates = |_: f64, &[x, v]: &[f64; 2]| {
            [v, velocity_gain * (position_gain * (asked - x) - v) / mass]
        };
        for _ in 0..10 {
            step(rates, 0.0, 0.1 * tick, &mut state);
        }
    }
    let channels = vec![
        (Role::CommandPosition, "rad", command),
        (Role::MotorPosition, "rad", position),
    ];
    let model =
        "kind = \"rigid_axis\"\nmass = 95.0\nposition_gain = 20.0\nvelocity_gain = 3000.0\n";
    let told = diagnosed(model, channels, 1.0 / (4.0 * tick)).diagnosis;
    // The command of a tick is half a tick late, which delays and lags of the drive and of the sensor explain alike.
    assert_eq!(told.findings.len(), 1, "{}", told.summary);
    let late = &told.findings[0];
    assert!(
        late.effect.ends_with("_delay") || late.effect.ends_with("_lag"),
        "{}",
        late.effect
    );
    let by = late.parameters[0].value;
    assert!((by / (0.5 * tick) - 1.0).abs() < 0.05, "{by}");
    let remark = |own: &String| own.contains("smooth curve");
    assert!(told.remarks.iter().any(remark), "{:?}", told.remarks);
}

/// A measured current is smooth between its samples, while a command is held. Friction must not hide which of both it is: half a
/// sample of delay would have to make up for it.
#[test]
fn a_measured_current_is_not_taken_for_held_beside_friction() {
    let (inertia, viscous, friction, constant, rate) = (0.05, 0.1, 0.4, 0.12, 250.0);
    let time: Vec<f64> = (0..(LENGTH * rate) as usize)
        .map(|k| k as f64 / rate)
        .collect();
    let current = |&t: &f64| {
        let [before, here, after] = [t - 1e-5, t, t + 1e-5].map(|t| moves(t)[1]);
        let rubbing = friction * (here / 0.002).tanh();
        (inertia * (after - before) / 2e-5 + viscous * here + rubbing) / constant
    };
    let told = diagnosed(
        &format!("kind = \"rigid_axis\"\nmass = 0.05\nviscous = 0.1\nforce_gain = {constant}\n"),
        vec![
            (Role::MotorCurrent, "A", time.iter().map(current).collect()),
            (
                Role::MotorPosition,
                "rad",
                time.iter().map(|&t| moves(t)[0]).collect(),
            ),
        ],
        rate,
    );
    let told = told.diagnosis;
    assert_eq!(told.findings.len(), 1, "{}", told.summary);
    check(
        &told,
        &told.findings[0].effect,
        "drive",
        "friction",
        friction,
    );
    assert!(
        told.remarks
            .iter()
            .any(|own| own.contains("straight lines")),
        "{:?}",
        told.remarks
    );
}

/// A current that an amplifier holds, and creep friction in the link's bearing: straight lines between the samples, half a sample
/// early, make up for a part of the mismatch until the friction is found.
#[test]
fn a_held_current_is_not_taken_for_smooth_beside_what_is_missing() {
    let (motor, link, stiffness, damping) = (0.6, 1.1, 1800.0, 1.2);
    let (friction, transition) = (2.0, 0.004);
    let rates = |current: f64, x: &[f64; 4]| {
        let [u, du, y, dy] = *x;
        let elastic = stiffness * (y - u) + damping * (dy - du);
        let rubbing = friction * (dy / transition).tanh();
        let force = current + elastic - 0.9 * du;
        [
            du,
            force / motor,
            dy,
            (-elastic - 0.3 * dy - rubbing) / link,
        ]
    };
    let (every, mut sum) = (20, 0.0);
    let cascade = |[r, v]: [f64; 2], x: &[f64; 4]| {
        let slow = v + 6.0 * (r - x[0]) - x[1];
        sum += slow * FINE * every as f64;
        9.0 * slow + 20.0 * sum
    };
    let [current, motor, link] = in_a_loop(rates, cascade, every);
    let told = diagnosed(
        "kind = \"two_mass\"\nmotor_inertia = 0.55\nlink_inertia = 1.0\nmotor_viscous = 0.8\n\
         link_viscous = 0.3\nstiffness = 1650.0\ndamping = 1.0\n",
        vec![
            (Role::MotorCurrent, "A", current),
            (Role::MotorPosition, "rad", motor),
            (Role::LinkPosition, "rad", link),
        ],
        1.0 / (FINE * every as f64),
    );
    let told = told.diagnosis;
    assert_eq!(told.findings.len(), 1, "{}", told.summary);
    check(
        &told,
        "smooth_coulomb_friction",
        "link",
        "friction",
        friction,
    );
    let is_other = |own: &String| own.contains("straight lines");
    assert!(!told.remarks.iter().any(is_other), "{:?}", told.remarks);
}
