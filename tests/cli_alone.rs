//! `quell identify` on what vibrates alone: decays, taps, sweeps, work, and a printer's files.

use assert_cmd::Command;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use tempfile::TempDir;

const RATE: f64 = 1000.0;

fn noise(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

fn generator(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Samples of `x'' + 2 xi w x' + w^2 (x - soft x^3) + friction sign x' = force`, by Runge and Kutta's method: acceleration.
fn oscillate(
    hertz: f64,
    xi: f64,
    [soft, friction]: [f64; 2],
    start: f64,
    force: impl Fn(usize) -> f64,
    samples: usize,
) -> Vec<f64> {
    let (w, dt) = (TAU * hertz, 1.0 / RATE / 8.0);
    let (mut x, mut v) = (start, 0.0);
    let mut all = Vec::new();
    for k in 0..samples {
        let push = force(k);
        let a = |x: f64, v: f64| {
            push - w * w * (x - soft * x.powi(3)) - 2.0 * xi * w * v - friction * (v / 1e-3).tanh()
        };
        for _ in 0..8 {
            let (k1, l1) = (v, a(x, v));
            let (k2, l2) = (v + 0.5 * dt * l1, a(x + 0.5 * dt * k1, v + 0.5 * dt * l1));
            let (k3, l3) = (v + 0.5 * dt * l2, a(x + 0.5 * dt * k2, v + 0.5 * dt * l2));
            let (k4, l4) = (v + dt * l3, a(x + dt * k3, v + dt * l3));
            x += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            v += dt / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
        }
        all.push(a(x, v));
    }
    all
}

fn still(_: usize) -> f64 {
    0.0
}

/// Columns under a header, at [`RATE`].
fn in_time(header: &str, columns: &[Vec<f64>]) -> String {
    let mut text = format!("time_s,{header}\n");
    for k in 0..columns[0].len() {
        let cells: Vec<String> = columns
            .iter()
            .map(|column| format!("{:.7e}", column[k]))
            .collect();
        writeln!(text, "{:.6},{}", k as f64 / RATE, cells.join(",")).unwrap();
    }
    text
}

/// Identifies columns under a header, and gives the first recording of the answer.
fn identify(header: &str, columns: &[Vec<f64>]) -> Value {
    answer("run.csv", &in_time(header, columns))["recordings"][0].clone()
}

fn answer(name: &str, text: &str) -> Value {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    let mut command = Command::cargo_bin("quell").unwrap();
    let run = command
        .current_dir(folder.path())
        .args(["identify", name, "--json"])
        .assert()
        .success();
    serde_json::from_slice(&run.get_output().stdout).unwrap()
}

/// Holds the modes against the truth: each within four of its standard deviations, and no other.
fn holds(found: &Value, truth: &[(f64, f64)]) {
    let modes = found["modes"].as_array().unwrap();
    assert_eq!(modes.len(), truth.len(), "{modes:?}");
    for (hertz, xi) in truth {
        let number = |mode: &Value, key: &str| mode[key].as_f64().unwrap();
        let off = |mode: &&Value| (number(mode, "frequency_hz") - hertz).abs();
        let mode = modes
            .iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap();
        assert!(
            off(&mode) < 4.0 * number(mode, "frequency_std_hz"),
            "{hertz} Hz: {mode}"
        );
        let damping = (number(mode, "damping_ratio") - xi).abs();
        assert!(damping < 4.0 * number(mode, "damping_std"), "{xi}: {mode}");
    }
}

fn sum(one: &[f64], other: &[f64], rng: &mut ChaCha8Rng, level: f64) -> Vec<f64> {
    one.iter()
        .zip(other)
        .map(|(a, b)| a + b + level * noise(rng))
        .collect()
}

#[test]
fn two_modes_of_a_decay_are_told_with_their_deviations() {
    let mut rng = generator(1);
    let one = oscillate(8.2, 0.01, [0.0; 2], 1.0, still, 5000);
    let other = oscillate(21.0, 0.015, [0.0; 2], 0.05, still, 5000);
    let found = identify("accel_m_s2", &[sum(&one, &other, &mut rng, 10.0)]);
    assert_eq!(found["excitation"], "decay");
    holds(&found, &[(8.2, 0.01), (21.0, 0.015)]);
    assert!(
        !found["recommended"]["impulses"]
            .as_array()
            .unwrap()
            .is_empty()
    );
}

/// A free decay: Hz, damping ratio, amplitude, phase.
fn ring([hertz, xi, amplitude, phase]: [f64; 4], samples: usize) -> Vec<f64> {
    let omega = TAU * hertz;
    let at = |t: f64| (-xi * omega * t).exp() * (omega * (1.0 - xi * xi).sqrt() * t + phase).cos();
    (0..samples)
        .map(|k| amplitude * at(k as f64 / RATE))
        .collect()
}

#[test]
fn modes_at_multiples_of_a_mode_are_told() {
    let mut rng = generator(8);
    // Frequencies 1:5 with another rate, 1:2:3 and 1:4:9 of one damping ratio, as of a string or a beam.
    let sets: [&[[f64; 4]]; 4] = [
        &[[6.2, 0.01, 0.5, 0.3], [31.0, 0.008, 0.35, 1.1]],
        &[[6.2, 0.01, 0.5, 0.3], [31.0, 0.008, 0.02, 1.1]],
        &[
            [6.2, 0.01, 0.5, 0.3],
            [12.4, 0.01, 0.3, 0.9],
            [18.6, 0.01, 0.2, 0.2],
        ],
        &[
            [6.2, 0.01, 0.5, 0.0],
            [24.8, 0.01, 0.3, 0.0],
            [55.8, 0.01, 0.1, 0.0],
        ],
    ];
    for modes in sets {
        let mut all: Vec<f64> = (0..6000).map(|_| 0.003 * noise(&mut rng)).collect();
        for mode in modes {
            let own = ring(*mode, 6000);
            all.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        let truth: Vec<_> = modes.iter().map(|mode| (mode[0], mode[1])).collect();
        holds(&identify("accel_g", &[all]), &truth);
    }
}

#[test]
fn a_nonlinear_sensors_multiple_is_left_out_and_named() {
    let mut rng = generator(9);
    for (power, share) in [(2, 0.1), (3, 0.1)] {
        let decay = ring([6.2, 0.01, 1.0, 0.7], 6000);
        let seen = |x: &f64| x + share * x.powi(power) + 0.001 * noise(&mut rng);
        let found = identify("accel_g", &[decay.iter().map(seen).collect()]);
        let modes = found["modes"].as_array().unwrap();
        assert_eq!(modes.len(), 1, "{modes:?}");
        let left = &found["left_out"][0];
        assert_eq!(
            (&left["reason"], left["order"].as_i64()),
            (&"distortion".into(), Some(power.into())),
            "{found}"
        );
        assert!(
            found["remarks"].to_string().contains("Left out: "),
            "{found}"
        );
    }
}

#[test]
fn a_mode_that_depends_on_its_amplitude_is_one() {
    let mut rng = generator(2);
    for law in [[0.03, 0.0], [0.0, 3.0]] {
        let decay = oscillate(6.0, 0.008, law, 1.0, still, 6000);
        let found = identify(
            "accel_m_s2",
            &[sum(&decay, &vec![0.0; 6000], &mut rng, 4.0)],
        );
        let modes = found["modes"].as_array().unwrap();
        assert_eq!(modes.len(), 1, "{law:?}: {modes:?}");
        assert!(
            (modes[0]["frequency_hz"].as_f64().unwrap() - 6.0).abs() < 0.01,
            "{law:?}: {modes:?}"
        );
        if law[0] > 0.0 {
            let shift = modes[0]["frequency_shift"].as_f64().unwrap();
            // Duffing's backbone at the amplitude 1: - 3/8 of the softening.
            assert!((shift + 0.375 * 0.03).abs() < 0.1 * 0.375 * 0.03, "{shift}");
            let remarks = found["remarks"].to_string();
            assert!(remarks.contains("depends on the amplitude"), "{remarks}");
        }
    }
}

#[test]
fn taps_on_three_axes_and_work_give_the_modes_too() {
    let mut rng = generator(3);
    let tapped = |k: usize| if k % 1500 == 400 { 2000.0 } else { 0.0 };
    let one = oscillate(14.0, 0.03, [0.0; 2], 0.0, tapped, 6000);
    // The force itself is not what the sensor is to decay by.
    let clean: Vec<f64> = one.iter().enumerate().map(|(k, a)| a - tapped(k)).collect();
    let axes = [1.0, 0.3, 0.1].map(|share| {
        clean
            .iter()
            .map(|a| share * a + 0.2 * noise(&mut rng))
            .collect()
    });
    let found = identify("ax_m_s2,ay_m_s2,az_m_s2", &axes);
    assert_eq!(found["excitation"], "decay");
    holds(&found, &[(14.0, 0.03)]);

    let forces: Vec<f64> = (0..90_000).map(|_| 10.0 * noise(&mut rng)).collect();
    let one = oscillate(11.3, 0.02, [0.0; 2], 0.0, |k| forces[k], 90_000);
    let line: Vec<f64> = (0..90_000)
        .map(|k| 20.0 * (TAU * 49.7 * k as f64 / RATE).sin())
        .collect();
    let found = identify("accel_m_s2", &[sum(&one, &line, &mut rng, 0.1)]);
    assert_eq!(found["excitation"], "work");
    holds(&found, &[(11.3, 0.02)]);
}

/// Acceleration of modes (Hz, damping ratio, share) that a linear sweep from 4 to 110 Hz excites for 58.5 s: a force
/// on the masses, or a base that moves. By Runge and Kutta's method.
fn driven(modes: &[[f64; 3]], is_force: bool, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let (end, dt) = (58.5, 1.0 / RATE / 8.0);
    let drive = |t: f64| {
        let edge = (t / 0.2).min((end - t) / 0.2).clamp(0.0, 1.0);
        5.0 * edge * (TAU * (4.0 * t + 106.0 / end * t * t / 2.0)).sin()
    };
    let mut all: Vec<f64> = (0..60_000).map(|_| 0.02 * noise(rng)).collect();
    for [hertz, xi, share] in modes {
        let w = TAU * hertz;
        let (mut x, mut v) = (0.0, 0.0);
        for (k, sum) in all.iter_mut().enumerate() {
            let held = -w * w * x - 2.0 * xi * w * v;
            let push = drive(k as f64 / RATE);
            *sum += share * (held + if is_force { push } else { 0.0 });
            for part in 0..8 {
                let t = k as f64 / RATE + f64::from(part) * dt;
                let a = |t: f64, x: f64, v: f64| drive(t) - w * w * x - 2.0 * xi * w * v;
                let (k1, l1) = (v, a(t, x, v));
                let middle = |k: f64, l: f64| {
                    (
                        v + 0.5 * dt * l,
                        a(t + 0.5 * dt, x + 0.5 * dt * k, v + 0.5 * dt * l),
                    )
                };
                let (k2, l2) = middle(k1, l1);
                let (k3, l3) = middle(k2, l2);
                let (k4, l4) = (v + dt * l3, a(t + dt, x + dt * k3, v + dt * l3));
                x += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
                v += dt / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
            }
        }
    }
    all
}

/// Modes of either sign, near and far, heavily and lightly damped: none takes the part of another one.
#[test]
fn a_sweep_tells_all_modes_by_a_force_and_by_a_base() {
    let mut rng = generator(7);
    for (is_force, modes) in [
        (true, &[[33.3, 0.03, 1.0], [71.0, 0.02, 0.5]][..]),
        (true, &[[9.4, 0.06, 1.0]]),
        (
            true,
            &[[12.6, 0.029, 0.5], [15.5, 0.0098, 0.5], [70.0, 0.013, -0.8]],
        ),
        (
            false,
            &[
                [19.13, 0.0315, 0.73],
                [58.64, 0.0118, 0.34],
                [81.15, 0.0422, 0.97],
            ],
        ),
    ] {
        let found = identify("accel_m_s2", &[driven(modes, is_force, &mut rng)]);
        assert!(
            found["excitation"].as_str().unwrap().contains("sweep"),
            "{found}"
        );
        let truth: Vec<(f64, f64)> = modes.iter().map(|mode| (mode[0], mode[1])).collect();
        holds(&found, &truth);
    }
}

#[test]
fn a_position_alone_and_a_motor_that_stands_give_a_decay() {
    let mut rng = generator(4);
    let omega = TAU * 4.3;
    let ring = |t: f64| (-0.02 * omega * t).exp() * (omega * (1.0_f64 - 0.0004).sqrt() * t).cos();
    let tip: Vec<f64> = (0..6000)
        .map(|k| {
            let t = k as f64 / RATE;
            let moved = 300.0 * (3.0 * t.min(1.0).powi(2) - 2.0 * t.min(1.0).powi(3));
            moved + if t > 1.0 { 6.0 * ring(t - 1.0) } else { 0.0 } + 0.02 * noise(&mut rng)
        })
        .collect();
    holds(&identify("tip_x_mm", &[tip]), &[(4.3, 0.02)]);
    let link: Vec<f64> = (0..4000)
        .map(|k| 0.5 + 0.01 * ring(k as f64 / RATE) + 1e-5 * noise(&mut rng))
        .collect();
    let found = identify(
        "motor_position_rad,link_position_rad",
        &[vec![0.5; 4000], link],
    );
    holds(&found, &[(4.3, 0.02)]);
}

/// What `quell identify` says of a file that it refuses.
/// A held arm shows its decay in the current of its servo, too. What somebody drove is no vibration.
#[test]
fn a_channel_of_the_drive_alone_tells_its_decay_and_nothing_else() {
    let mut rng = generator(12);
    let shows = |hertz: f64| ring([hertz, 0.04, 1.0, 0.3], 12_000);
    let noisy: Vec<f64> = shows(3.7)
        .iter()
        .map(|own| own + 0.004 * noise(&mut rng))
        .collect();
    for header in [
        "motor_current_A",
        "joint_torque_Nm",
        "motor_position_rad",
        "motor_velocity_rad_s",
        "force_N",
        "motor_voltage_V",
    ] {
        let found = identify(header, std::slice::from_ref(&noisy));
        holds(&found, &[(3.7, 0.04)]);
    }
    let moves = |k: usize| {
        let t = k as f64 / RATE;
        (0.4 * t).sin() + (0.9 * t).sin() + 1e-4 * noise(&mut rng)
    };
    let driven: Vec<f64> = (0..12_000).map(moves).collect();
    let told = refusal(&in_time("motor_position_rad", &[driven]));
    assert!(
        told.contains("motor_position alone tells a mode where it decays freely")
            || told.contains("no mode was found"),
        "{told}"
    );
}

fn refusal(text: &str) -> String {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    let mut command = Command::cargo_bin("quell").unwrap();
    let run = command
        .current_dir(folder.path())
        .args(["identify", "run.csv"])
        .assert()
        .code(2);
    String::from_utf8_lossy(&run.get_output().stderr).into_owned()
}

#[test]
fn noise_and_a_tone_tell_no_mode() {
    let mut rng = generator(5);
    for tone in [0.0, 1.0] {
        let mut text = String::from("time_s,accel_g\n");
        for k in 0..30_000 {
            let value = tone * (TAU * 49.7 * f64::from(k) / RATE).sin() + 0.1 * noise(&mut rng);
            writeln!(text, "{:.3},{value:.6}", f64::from(k) / RATE).unwrap();
        }
        let stderr = refusal(&text);
        assert!(stderr.contains("no mode was found"), "{stderr}");
    }
}

/// Both fall by a fifth to a third: the envelope of a light mode is an exponential, that of a line which drifts is not.
#[test]
fn a_decay_that_ends_early_is_told_and_a_line_that_drifts_is_not() {
    let mut rng = generator(11);
    let mut noisy = |clean: Vec<f64>| seen(&clean, 0.01, &mut rng);
    for (mode, samples) in [
        ([3.35, 0.0067, 1.0, 0.3], 3000),
        ([6.42, 0.0062, 1.0, 2.0], 1500),
    ] {
        let rings = noisy(ring(mode, samples));
        let quiet = noisy([vec![0.0; 400], ring(mode, samples)].concat());
        for column in [rings, quiet] {
            let found = identify("link_velocity_rad_s", &[column]);
            assert_eq!(found["excitation"], "decay");
            holds(&found, &[(mode[0], mode[1])]);
        }
        let line = ring([mode[0], 0.0, 1.0, mode[3]], samples);
        let falls = |k: usize| 1.0 - 0.25 * k as f64 / samples as f64;
        let drifts = line.iter().enumerate().map(|(k, v)| falls(k) * v).collect();
        let text = in_time("link_velocity_rad_s", &[noisy(drifts)]);
        assert!(refusal(&text).contains("no mode was found"), "{mode:?}");
    }
}

/// What a machine at work excites falls by chance now and then: none of these falls is a decay, whose mode would be wrong.
#[test]
fn a_mode_that_noise_drives_on_makes_no_decay() {
    let mut rng = generator(21);
    for (hertz, xi) in [
        (69.0, 0.02),
        (35.0, 0.006),
        (16.4, 0.005),
        (30.0, 0.012),
        (11.0, 0.01),
    ] {
        let forces: Vec<f64> = (0..20_000).map(|_| noise(&mut rng)).collect();
        let all = oscillate(hertz, xi, [0.0; 2], 0.0, |k| forces[k], 20_000);
        // The force itself is not what the sensor shows.
        let own: Vec<f64> = all
            .iter()
            .zip(&forces)
            .map(|(a, force)| a - force)
            .collect();
        let rms = (own.iter().map(|a| a * a).sum::<f64>() / 20_000.0).sqrt();
        let found = identify("accel_m_s2", &[seen(&own, 0.02 * rms, &mut rng)]);
        assert_eq!(found["excitation"], "work", "{hertz} Hz: {found}");
        holds(&found, &[(hertz, xi)]);
    }
}

/// A slow smooth move shows in the velocity of the link, and is no decay of it. The vibration after it is told where it stands out
/// of the noise.
#[test]
fn a_move_that_excites_nothing_makes_no_mode_of_itself() {
    let mut rng = generator(12);
    let (from, lasts) = (300.0, 1500.0);
    let velocity = |k: usize| {
        let s = ((k as f64 - from) / lasts).clamp(0.0, 1.0);
        30.0 * RATE / lasts * (s * (1.0 - s)).powi(2)
    };
    let motor: Vec<f64> = (0..3000).map(velocity).collect();
    let mut after = |amplitude: f64| {
        let rest = ring([26.4, 0.046, amplitude, 0.3], 1200);
        let rings = [vec![0.0; 1800], rest].concat();
        sum(&motor, &rings, &mut rng, 0.0125)
    };
    let header = "motor_velocity_rad_s,link_velocity_rad_s";
    let found = identify(header, &[motor.clone(), after(0.0625)]);
    assert_eq!(found["excitation"], "decay");
    holds(&found, &[(26.4, 0.046)]);
    for _ in 0..4 {
        let text = in_time(header, &[motor.clone(), after(0.0)]);
        assert!(refusal(&text).contains("no mode was found"));
    }
}

/// An accelerometer that shows one value is told so, and no motor side is asked for.
#[test]
fn an_accelerometer_that_shows_one_value_says_nothing() {
    let mut text = String::from("time_s,accel_g\n");
    for k in 0..1000 {
        writeln!(text, "{:.3},0.98", f64::from(k) / RATE).unwrap();
    }
    let stderr = refusal(&text);
    assert!(stderr.contains("nothing vibrates"), "{stderr}");
}

/// The mode in which the other direction of a printer rings a little: Hz, damping ratio, share.
const ACROSS: [f64; 3] = [64.0, 0.05, 0.1];

/// Klipper's raw data of a sweep of an axis with these modes (Hz, damping ratio, share), made in the frequency domain by
/// its steady state: the sweep is slow beside them.
fn swept(modes: &[[f64; 3]], rng: &mut ChaCha8Rng) -> String {
    let rate = 1600.0;
    let mut text = String::from("#time,accel_x,accel_y,accel_z\n");
    let all: Vec<[f64; 3]> = modes.iter().copied().chain([ACROSS]).collect();
    let mut states = vec![[0.0; 2]; all.len()];
    let mut phase = 0.0;
    for k in 0..(rate * 64.0) as usize {
        let frequency = 5.0 + 2.0 * k as f64 / rate;
        let mut forces = vec![0.0; all.len()];
        for _ in 0..8 {
            let dt = 1.0 / rate / 8.0;
            phase += TAU * frequency * dt;
            let a = 75.0 * frequency * phase.cos();
            let own = states.iter_mut().zip(&mut forces);
            for ((state, force), [hertz, xi, share]) in own.zip(&all) {
                let w = TAU * hertz;
                // Semi-implicit Euler is symplectic: it shifts no frequency at this step by more than 1e-4.
                let acceleration = -a - 2.0 * xi * w * state[1] - w * w * state[0];
                state[1] += dt * acceleration;
                state[0] += dt * state[1];
                *force = share * (-2.0 * xi * w * state[1] - w * w * state[0]);
            }
        }
        let (along, across) = (forces[..modes.len()].iter().sum(), forces[modes.len()]);
        let [x, y, z] = [along, across, 9806.0]
            .map(|value| ((value + 60.0 * noise(rng)) / 38.3).round() * 38.3);
        writeln!(text, "{:.6},{x:.6},{y:.6},{z:.6}", 1234.5 + k as f64 / rate).unwrap();
    }
    text
}

#[test]
fn a_printers_raw_data_gives_the_lines_to_paste() {
    let mut rng = generator(6);
    let folder = TempDir::new().unwrap();
    let x = swept(&[[42.3, 0.055, 1.0]], &mut rng);
    let y = swept(&[[38.0, 0.04, 0.7], [71.0, 0.06, 0.3]], &mut rng);
    for (name, text) in [("raw_data_x_1.csv", x), ("raw_data_y_1.csv", y)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let run = |json: bool| {
        let mut command = Command::cargo_bin("quell").unwrap();
        command.current_dir(folder.path()).args([
            "identify",
            "raw_data_x_1.csv",
            "raw_data_y_1.csv",
        ]);
        let run = command.args(json.then_some("--json")).assert().success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let found: Value = serde_json::from_str(&run(true)).unwrap();
    for (recording, truth) in [
        (0, vec![(42.3, 0.055)]),
        (1, vec![(38.0, 0.04), (71.0, 0.06)]),
    ] {
        let modes = found["recordings"][recording]["modes"].as_array().unwrap();
        assert_eq!(modes.len(), truth.len(), "{modes:?}");
        for (mode, (hertz, xi)) in modes.iter().zip(truth) {
            assert!(
                (mode["frequency_hz"].as_f64().unwrap() / hertz - 1.0).abs() < 0.01,
                "{mode}"
            );
            assert!(
                (mode["damping_ratio"].as_f64().unwrap() / xi - 1.0).abs() < 0.15,
                "{mode}"
            );
        }
    }
    for axis in found["printer"].as_array().unwrap() {
        assert!(
            axis["recommended"]["residual_vibration"].as_f64().unwrap() <= 0.05,
            "{axis}"
        );
    }
    let text = run(false);
    for line in [
        "[input_shaper]",
        "shaper_type_x: ",
        "shaper_freq_y: ",
        "damping_ratio_x: ",
        "M593 X F",
        "M593 P\"",
    ] {
        assert!(text.contains(line), "no {line:?} in {text}");
    }
    let page = std::fs::read_to_string(folder.path().join("out/identify.html")).unwrap();
    assert!(page.contains("What the shapers leave") && page.contains("Lines to paste"));
}

#[test]
fn reprapfirmwares_file_has_its_rate_in_the_last_line() {
    let mut rng = generator(7);
    let rate = 1344.0;
    let omega = TAU * 40.0;
    let mut text = String::from("Sample,X,Y,Z\n");
    for k in 0..4000 {
        let t = f64::from(k) / rate;
        let ring = (-0.05 * omega * t).exp() * (omega * (1.0_f64 - 0.0025).sqrt() * t).cos();
        let [x, y, z] = [ring, 0.0, 1.0].map(|value| value + 0.005 * noise(&mut rng));
        writeln!(text, "{k},{x:.3},{y:.3},{z:.3}").unwrap();
    }
    text.push_str("Rate 1344, overflows 0\n");
    let found = answer("20-x.csv", &text);
    assert_eq!(found["recordings"][0]["rate_hz"], 1344.0);
    holds(&found["recordings"][0], &[(40.0, 0.05)]);
    assert_eq!(found["printer"][0]["axis"], "x");
}

/// A motor side (rad) that moves six times, and how a link of one mode, 6.4 Hz and 0.03, follows it: position,
/// velocity and acceleration of the motor side, then of the link.
fn moved(samples: usize) -> [Vec<f64>; 6] {
    const MOVES: [[f64; 3]; 6] = [
        [1.0, 0.4, 0.6],
        [4.0, 0.35, -0.8],
        [7.0, 0.5, 1.1],
        [10.0, 0.3, -0.8],
        [13.0, 0.45, 0.6],
        [16.0, 0.4, -0.7],
    ];
    let (w, xi, fine) = (TAU * 6.4, 0.03, 20);
    let dt = 2.0 / RATE / f64::from(fine);
    let motor = |t: f64| -> [f64; 3] {
        let mut sum = [0.0; 3];
        for [from, lasts, by] in MOVES {
            let s = ((t - from) / lasts).clamp(0.0, 1.0);
            sum[0] += by * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            sum[1] += by * 30.0 * (s * (1.0 - s)).powi(2) / lasts;
            sum[2] += by * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (lasts * lasts);
        }
        sum
    };
    let (mut x, mut v) = (0.0, 0.0);
    let mut all: [Vec<f64>; 6] = Default::default();
    for k in 0..samples * fine as usize {
        let [position, velocity, own] = motor(k as f64 * dt);
        let a = 2.0 * xi * w * (velocity - v) + w * w * (position - x);
        if k % fine as usize == 0 {
            let now = [position, velocity, own, x, v, a];
            all.iter_mut()
                .zip(now)
                .for_each(|(column, value)| column.push(value));
        }
        // Symplectic: it shifts no frequency at this step by more than 1e-5.
        v += dt * a;
        x += dt * v;
    }
    all
}

/// A column at half the rate of [`identify`]'s stamps, with noise of this deviation.
fn seen(column: &[f64], level: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    column
        .iter()
        .map(|value| value + level * noise(rng))
        .collect()
}

fn at_half_rate(header: &str, columns: &[Vec<f64>]) -> String {
    let mut text = format!("time_s,{header}\n");
    for k in 0..columns[0].len() {
        let cells: Vec<String> = columns.iter().map(|c| format!("{:.7e}", c[k])).collect();
        writeln!(text, "{:.6},{}", 2.0 * k as f64 / RATE, cells.join(",")).unwrap();
    }
    text
}

#[test]
fn a_moved_link_gives_its_mode_by_whatever_tells_the_motor_side() {
    let mut rng = generator(10);
    let [position, velocity, _, link, _, acceleration] = moved(10_000);
    let link = seen(&link, 5e-5, &mut rng);
    for (header, column) in [
        ("motor_velocity_rad/s", seen(&velocity, 0.005, &mut rng)),
        ("command_position_rad", position.clone()),
    ] {
        let header = format!("{header},link_position_rad");
        let found = answer("run.csv", &at_half_rate(&header, &[column, link.clone()]));
        let mode = &found["mode"];
        let number = |key: &str| mode[key].as_f64().unwrap();
        assert!(
            (number("frequency_hz") - 6.4).abs() < 0.02,
            "{header}: {mode}"
        );
        assert!(
            (number("damping_ratio") - 0.03).abs() < 0.001,
            "{header}: {mode}"
        );
        assert!(
            found["remarks"]
                .to_string()
                .contains("The motor side's motion is "),
            "{found}"
        );
    }
    let acceleration = seen(&acceleration, 0.05, &mut rng);
    let motor = seen(&position, 5e-5, &mut rng);
    for (header, columns) in [
        (
            "motor_position_rad,link_acceleration_rad/s^2",
            vec![motor.clone(), acceleration.clone()],
        ),
        ("motor_position_rad,accel_m_s2", vec![motor, acceleration]),
        ("link_position_rad", vec![link]),
    ] {
        let found = &answer("run.csv", &at_half_rate(header, &columns))["recordings"][0];
        let modes = found["modes"].as_array().unwrap();
        assert_eq!(
            (found["excitation"].as_str(), modes.len()),
            (Some("decay"), 1),
            "{header}: {found}"
        );
        let number = |key: &str| modes[0][key].as_f64().unwrap();
        assert!(
            (number("frequency_hz") - 6.4).abs() < 0.02,
            "{header}: {modes:?}"
        );
        assert!(
            (number("damping_ratio") - 0.03).abs() < 0.001,
            "{header}: {modes:?}"
        );
    }
}

#[test]
fn the_input_of_a_rigid_axis_is_no_vibration() {
    let mut rng = generator(11);
    let [position, velocity, own, ..] = moved(10_000);
    let torque = velocity.iter().zip(&own);
    let torque: Vec<f64> = torque
        .map(|(v, a)| 0.05 * a + 0.4 * (v / 0.002).tanh() + 0.1 * v)
        .collect();
    let columns = [
        seen(&position, 2e-5, &mut rng),
        seen(&torque, 0.01, &mut rng),
    ];
    for input in ["torque_Nm", "motor_current_A", "command_position_rad"] {
        let folder = TempDir::new().unwrap();
        let text = at_half_rate(&format!("motor_position_rad,{input}"), &columns);
        std::fs::write(folder.path().join("axis.csv"), text).unwrap();
        let quell = |verb: &str| {
            let mut command = Command::cargo_bin("quell").unwrap();
            command
                .current_dir(folder.path())
                .args([verb, "axis.csv"])
                .output()
                .unwrap()
        };
        let run = quell("identify");
        let stderr = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("quell diagnose --model"), "{stderr}");
        let inspected = String::from_utf8(quell("inspect").stdout).unwrap();
        assert!(
            inspected.contains("Next: quell diagnose --model"),
            "{inspected}"
        );
    }
}

#[test]
fn a_decay_that_is_stopped_ends_there() {
    let mut rng = generator(12);
    // A tap at 1 s, and a hand at 6 s.
    let decay = ring([6.2, 0.01, 0.5, 1.5 * TAU / 2.0], 5000);
    let mut all: Vec<f64> = (0..9000).map(|_| 0.003 * noise(&mut rng)).collect();
    all[1000..6000]
        .iter_mut()
        .zip(&decay)
        .for_each(|(sum, own)| *sum += own);
    let found = identify("accel_g", &[all]);
    holds(&found, &[(6.2, 0.01)]);
    assert!(
        found["stretches_s"][0][1].as_f64().unwrap() <= 6.0,
        "{found}"
    );
    // Taps, each in what is left of the one before.
    let mut all: Vec<f64> = (0..14_000).map(|_| 0.003 * noise(&mut rng)).collect();
    for (at, amplitude) in [(1000, 0.5), (5000, 0.7), (9000, 0.4)] {
        let decay = ring([6.2, 0.02, amplitude, 1.5 * TAU / 2.0], 14_000 - at);
        all[at..]
            .iter_mut()
            .zip(&decay)
            .for_each(|(sum, own)| *sum += own);
    }
    holds(&identify("accel_g", &[all]), &[(6.2, 0.02)]);
}

#[test]
fn hum_beside_a_decay_is_no_mode() {
    let mut rng = generator(13);
    let decay = ring([6.2, 0.01, 0.5, 0.3], 8000);
    let hum = |k: usize| 0.02 * (TAU * 53.0 * k as f64 / RATE).sin();
    let all = decay
        .iter()
        .enumerate()
        .map(|(k, x)| x + hum(k) + 0.003 * noise(&mut rng))
        .collect();
    let found = identify("accel_g", &[all]);
    holds(&found, &[(6.2, 0.01)]);
}

#[test]
fn rounded_stamps_of_another_rate_make_no_modes_and_are_remarked_upon() {
    let mut rng = generator(14);
    let omega = TAU * 3.3;
    let mut text = String::from("time_s,accel_g\n");
    for k in 0..1500 {
        let t = f64::from(k) / 93.6;
        let value = 0.5 * (-0.02 * omega * t).exp() * (omega * (1.0_f64 - 0.0004).sqrt() * t).cos();
        writeln!(text, "{t:.2},{:.6}", value + 0.001 * noise(&mut rng)).unwrap();
    }
    let found = &answer("run.csv", &text)["recordings"][0];
    holds(found, &[(3.3, 0.02)]);
    assert!(
        (found["rate_hz"].as_f64().unwrap() - 93.6).abs() < 0.01,
        "{found}"
    );
    assert!(
        found["remarks"]
            .to_string()
            .contains("its stamps are rounded to 0.01 s: together they tell 93."),
        "{found}"
    );
}

/// A file of accelerations in a folder.
fn accelerations(folder: &TempDir, name: &str, header: &str, axes: &[Vec<f64>]) {
    let mut text = format!("time_s,{header}\n");
    for k in 0..axes[0].len() {
        let cells: Vec<String> = axes.iter().map(|axis| format!("{:.5}", axis[k])).collect();
        writeln!(text, "{:.3},{}", k as f64 / RATE, cells.join(",")).unwrap();
    }
    std::fs::write(folder.path().join(name), text).unwrap();
}

fn quell(folder: &TempDir, command: &str) -> String {
    let mut run = Command::cargo_bin("quell").unwrap();
    let run = run.current_dir(folder.path()).args(command.split(' '));
    String::from_utf8(run.assert().success().get_output().stdout.clone()).unwrap()
}

#[test]
fn a_model_holds_all_modes_and_the_next_commands_take_the_same_shaper() {
    let (mut rng, folder) = (generator(21), TempDir::new().unwrap());
    let mut noisy = |one: &[f64], share: f64, other: &[f64]| -> Vec<f64> {
        let pairs = one.iter().zip(other);
        pairs
            .map(|(a, b)| a + share * b + 0.02 * noise(&mut rng))
            .collect()
    };
    let one = ring([8.2, 0.02, 5.0, 0.3], 4000);
    let other = ring([21.0, 0.015, 4.0, 1.0], 4000);
    let axes = [noisy(&one, 0.1, &other), noisy(&other, 0.1, &one)];
    accelerations(&folder, "tap.csv", "accel_x_m_s2,accel_y_m_s2", &axes);
    let told: Value = serde_json::from_str(&quell(&folder, "identify tap.csv --json")).unwrap();
    let wanted = &told["recordings"][0]["recommended"];
    let text = quell(&folder, "identify tap.csv");
    assert!(text.contains("Hz along x, 2"), "{text}");
    assert!(text.contains("Hz along y"), "{text}");
    assert!(
        text.ends_with("Next: quell compare --model out/model.toml --rate 1000\n"),
        "{text}"
    );

    let model = quell::model::Model::from_path(folder.path().join("out/model.toml")).unwrap();
    let [effect] = model.effects.as_slice() else {
        panic!("{} effects", model.effects.len());
    };
    let value = |place: usize| effect.parameters[place].value;
    assert!((value(1) / TAU / 21.0 - 1.0).abs() < 1e-3, "{}", value(1));
    assert!(effect.parameters[1].std.is_some_and(|std| std < 0.1));
    // The shares are those of positions: (4 / 21^2) beside (5 / 8.2^2).
    assert!((value(0) / 0.109 - 1.0).abs() < 0.03, "{}", value(0));

    let compared = quell(&folder, "compare --model out/model.toml --rate 1000 --json");
    let compared: Value = serde_json::from_str(&compared).unwrap();
    assert_eq!(compared["recommended"]["shaper"], wanted["shaper"]);
    assert_eq!(compared["modes"].as_array().unwrap().len(), 2);
    let shaper = wanted["shaper"].as_str().unwrap();
    let text = quell(&folder, "compare --model out/model.toml --rate 1000");
    let next = format!("Next: quell shape --shaper {shaper} --model out/model.toml --rate 1000\n");
    assert!(text.ends_with(&next), "{text}");
    let shape = format!("shape --shaper {shaper} --model out/model.toml --rate 1000 --json");
    let shaped: Value = serde_json::from_str(&quell(&folder, &shape)).unwrap();
    let (taps, wanted) = (&shaped["impulses"], &wanted["impulses"]);
    assert_eq!(
        taps.as_array().unwrap().len(),
        wanted.as_array().unwrap().len()
    );
    for (tap, wanted) in taps
        .as_array()
        .unwrap()
        .iter()
        .zip(wanted.as_array().unwrap())
    {
        for (own, wanted) in [
            (&tap["time_s"], &wanted[0]),
            (&tap["amplitude"], &wanted[1]),
        ] {
            assert!(
                (own.as_f64().unwrap() - wanted.as_f64().unwrap()).abs() < 1e-5,
                "{shaped}"
            );
        }
    }
}

#[test]
fn each_recording_of_several_gets_its_model() {
    let (mut rng, folder) = (generator(22), TempDir::new().unwrap());
    for (name, hertz) in [("tap_x.csv", 9.0), ("tap_y.csv", 14.0)] {
        let axis = ring([hertz, 0.02, 5.0, 0.3], 4000);
        let axis = axis.iter().map(|a| a + 0.02 * noise(&mut rng)).collect();
        accelerations(&folder, name, "accel_m_s2", &[axis]);
    }
    let text = quell(&folder, "identify tap_x.csv tap_y.csv");
    let models = "Models: out/model_1_tap_x.toml, out/model_2_tap_y.toml\n\
                  Next: quell compare --model out/model_1_tap_x.toml --rate 1000\n";
    assert!(text.ends_with(models), "{text}");
    let model = std::fs::read_to_string(folder.path().join("out/model_2_tap_y.toml")).unwrap();
    assert!(
        model.contains("from tap_y") && model.contains("value = 14.0"),
        "{model}"
    );
}

/// The reading of an accelerometer of 2 g with 4096 steps that is tapped harder than its range.
#[test]
fn a_clipped_accelerometer_is_named_and_makes_no_modes() {
    let mut rng = generator(31);
    let range = 2.0 * 9.80665;
    for (hertz, xi, amplitude) in [(31.0, 0.012, 1.6), (31.0, 0.012, 4.0), (17.0, 0.03, 2.5)] {
        let mut seen = ring([hertz, xi, amplitude * range, 0.4], 4000);
        for value in &mut seen {
            let step = range / 2048.0;
            *value = ((*value + 0.05 * noise(&mut rng)) / step).round() * step;
            *value = value.clamp(-range, range);
        }
        let clipped = seen.iter().filter(|value| value.abs() >= range).count();
        let found = identify("accel_m_s2", &[seen]);
        holds(&found, &[(hertz, xi)]);
        let remarks = found["remarks"].to_string();
        let words = format!("the sensor is clipped at 19.6133 m/s^2 (2.00 g) in {clipped} samples");
        let other = words.replace("at 19", "at -19").replace("(2", "(-2");
        assert!(
            remarks.contains(&words) || remarks.contains(&other),
            "{words}: {remarks}"
        );
    }
    // What stays within the range is not clipped, however coarse.
    let coarse = ring([31.0, 0.012, 1.6, 0.4], 4000);
    let coarse: Vec<f64> = coarse
        .iter()
        .map(|value| (20.0 * value).round() / 20.0)
        .collect();
    let found = identify("accel_m_s2", &[coarse]);
    assert!(!found["remarks"].to_string().contains("clipped"), "{found}");
}
