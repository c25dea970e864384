//! The chain against closed forms: decay, friction, backlash, jumps, two masses, loops.

use nalgebra::Complex;
use quell::effects::{
    CandidateStop, EFFECTS, Effect, Friction, Impulse, Law, Memory, Place, Resonance, Scales,
};
use quell::model::chain::{
    Chain, ForceElement, FrictionElement, Linear, MotorSide, PositionLoop, State,
};
use quell::model::{FurtherModes, Grid, Hold, KINDS, Kind, Timed, Trace, integrate};
use quell::recording::Role;
use quell::signal::{CubicSpline, End, ForcedResponse};
use quell_shapers::Mode;
use std::f64::consts::{PI, TAU};

const REST: State = [0.0; 4];

fn kind(name: &str) -> &'static Kind {
    Kind::from_name(name).unwrap_or_else(|| panic!("no kind {name}"))
}

/// A joint of 1 rad/s whose motor side is prescribed; forces are in units of positions.
fn joint(damping_ratio: f64) -> Linear {
    (kind("flexible_joint").linear)(&[1.0 / TAU, damping_ratio, 1.0, 0.0], Role::MotorPosition)
}

/// A grid over `duration` whose input is a function of time.
fn grid(duration: f64, step: f64, input: impl Fn(f64) -> f64) -> Grid {
    let n = (duration / step).round() as usize;
    let time: Vec<f64> = (0..=n).map(|k| k as f64 * duration / n as f64).collect();
    let values: Vec<f64> = time.iter().map(|&t| input(t)).collect();
    Grid::new(&time, &values, Hold::Spline, 1e9).expect("a grid")
}

fn run(chain: &mut Chain, grid: &Grid, state: State) -> Trace {
    integrate(chain, grid, state, &Timed::default())
}

fn coulomb(place: Place, kinetic: f64, breakaway: f64) -> FrictionElement {
    FrictionElement {
        place,
        law: Friction {
            kinetic: [kinetic; 2],
            breakaway: [breakaway; 2],
            // Too small to be seen: the breakaway force acts at rest only.
            stribeck_velocity: 1e-9,
            transition_velocity: 0.0,
            levels: None,
        },
        slides: 0.0,
    }
}

fn add(chain: &mut Chain, law: Law, place: Place) -> Timed {
    let mut timed = Timed::default();
    match law {
        Law::Force(law) => {
            timed.breaks = law.breaks();
            let memory = Memory::default();
            chain.forces.push(ForceElement { place, law, memory });
        }
        Law::Friction(law) => chain.frictions.push(FrictionElement {
            place,
            law,
            slides: 0.0,
        }),
        Law::Inertia(inertia) => {
            timed.breaks = inertia.breaks();
            chain.inertias.push(inertia);
        }
        Law::Kinematic(error) => chain.kinematics.push(error),
        Law::Impulse(impulse) => timed.impulses.push(impulse),
        Law::Drive(_) | Law::Sensor(_) | Law::Resonance(_) => {}
    }
    timed
}

fn last(trace: &Trace) -> [f64; 3] {
    trace.link[trace.link.len() - 1]
}

/// A smooth move over `[0, duration]` by `distance`: jerk-free at its ends.
fn smooth_move(t: f64, duration: f64, distance: f64) -> f64 {
    let s = (t / duration).clamp(0.0, 1.0);
    distance * s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)))
}

/// A slow move and the rest after it on steps of 0.15 s, its values, and their spline.
fn slow_move() -> (Grid, Vec<f64>, CubicSpline) {
    let input = grid(60.0, 0.15, |t| smooth_move(t, 7.0, 1.0));
    let moved = |&t: &f64| smooth_move(t, 7.0, 1.0);
    let values: Vec<f64> = input.time.iter().map(moved).collect();
    let spline = CubicSpline::new(&input.time, &values, End::NotAKnot).expect("a spline");
    (input, values, spline)
}

#[test]
fn val_free_decay_and_forced_response_are_met_to_the_fourth_order() {
    let mode = Mode::new(1.0, 0.05).expect("a mode");
    let mut errors = Vec::new();
    // The input is one and the same spline of 0.15 s for all steps, which RK4 crosses no knot of.
    let (input, values, spline) = slow_move();
    let exact = ForcedResponse::new(&spline, mode, false, (0.01, 0.0));
    for parts in [1.0, 2.0, 4.0, 8.0, 16.0] {
        let step = 0.15 / parts * (1.0 + 1e-9);
        let grid = Grid::new(&input.time, &values, Hold::Spline, step).expect("a grid");
        let mut state = REST;
        (state[2], state[3]) = (0.01 + spline.value(0.0), spline.derivative(0.0));
        let trace = run(&mut Chain::new(joint(0.05)), &grid, state);
        let error = |k: usize| {
            let (deformation, rate) = exact.at(trace.time[k]);
            let [u, v, _] = trace.motor[k];
            let off = trace.link[k][0] - u - deformation;
            off.abs().max((trace.link[k][1] - v - rate).abs())
        };
        let worst = (0..trace.time.len()).map(error).fold(0.0, f64::max);
        let size = trace
            .link
            .iter()
            .zip(&trace.motor)
            .map(|(y, u)| (y[0] - u[0]).abs());
        errors.push(worst / size.fold(0.0, f64::max));
    }
    // The classical method errs by (w h)^4 / 120 of the amplitude a radian, and forgets after 1 / xi
    // radians: 0.15^4 / 120 / 0.05 = 8e-5 at most.
    assert!(errors[0] < 8e-5, "{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 14.0, "fourth order: {errors:?}");
    }
    assert!(errors[4] < 1e-9, "{errors:?}");
}

/// A further mode of up to 12 radians a step of the motion, whose nodes are the knots of the motor side's spline.
#[test]
fn val_a_further_mode_is_exact_between_the_steps_of_the_motion() {
    let (input, _, spline) = slow_move();
    let trace = run(&mut Chain::new(joint(0.05)), &input, REST);
    for (natural_frequency, damping_ratio) in [(0.3, 0.02), (3.0, 0.0), (20.0, 0.04), (80.0, 0.4)] {
        let mode = Mode::new(natural_frequency, damping_ratio).expect("a mode");
        let exact = ForcedResponse::new(&spline, mode, false, (0.01, 0.0));
        let law = Resonance {
            natural_frequency,
            damping_ratio,
            share: 1.0,
            damping_coupling: 0.0,
        };
        let modes = FurtherModes {
            laws: vec![law],
            ..FurtherModes::default()
        };
        let still = vec![[0.0; 2]; trace.time.len()];
        let mut start = [[0.01 + spline.value(0.0), spline.derivative(0.0)]];
        let seen = modes.seen(&trace, 0..=still.len() - 1, (&still, 0), &mut start);
        for (&time, [x, v]) in seen.time.iter().zip(&seen.curve) {
            let (deformation, rate) = exact.at(time.min(60.0));
            let off = x - spline.value(time) - deformation;
            let off_rate = v - spline.derivative(time) - rate;
            assert!(off.abs() < 1e-7, "{natural_frequency} at {time}: {off:e}");
            let size = 1e-7 * natural_frequency.max(1.0);
            assert!(
                off_rate.abs() < size,
                "{natural_frequency} at {time}: {off_rate:e}"
            );
        }
    }
}

#[test]
fn val_coulomb_friction_takes_4_f_a_period_and_stops_off_centre() {
    for place in [Place::Transmission, Place::Link] {
        let mut chain = Chain::new(joint(0.0));
        chain.frictions.push(coulomb(place, 0.03, 0.03));
        let grid = grid(80.0, 0.05, |_| 0.0);
        let mut state = REST;
        state[2] = 1.0;
        let trace = run(&mut chain, &grid, state);
        // Between turning points x = s F + (A - s F) cos: half a period takes 2 F.
        let exact = |t: f64| {
            let half = (t / PI).floor().min(17.0);
            let amplitude = 1.0 - 0.06 * half;
            let sign = if half as i32 % 2 == 0 { 1.0 } else { -1.0 };
            match half < 17.0 {
                true => sign * (0.03 + (amplitude - 0.03) * (t - half * PI).cos()),
                // 1 - 17 * 0.06 = -0.02: what holds it there is below F.
                false => sign * amplitude,
            }
        };
        for k in 0..trace.time.len() {
            let error = (trace.link[k][0] - exact(trace.time[k])).abs();
            // 0.05^4 / 120 a radian over 53 radians of motion, and 17 events.
            assert!(error < 3e-6, "{place:?} at {}: {error:e}", trace.time[k]);
        }
        assert_eq!(last(&trace)[1], 0.0);
        assert_eq!(last(&trace)[2], 0.0);
    }
}

#[test]
fn val_stick_slip_has_its_period() {
    // A mass on ground with F_s, F_k, pulled by a spring at speed V: it slips for (2 pi - 2 atan((F_s -
    // F_k) w / (k V))) / w and sticks for 2 (F_s - F_k) / (k V).
    let (breakaway, kinetic, speed) = (0.2, 0.1, 0.03_f64);
    let slip = TAU - 2.0 * ((breakaway - kinetic) / speed).atan();
    let stick = 2.0 * (breakaway - kinetic) / speed;
    for step in [0.15, 0.04] {
        let mut chain = Chain::new(joint(0.0));
        chain
            .frictions
            .push(coulomb(Place::Link, kinetic, breakaway));
        let trace = run(&mut chain, &grid(150.0, step, |t| speed * t), REST);
        let mut starts = Vec::new();
        for k in 1..trace.time.len() {
            if trace.link[k][1] > 0.0 && trace.link[k - 1][1] == 0.0 {
                starts.push(trace.time[k]);
            }
            assert!(trace.link[k][1] >= 0.0, "it never slips back");
        }
        assert!(starts.len() > 8, "{starts:?}");
        let periods = (starts.len() - 1) as f64;
        let period = (starts[starts.len() - 1] - starts[0]) / periods;
        // Starts are seen at nodes only.
        let error = (period - slip - stick).abs();
        assert!(error < step / periods + 1e-4, "{period} {}", slip + stick);
    }
}

#[test]
fn val_backlash_without_damping_keeps_its_energy() {
    let backlash = Effect::from_name("backlash").expect("it is in the catalogue");
    let gap = 0.4;
    for step in [0.1, 0.05] {
        let mut chain = Chain::new(joint(0.0));
        add(&mut chain, (backlash.law)(&[gap, 0.0]), Place::Transmission);
        let mut state = REST;
        state[2] = 1.0;
        let trace = run(&mut chain, &grid(200.0, step, |_| 0.0), state);
        let energy = |[x, v, _]: [f64; 3]| {
            let compressed = (x.abs() - gap / 2.0).max(0.0);
            0.5 * (v * v + compressed * compressed)
        };
        let (first, last) = (energy(trace.link[0]), energy(last(&trace)));
        // RK4 loses (w h)^5 / 72 of the energy a radian.
        assert!(
            (last / first - 1.0).abs() < 200.0 * step.powi(5),
            "{first} {last}"
        );
        // Half a swing of the spring and a flight on each side: 2 (pi + gap / (A - gap / 2)).
        let crossings = trace
            .link
            .windows(2)
            .filter(|w| w[0][0] > 0.0 && w[1][0] <= 0.0);
        let period = TAU + 2.0 * gap / (1.0 - gap / 2.0);
        assert_eq!(crossings.count(), (200.0 / period + 0.75) as usize);
    }
}

#[test]
fn val_a_payload_set_down_and_a_kick_act_at_their_instants() {
    // Neither instant is a node of the grid, and the second lies in the same step as the first.
    let (drop, kick) = (10.037, 10.043);
    let payload = Effect::from_name("payload_change").expect("it is in the catalogue");
    let mut chain = Chain::new(joint(0.0));
    let mut timed = add(&mut chain, (payload.law)(&[3.0, drop]), Place::Link);
    timed.impulses.push(Impulse {
        duration: 0.0,
        time: kick,
        size: 0.5,
    });
    let mut state = REST;
    state[2] = 1.0;
    let trace = integrate(&mut chain, &grid(20.0, 0.01, |_| 0.0), state, &timed);
    // Four times the inertia, half the frequency.
    let swing = |w: f64, [x, v]: [f64; 2], t: f64| {
        let (sin, cos) = (w * t).sin_cos();
        [x * cos + v / w * sin, v * cos - w * x * sin]
    };
    let at_drop = swing(1.0, [1.0, 0.0], drop);
    let [x, v] = swing(0.5, at_drop, kick - drop);
    for k in 0..trace.time.len() {
        let t = trace.time[k];
        let exact = match t {
            _ if t < drop => swing(1.0, [1.0, 0.0], t),
            _ if t < kick => swing(0.5, at_drop, t - drop),
            _ => swing(0.5, [x, v + 0.5 / 4.0], t - kick),
        };
        // 0.01^4 / 120 a radian.
        assert!((trace.link[k][0] - exact[0]).abs() < 3e-9, "at {t}");
        assert!((trace.link[k][1] - exact[1]).abs() < 3e-9, "at {t}");
    }
}

/// A parabola of force leaves a mode with the pole `-s` ringing as a jump in its middle does, times its integral with
/// `exp(s t)`, `3 (x cosh x - sinh x) / x^3` with `x = s d / 2`. Also where it is shorter than a step, or than a sample.
#[test]
fn val_a_parabola_of_force_leaves_the_ringing_of_its_transform() {
    let (damping_ratio, time, size) = (0.1_f64, 3.1234, 0.5);
    let turns = (1.0 - damping_ratio * damping_ratio).sqrt();
    for duration in [2.0, 0.3, 0.004, 1e-7] {
        let impulse = Law::Impulse(Impulse {
            time,
            size,
            duration,
        });
        let mut chain = Chain::new(joint(damping_ratio));
        let timed = add(&mut chain, impulse, Place::Link);
        let trace = integrate(&mut chain, &grid(20.0, 0.01, |_| 0.0), REST, &timed);
        let x = Complex::new(damping_ratio, turns) * (0.5 * duration);
        let factor = match duration < 0.01 {
            true => x * x / 10.0 + 1.0,
            false => (x * x.cosh() - x.sinh()) * 3.0 / (x * x * x),
        };
        let rung = trace.time.iter().zip(&trace.link);
        let rung = rung.filter(|own| *own.0 > time + 0.5 * duration);
        assert!(rung.clone().count() > 1000);
        for (t, link) in rung {
            let pole = Complex::new(-damping_ratio, turns) * (t - time);
            let exact = size / turns * (pole.exp() * factor.conj()).im;
            // A step over the whole of it errs by the damper: `12 size / d^3 * 2 xi * d^5 / 120`.
            let error = (link[0] - exact).abs();
            assert!(error < 2e-7, "{duration} s, at {t}: {error}");
        }
    }
}

#[test]
fn val_two_masses_keep_momentum_and_energy() {
    let linear = (kind("two_mass").linear)(&[0.06, 0.17, 0.0, 40.0, 9.0, 0.0, 0.0], Role::Torque);
    let mut state = REST;
    (state[1], state[2]) = (0.4, 0.1);
    let trace = run(&mut Chain::new(linear), &grid(5.0, 0.002, |_| 0.0), state);
    let w = (40.0 * (1.0 / 0.06 + 1.0 / 0.17_f64)).sqrt();
    let relative = [0.1, -0.4];
    for k in 0..trace.time.len() {
        let (m, l, t) = (trace.motor[k], trace.link[k], trace.time[k]);
        let momentum = 0.06 * m[1] + 0.17 * l[1];
        assert!((momentum - 0.06 * 0.4).abs() < 1e-14);
        let d = relative[0] * (w * t).cos() + relative[1] / w * (w * t).sin();
        // (w h)^4 / 120 a radian over 150 radians.
        assert!((l[0] - m[0] - d).abs() < 0.11 * 150.0 * (w * 0.002).powi(4) / 120.0);
    }
}

#[test]
fn val_two_frictions_share_a_load() {
    // No spring: the link is dragged along by the friction across alone.
    let linear = Linear {
        motor: MotorSide::Free {
            inertia: 1.0,
            viscous: 0.0,
        },
        link: Some((2.0, 0.0)),
        motor_gain: 1.0,
        ..Linear::NONE
    };
    let (drive, across) = (1.0, 0.5);
    // (torque, accelerations): nothing moves; both move as one; the motor side leaves the link behind.
    for (torque, motor, link) in [
        (0.99, 0.0, 0.0),
        // (1.6 - 1) / 3 asks for 0.4 across.
        (1.6, 0.2, 0.2),
        (2.5, 1.0, 0.25),
        // The other way round.
        (-2.5, -1.0, -0.25),
    ] {
        let mut chain = Chain::new(linear);
        chain.frictions.push(coulomb(Place::Drive, drive, drive));
        chain
            .frictions
            .push(coulomb(Place::Transmission, across, across));
        // Half of it again at the same place: they add up.
        for element in &mut chain.frictions {
            element.law.kinetic = element.law.kinetic.map(|f| f / 2.0);
            element.law.breakaway = element.law.kinetic;
        }
        chain
            .frictions
            .push(coulomb(Place::Drive, drive / 2.0, drive / 2.0));
        chain
            .frictions
            .push(coulomb(Place::Transmission, across / 2.0, across / 2.0));
        let trace = run(&mut chain, &grid(2.0, 0.05, |_| torque), REST);
        let end = trace.time.len() - 1;
        assert!(
            (trace.motor[end][1] - 2.0 * motor).abs() < 1e-12,
            "{torque}"
        );
        assert!((trace.link[end][1] - 2.0 * link).abs() < 1e-12, "{torque}");
        assert!((trace.link[end][0] - 2.0 * link).abs() < 1e-12, "{torque}");
    }
}

#[test]
fn val_a_sliding_mass_stops_where_its_energy_ends() {
    let linear =
        (kind("rigid_axis").linear)(&[2.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0], Role::Force);
    for (force, moves) in [(0.0, false), (0.9, false), (1.1, true)] {
        let mut chain = Chain::new(linear);
        chain.frictions.push(coulomb(Place::Drive, 1.0, 1.0));
        let mut state = REST;
        state[1] = -0.7;
        let trace = run(&mut chain, &grid(30.0, 0.1, |_| force), state);
        // Sliding backwards, friction and force both brake: it stops after m v / (F + f), and stays
        // unless the force exceeds the friction.
        let brake: f64 = 1.0 + force;
        let stop = 2.0 * 0.7 / brake;
        let place = -0.5 * 2.0 * 0.7 * 0.7 / brake;
        let [x, v, _] = trace.motor[trace.motor.len() - 1];
        let rest = 30.0 - stop;
        let away = if moves { (force - 1.0) / 2.0 } else { 0.0 };
        assert!((v - away * rest).abs() < 1e-9, "{force}: {v}");
        assert!(
            (x - place - 0.5 * away * rest * rest).abs() < 1e-8,
            "{force}: {x}"
        );
    }
}

#[test]
fn val_a_sampled_loop_is_the_recursion_of_its_controller() {
    let (mass, period) = (95.0, 0.001);
    let keys = [mass, 0.0, 35.0, 160.0, 243.0, 10.0, period, 0.0];
    let linear = (kind("rigid_axis").linear)(&keys, Role::CommandPosition);
    let time: Vec<f64> = (0..=2000).map(|k| f64::from(k) * period).collect();
    let reference: Vec<f64> = time.iter().map(|&t| smooth_move(t, 1.0, 0.2)).collect();
    // The grid is finer than the controller: ticks are what they are.
    let grid = Grid::new(&time, &reference, Hold::ZeroOrder, period / 3.0).expect("a grid");
    let trace = run(&mut Chain::new(linear), &grid, REST);
    let (mut x, mut v, mut before) = (0.0, 0.0, 0.0);
    for k in 0..time.len() {
        let node = trace
            .time
            .iter()
            .position(|&t| t == time[k])
            .expect("a node");
        assert!((trace.motor[node][0] - x).abs() < 1e-12, "at {}", time[k]);
        let rate = (x - before) / period;
        let volts: f64 = 243.0 * (160.0 * (reference[k] - x) - rate);
        let force = 35.0 * volts.clamp(-10.0, 10.0);
        assert!((trace.force[node] - force).abs() < 1e-6 || k + 1 == time.len());
        before = x;
        x += v * period + 0.5 * force / mass * period * period;
        v += force / mass * period;
    }
    let (PositionLoop { .. }, moved) = (linear.position_loop.expect("a loop"), x);
    assert!((moved - 0.2).abs() < 1e-3, "{moved}");
}

#[test]
fn val_a_driven_spring_says_its_force() {
    let spring = KINDS
        .iter()
        .find(|kind| kind.inputs[0] == Role::LinkPosition)
        .expect("a kind");
    let linear = (spring.linear)(&[3.0, 0.2], Role::LinkPosition);
    let (time, w) = (20.0, 1.3);
    let motion = grid(time, 0.01, |t| 0.5 * (w * t).sin());
    let plain = run(&mut Chain::new(linear), &motion, REST);
    let mut chain = Chain::new(linear);
    chain.frictions.push(coulomb(Place::Transmission, 0.7, 0.7));
    let rough = run(&mut chain, &motion, REST);
    let dahl = Effect::from_name("presliding_hysteresis").expect("it is in the catalogue");
    let mut chain = Chain::new(linear);
    add(
        &mut chain,
        (dahl.law)(&[0.7, 0.05, 0.0, 0.0, 0.0]),
        Place::Transmission,
    );
    let bristles = run(&mut chain, &motion, REST);
    let (mut z, mut x) = (0.0, 0.0_f64);
    for k in 0..plain.time.len() {
        let t = plain.time[k];
        let (sin, cos) = (w * t).sin_cos();
        // A spline errs by 5/384 h^4 of the fourth derivative, its slope by h^3 / 24.
        let force = 3.0 * 0.5 * sin + 0.2 * 0.5 * w * cos;
        assert!((plain.force[k] - force).abs() < 1e-6, "at {t}");
        if cos.abs() > 0.02 && t > 0.0 {
            let friction = rough.force[k] - plain.force[k];
            assert!((friction - 0.7 * cos.signum()).abs() < 1e-9, "at {t}");
        }
        // Dahl's bristles, a turning point at a time.
        let mut step = |to: f64| {
            let sense = (to - x).signum();
            z = sense + (z - sense) * (-(to - x).abs() / 0.05).exp();
            x = to;
        };
        if k > 0 && (plain.link[k - 1][1] > 0.0) != (plain.link[k][1] > 0.0) {
            step(0.5 * plain.link[k][0].signum());
        }
        step(0.5 * sin);
        let friction = bristles.force[k] - plain.force[k];
        assert!(
            (friction - 0.7 * z).abs() < 1e-5,
            "at {t}: {friction} {}",
            0.7 * z
        );
    }
}

fn scales() -> Scales {
    Scales {
        deformation: 0.05,
        deformation_rate: 0.05,
        position: (0.0, 1.0),
        velocity: 0.3,
        acceleration: 0.1,
        force: 0.05,
        input: 1.0,
        natural_frequency: 1.0,
        damping_ratio: 0.05,
        span: (0.0, 30.0),
        sample_time: 0.05,
        candidate_events: vec![11.03],
        candidate_frequencies: vec![2.5],
        candidate_orders: vec![30.0],
        candidate_stops: vec![CandidateStop::at(0.5, 1.0)],
        ..Scales::default()
    }
}

fn simulated(law: Law, place: Place, step: f64) -> Trace {
    let mut chain = Chain::new(joint(0.05));
    let timed = add(&mut chain, law, place);
    // The input has the same knots for every step.
    let time: Vec<f64> = (0..=150).map(|k| f64::from(k) * 0.2).collect();
    let there_and_back = |t: &f64| smooth_move(*t, 6.0, 1.0) - smooth_move(t - 12.0, 5.0, 0.6);
    let values: Vec<f64> = time.iter().map(there_and_back).collect();
    let grid = Grid::new(&time, &values, Hold::Spline, step * (1.0 + 1e-9)).expect("a grid");
    integrate(&mut chain, &grid, REST, &timed)
}

/// The link at the knots of the input; between them every step has nodes of its own.
fn at_knots(trace: &Trace) -> Vec<f64> {
    let node = |k: u32| {
        trace
            .time
            .partition_point(|t| *t < f64::from(k) * 0.2 + 1e-9)
            - 1
    };
    (0..=150).map(|k| trace.link[node(k)][0]).collect()
}

#[test]
fn every_law_converges_as_steps_are_halved() {
    for effect in EFFECTS {
        for &place in effect.places {
            let parameters: Vec<f64> = effect
                .parameters
                .iter()
                .map(|p| (p.typical)(&scales()))
                .collect();
            if matches!((effect.law)(&parameters), Law::Drive(_) | Law::Sensor(_))
                || place == Place::Drive
            {
                continue;
            }
            let run = |parts: f64| simulated((effect.law)(&parameters), place, 0.2 / parts);
            let reference = at_knots(&run(64.0));
            let error = |parts: usize| {
                let trace = at_knots(&run(parts as f64));
                let off = trace.iter().zip(&reference).map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max) / 0.05
            };
            // 0.2 to 0.0125 rad a step, in deformations.
            let errors = [1, 2, 4, 8, 16].map(error);
            let told = errors.map(|error| format!("{error:.1e}")).join(" ");
            println!("{:28} {:14} {told}", effect.name, place.name());
            // Creep takes the deformation for a straight line within a step, a swinging load the link's speed:
            // second order. The others are of the fourth, down to the hair by which events are overshot. About rest smooth friction is
            // followed in steps of its own, however short the others are.
            let (factor, size) = match effect.name {
                "viscoelastic_creep" | "swinging_load" => (3.5, 5e-3),
                "smooth_coulomb_friction" => (1.0, 2e-4),
                _ => (8.0, 1e-3),
            };
            assert!(errors[1] < size, "{}: {told}", effect.name);
            assert!(
                errors[1] / errors[3] > factor * factor,
                "{}: {told}",
                effect.name
            );
        }
    }
}

#[test]
fn neutral_laws_are_the_baseline_to_the_bit() {
    let baseline = simulated(
        Law::Impulse(Impulse {
            time: -1.0,
            size: 0.0,
            duration: 0.0,
        }),
        Place::Link,
        0.15,
    );
    for effect in EFFECTS {
        let mut parameters: Vec<f64> = effect
            .parameters
            .iter()
            .map(|p| (p.typical)(&scales()))
            .collect();
        parameters[effect.size()] = effect.parameters[effect.size()].neutral;
        for &place in effect.places {
            let law = (effect.law)(&parameters);
            if matches!(law, Law::Friction(_) | Law::Impulse(_)) {
                // Steps that end at its events are rounded elsewhere; a kick of 0 ends one too.
                continue;
            }
            let trace = simulated(law, place, 0.15);
            assert!(trace.link == baseline.link, "{}", effect.name);
        }
    }
}
