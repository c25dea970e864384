//! Identification of whole recordings: simulated ones against the truth, real ones on-line against
//! off-line.

mod generator;

use assert_cmd::Command;
use generator::{Truth, add_noise, jerk_limited_move, respond, stamps};
#[path = "absent/shared.rs"]
mod shared;

use quell::estimators::{ESTIMATORS, Sample};
use quell::identification::output_only::{Excitation, Vibration, output_only, output_only_until};
use quell::identification::{
    Identification, IdentificationError, NominalModel, Prior, identify, identify_until, prepare,
};
use quell::recording::{Recording, Role};
use quell::signal::TipRegistration;
use quell_shapers::Mode;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use shared::shared;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

fn recordings(name: &str) -> Option<PathBuf> {
    shared("QUELL_RECORDINGS", "recordings", name)
}

/// A recording of a CSV file and a manifest that says which columns are motor side and deformation.
fn manifest(folder: &Path, file: &Path, motor: &str, deformation: &str, unit: &str) -> PathBuf {
    let name = file
        .file_name()
        .expect("a file")
        .to_string_lossy()
        .into_owned();
    std::fs::copy(file, folder.join(&name)).expect("a copy");
    let channel = |role: &str, column: &str| {
        format!(
            "[[channel]]\nrole = \"{role}\"\nfile = \"{name}\"\ntime = \"t_s\"\n\
             column = \"{column}\"\nunit = \"{unit}\"\n"
        )
    };
    let text = format!(
        "name = \"{name}\"\n{}{}",
        channel("motor_position", motor),
        channel("deformation", deformation)
    );
    let path = folder.join("recording.toml");
    std::fs::write(&path, text).expect("a manifest");
    path
}

fn found(path: &Path, model: Option<&NominalModel>) -> Identification {
    let recording = Recording::from_path(path).expect("a recording");
    let series = prepare(recording, model, TipRegistration::Arc).expect("a series");
    let prior = Prior {
        belief: model.map(|model| model.mode),
        scale_is_open: series.scale_is_open,
        rounding: 0.0,
    };
    identify(&series.samples, prior).expect("a vibration")
}

/// Every estimator that ran agrees with the batch fit of the stretch that it ran on.
fn on_line_agrees(found: &Identification, tolerance: f64) {
    for (index, line) in ESTIMATORS.iter().enumerate() {
        let Some(run) = found.quoted(index) else {
            continue;
        };
        let estimate = run.estimator(line.name).and_then(|result| result.estimate);
        let on_line = estimate.expect("an estimate").mode.hertz();
        let off_line = run.batch().expect("a fit").mode.hertz();
        assert!(
            (on_line / off_line - 1.0).abs() < tolerance,
            "{}: {on_line} {off_line}",
            line.name
        );
    }
}

#[test]
fn val_flexible_link_with_a_hub_at_rest() {
    let Some(file) = recordings("quanser_2dsfl/lqg_step_20deg_run01.csv.gz") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = manifest(
        folder.path(),
        &file,
        "hub_meas_rad",
        "tip_defl_meas_rad",
        "rad",
    );
    let found = found(&path, None);
    // The strain signal is logged after a low-pass of 2 Hz: the hub's motion cannot explain it.
    assert_eq!(found.known_input_holds, Some(false));
    on_line_agrees(&found, 0.03);
    let fit = found.reference().batch().expect("a fit").mode;
    assert!((fit.hertz() / 1.84 - 1.0).abs() < 0.03, "{fit:?}");
    let dependence = found.amplitude_dependence.expect("enough cycles");
    assert!(dependence.falls_with_amplitude(), "{dependence:?}");
}

#[test]
fn val_flexible_arm_that_never_rests() {
    let Some(file) = recordings("flexarm_ist/square.csv.gz") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = manifest(folder.path(), &file, "hub_angle_deg", "tip_defl_deg", "deg");
    let found = found(&path, None);
    assert!(found.free_decays.is_empty());
    // A coarse potentiometer does not carry an undamped mode for a minute.
    assert!(
        found.memory.is_finite() && found.explained > 0.95,
        "{}",
        found.explained
    );
    on_line_agrees(&found, 0.03);
}

/// A method that does not know its error never states one that excludes what is recommended; a clock that is off makes no
/// second mode.
#[test]
fn val_deviations_of_methods_do_not_contradict_each_other() {
    for (seed, late) in [(1, 0.0), (2, 0.0), (3, 0.25e-3), (4, -0.25e-3)] {
        let truth = Truth {
            frequency_hz: 7.3,
            damping_ratio: 0.02,
            across: false,
        };
        let samples = two_moves_late(&truth, 2e-5, seed, late);
        let found = identify(&samples, Prior::default()).expect("a vibration");
        let best = found.recommended().expect("a line");
        assert_eq!(
            (best.method, best.further),
            ("likelihood", None),
            "{late}: {best:?}"
        );
        let off = best.mode.mode.natural_frequency() / (7.3 * std::f64::consts::TAU) - 1.0;
        assert!(off.abs() < 2e-3, "{late}: {best:?}");
        if late == 0.0 {
            assert!(
                off.abs() * best.mode.mode.natural_frequency()
                    < 4.0 * best.mode.natural_frequency_std,
                "{best:?}"
            );
        }
        for (index, line) in ESTIMATORS
            .iter()
            .enumerate()
            .filter(|own| !own.1.states_error)
        {
            let result = found.quoted(index).and_then(|run| run.estimator(line.name));
            let one = result
                .and_then(|result| result.estimate)
                .expect("an estimate");
            let distance = one.mode.natural_frequency() - best.mode.mode.natural_frequency();
            let [frequency, _] = found.deviations(&one, line.states_error);
            assert!(
                frequency >= distance.abs(),
                "{}: {frequency} {distance}",
                line.name
            );
        }
    }
}

/// Two moves whose deformation is stamped late by a time, s.
fn two_moves_late(truth: &Truth, noise: f64, seed: u64, late: f64) -> Vec<Sample> {
    let shift = |times: Vec<f64>| -> Vec<f64> { times.iter().map(|time| time - late).collect() };
    let times = stamps(1000.0 / 3.0, 3.6);
    let moves = [
        jerk_limited_move(0.3, 0.4, 0.07, 0.4),
        jerk_limited_move(2.0, 0.5, 0.09, -0.3),
    ];
    let on_time: Vec<_> = moves
        .iter()
        .map(|own| respond(truth, own, &times))
        .collect();
    let late: Vec<_> = moves
        .iter()
        .map(|own| respond(truth, own, &shift(times.clone())))
        .collect();
    let mut samples: Vec<Sample> = (0..times.len())
        .map(|k| Sample {
            time: times[k],
            motor_position: on_time.iter().map(|own| own[k].motor_position).sum(),
            deformation: late.iter().map(|own| own[k].deformation).sum(),
        })
        .collect();
    add_noise(&mut samples, noise, seed);
    samples
}

/// Two moves with rests between, seen from 0.3 s before the first on.
fn two_moves(truth: &Truth, noise: f64, seed: u64) -> Vec<Sample> {
    let times = stamps(1000.0 / 3.0, 3.6);
    let mut samples = respond(truth, &jerk_limited_move(0.3, 0.4, 0.07, 0.4), &times);
    let later = respond(truth, &jerk_limited_move(2.0, 0.5, 0.09, -0.3), &times);
    for (sample, later) in samples.iter_mut().zip(&later) {
        sample.motor_position += later.motor_position;
        sample.deformation += later.deformation;
    }
    add_noise(&mut samples, noise, seed);
    samples
}

#[test]
fn val_simulated_moves() {
    for across in [false, true] {
        let truth = Truth {
            frequency_hz: 8.12,
            damping_ratio: 0.084,
            across,
        };
        let samples = two_moves(&truth, 5e-6, 3);
        let belief = Mode::from_hertz(9.5, 0.05).expect("a mode");
        for belief in [None, Some(belief)] {
            let found = identify(
                &samples,
                Prior {
                    belief,
                    scale_is_open: false,
                    rounding: 0.0,
                },
            );
            let found = found.expect("a vibration");
            assert_eq!(found.known_input_holds, Some(true));
            assert!(found.memory.is_infinite() && found.explained > 0.999);
            assert_eq!(found.free_decays.len(), 2, "{:?}", found.free_decays.len());
            on_line_agrees(&found, 0.03);
            let best = found.whole.estimator("likelihood").expect("a run");
            let estimate = best.estimate.expect("an estimate");
            assert!(
                (estimate.mode.hertz() / 8.12 - 1.0).abs() < 1e-3,
                "{estimate:?}"
            );
            assert!(
                (estimate.mode.damping_ratio() - 0.084).abs() < 1e-3,
                "{estimate:?}"
            );
            let converged = best.converged_at.expect("converged");
            assert!(converged < 0.7, "after the first move: {converged}");
        }
    }
}

/// Encoders with noise on both sides of a joint, of which every twentieth sample is lost by chance: the noise of the motor side
/// is loud at the mode, and the deviations tell it. Chi squared of as many errors as seeds is below its quantile of 99.9 %.
#[test]
fn val_deviations_hold_where_samples_are_lost_and_the_input_is_noisy() {
    let truth = Truth {
        frequency_hz: 6.3,
        damping_ratio: 0.03,
        across: false,
    };
    let noise = Normal::new(0.0, 5e-5).expect("a deviation");
    let errors = (0..12).map(|seed| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut samples = two_moves(&truth, 5e-5, 100 + seed);
        for sample in &mut samples {
            let own = noise.sample(&mut random);
            sample.motor_position += own;
            sample.deformation -= own;
        }
        let lost = Normal::new(0.0, 1.0).expect("a deviation");
        samples.retain(|_| lost.sample(&mut random) > -1.645);
        let prior = Prior {
            belief: None,
            scale_is_open: false,
            rounding: 0.0,
        };
        let found = identify(&samples, prior).expect("a mode");
        let best = found.recommended().expect("a mode");
        assert_eq!(best.further, None, "{seed}");
        let best = best.mode;
        let f = (best.mode.hertz() / 6.3 - 1.0) * best.mode.natural_frequency();
        let xi = best.mode.damping_ratio() - 0.03;
        [f / best.natural_frequency_std, xi / best.damping_ratio_std]
    });
    let errors: Vec<[f64; 2]> = errors.collect();
    for k in 0..2 {
        let squares: f64 = errors.iter().map(|own| own[k] * own[k]).sum();
        assert!(squares < 32.9, "{k}: {squares}, {errors:?}");
    }
}

/// A linear joint shows no dependence on amplitude but by chance; one with quadratic damping does.
#[test]
fn val_amplitude_dependence_is_told_from_chance() {
    let linear = Truth {
        frequency_hz: 8.12,
        damping_ratio: 0.03,
        across: false,
    };
    let says = |samples: &[Sample]| {
        let found = identify(samples, Prior::default()).expect("a vibration");
        found
            .amplitude_dependence
            .is_some_and(|d| d.falls_with_amplitude())
    };
    let false_alarms = (0..30)
        .filter(|&seed| says(&two_moves(&linear, 5e-6, seed)))
        .count();
    // 5 % by chance on one side at most: more than 4 of 30 would happen once in 60.
    assert!(false_alarms <= 4, "{false_alarms} of 30");
    let seen = (0..10).filter(|&seed| {
        let mut samples = two_moves(&linear, 0.0, seed);
        quadratic_decay(&mut samples, 0.7);
        add_noise(&mut samples, 5e-6, seed);
        says(&samples)
    });
    assert!(seen.count() >= 8);
}

/// Replaces the deformation from `from` on by a decay whose damping is 0.01 plus a part that is
/// proportional to the amplitude: `A' = -w (0.01 A + k A^2)` has a closed form.
fn quadratic_decay(samples: &mut [Sample], from: f64) {
    let w = 8.12 * std::f64::consts::TAU;
    let (linear, first) = (0.01 * w, 2e-3);
    let quadratic = 0.04 * w / first;
    for sample in samples
        .iter_mut()
        .filter(|s| s.time >= from && s.time < 2.0)
    {
        let t = sample.time - from;
        let growth = (linear * t).exp();
        let amplitude = first / (growth + quadratic * first / linear * (growth - 1.0));
        sample.deformation = amplitude * (w * t).cos();
    }
}

#[test]
fn the_verb_prints_what_it_promises() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = Truth {
        frequency_hz: 8.12,
        damping_ratio: 0.084,
        across: false,
    };
    let mut csv = String::from("t_s,u,d\n");
    for s in two_moves(&truth, 5e-6, 1) {
        csv.push_str(&format!(
            "{:.6},{:.9},{:.9}\n",
            s.time, s.motor_position, s.deformation
        ));
    }
    let file = folder.path().join("moves.csv");
    std::fs::write(&file, csv).expect("a file");
    let sub = folder.path().join("recording");
    std::fs::create_dir(&sub).expect("a folder");
    manifest(&sub, &file, "u", "d", "rad");
    let quell = |more: &[&str]| {
        let mut command = Command::cargo_bin("quell").expect("the binary");
        command
            .current_dir(folder.path())
            .args(["identify", "recording"])
            .args(more);
        command.output().expect("it runs")
    };
    let output = quell(&["--json"]);
    assert!(output.status.success());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(
        json["estimates"].as_array().map(Vec::len),
        Some(ESTIMATORS.len())
    );
    for estimate in json["estimates"].as_array().into_iter().flatten() {
        let frequency = estimate["frequency_hz"].as_f64().expect("a number");
        assert!((frequency / 8.12 - 1.0).abs() < 0.03, "{estimate}");
    }
    assert_eq!(json["free_decay_from_s"].as_array().map(Vec::len), Some(2));
    let best = &json["recommended"];
    assert_eq!(best["method"], "likelihood");
    assert_eq!(best["modes"][0], json["mode"]);
    let text = String::from_utf8(quell(&["--force"]).stdout).expect("text");
    assert_eq!(text.matches("  recommended").count(), 1, "{text}");
    let recommended = text
        .lines()
        .find(|line| line.starts_with("Recommended: 8.1"));
    assert!(
        recommended.is_some_and(|line| line.contains(", by likelihood. ")),
        "{text}"
    );
    assert!(
        text.ends_with("Next: quell compare --model out/model.toml --rate 1000\n"),
        "{text}"
    );
    assert!(
        json["offline"]
            .as_array()
            .is_some_and(|lines| lines.len() == 3)
    );
    assert!(folder.path().join("out/identify.html").exists());
    std::fs::write(
        folder.path().join("model.toml"),
        "kind = \"flexible_joint\"\n",
    )
    .expect("a file");
    let output = quell(&["--model", "model.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        words.contains("model.toml:1") && words.contains("natural_frequency_hz"),
        "{words}"
    );
}

/// What was stopped, whenever it was, is no answer; what nobody stops is that of [`identify`].
#[test]
fn an_identification_ends_as_soon_as_it_is_told() {
    let truth = Truth {
        frequency_hz: 7.3,
        damping_ratio: 0.03,
        across: false,
    };
    let samples = two_moves(&truth, 2e-5, 5);
    let after = |most: usize| {
        let asked = AtomicUsize::new(0);
        let stop = || asked.fetch_add(1, Relaxed) >= most;
        let ended = identify_until(&samples, Prior::default(), &stop);
        (ended, asked.load(Relaxed))
    };
    let (whole, asked) = after(usize::MAX);
    let best = |found: Identification| found.recommended();
    let alone = identify(&samples, Prior::default()).map(best);
    assert_eq!(whole.map(best).ok(), alone.ok());
    assert!(asked > 5, "{asked}");
    for most in 0..asked {
        let (ended, _) = after(most);
        assert!(
            matches!(ended, Err(IdentificationError::Stopped)),
            "after {most} of {asked}"
        );
    }
    let vibration = Vibration {
        role: quell::recording::Role::Deformation,
        unit: "rad".into(),
        start: 0.0,
        rate: 1000.0 / 3.0,
        axes: vec![
            samples
                .iter()
                .skip(300)
                .take(300)
                .map(|s| s.deformation)
                .collect(),
        ],
        used: 1.0,
        clipped: Vec::new(),
    };
    let stopped = output_only_until(&vibration, &|| true);
    assert!(matches!(stopped, Err(IdentificationError::Stopped)));
}

/// Taps at even intervals make lines of their own far below the modes, and the last decay is cut short.
#[test]
fn decays_at_even_intervals_are_decays_of_the_modes() {
    let (rate, taps) = (10_000.0, 10);
    let ring = |time: f64, hertz: f64, xi: f64| {
        let w = std::f64::consts::TAU * hertz;
        (-xi * w * time).exp() * (w * (1.0 - xi * xi).sqrt() * time).sin()
    };
    let samples: usize = 950_000;
    let clean = (0..samples).map(|k| {
        let since = (0..taps).map(|tap| k as f64 / rate - 1.0 - 10.0 * f64::from(tap));
        let heard = since.filter(|time| *time >= 0.0);
        heard
            .map(|t| 20.0 * ring(t, 8.3, 0.01) + 10.0 * ring(t, 51.0, 0.02))
            .sum()
    });
    let (mut random, normal) = (
        ChaCha8Rng::seed_from_u64(9),
        Normal::new(0.0, 0.05).expect("a deviation"),
    );
    let noisy = |own: f64| own + normal.sample(&mut random);
    let axis: Vec<f64> = clean.map(noisy).collect();
    let vibration = Vibration {
        role: quell::recording::Role::TipAcceleration,
        unit: "m/s^2".into(),
        start: 0.0,
        rate,
        axes: vec![axis],
        used: 1.0,
        clipped: Vec::new(),
    };
    let found = output_only(&vibration).expect("modes");
    assert_eq!(found.excitation, Excitation::Decay);
    let modes = found.modes.iter().map(|mode| mode.known.mode);
    let told: Vec<[f64; 2]> = modes
        .map(|mode| [mode.hertz(), mode.damping_ratio()])
        .collect();
    assert_eq!(told.len(), 2, "{told:?}");
    for ([hertz, xi], [true_hertz, true_xi]) in told.iter().zip([[8.3, 0.01], [51.0, 0.02]]) {
        assert!((hertz / true_hertz - 1.0).abs() < 1e-4, "{told:?}");
        assert!((xi / true_xi - 1.0).abs() < 1e-2, "{told:?}");
    }
}

/// Moves of 0.4 s every 2 s, whose acceleration is a sine or two constants, and what vibrates behind them: acceleration, velocity
/// and position of the deformation, and the velocity of the link.
fn moves(hertz: f64, ratio: f64, smooth: bool) -> [Vec<f64>; 4] {
    let (rate, steps, w) = (500.0, 20, TAU * hertz);
    let acceleration = |t: f64| {
        let (k, sign) = (
            (t % 2.0 - 0.8) / 0.4,
            if t % 4.0 < 2.0 { 1.0 } else { -1.0 },
        );
        match ((0.0..1.0).contains(&k), smooth) {
            (false, _) => 0.0,
            (_, true) => sign * TAU * (TAU * k).sin(),
            (_, false) => sign * 4.0 * if k < 0.5 { 1.0 } else { -1.0 },
        }
    };
    let h = 1.0 / (rate * f64::from(steps));
    let slope = |[v, x, _]: [f64; 3], a: f64| [-w * w * x - 2.0 * ratio * w * v - a, v, a];
    let (mut state, mut out) = ([0.0; 3], [const { Vec::new() }; 4]);
    for k in 0..4000 * steps {
        let t = f64::from(k) * h;
        let first = slope(state, acceleration(t));
        if k % steps == 0 {
            let values = [first[0], state[0], state[1], state[0] + state[2]];
            out.iter_mut()
                .zip(values)
                .for_each(|(all, own)| all.push(own));
        }
        let middle = core::array::from_fn(|i| state[i] + 0.5 * h * first[i]);
        let second = slope(middle, acceleration(t + 0.5 * h));
        state = core::array::from_fn(|i| state[i] + h * second[i]);
    }
    out
}

/// A decay begins where nothing drives it any more, whatever is measured of it and however the move was.
#[test]
fn val_free_decays_have_the_damping_of_the_mode() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let roles = [
        Role::TipAcceleration,
        Role::LinkVelocity,
        Role::Deformation,
        Role::LinkVelocity,
    ];
    for (hertz, ratio) in [(6.0, 0.03), (6.0, 0.1), (17.0, 0.03)] {
        for smooth in [true, false] {
            let of_all = moves(hertz, ratio, smooth);
            // What is left of a smooth move at 17 Hz is a thousandth of the link's velocity.
            let absolute = hertz < 10.0;
            let some = of_all.iter().zip(roles).take(3 + usize::from(absolute));
            for (k, (values, role)) in some.enumerate() {
                for share in [0.0, 1e-3] {
                    let most = values.iter().copied().fold(0.0, |a: f64, b| a.max(b.abs()));
                    let noise = Normal::new(0.0, share * most).unwrap();
                    let vibration = Vibration {
                        role,
                        unit: String::new(),
                        start: 0.0,
                        rate: 500.0,
                        axes: vec![
                            values
                                .iter()
                                .map(|own| own + noise.sample(&mut random))
                                .collect(),
                        ],
                        used: 1.0,
                        clipped: Vec::new(),
                    };
                    let case =
                        format!("{hertz} Hz, {ratio}, smooth {smooth}, signal {k}, noise {share}");
                    let found = output_only(&vibration).expect(&case);
                    assert_eq!(found.excitation, Excitation::Decay, "{case}");
                    let known = found.modes[0].known;
                    let mode = known.mode;
                    assert!(
                        (mode.hertz() / hertz - 1.0).abs() < 2e-3,
                        "{case}: {mode:?}"
                    );
                    // The velocity of a link that brakes evenly is a straight line, which a second mode follows, too.
                    let allowed = (0.02 * ratio).max(known.damping_ratio_std);
                    assert!(
                        (mode.damping_ratio() - ratio).abs() < allowed,
                        "{case}: {known:?}"
                    );
                }
            }
        }
    }
}

/// Two encoders in counts, whose gain nobody knows: the deformation is what is left of the link beside the motor side.
#[test]
fn val_two_sensors_in_raw_counts() {
    let truth = Truth {
        frequency_hz: 7.3,
        damping_ratio: 0.03,
        across: false,
    };
    let samples = two_moves(&truth, 2e-5, 5);
    let channel = |role, of: &dyn Fn(&Sample) -> f64| quell::recording::Channel {
        role,
        unit: "raw".into(),
        time: samples.iter().map(|s| s.time).collect(),
        columns: vec![samples.iter().map(|s| of(s).round()).collect()],
    };
    let motor = channel(quell::recording::Role::MotorPosition, &|s| {
        1e5 * s.motor_position
    });
    let link = channel(quell::recording::Role::LinkPosition, &|s| {
        -1.7e5 * (s.motor_position + s.deformation) + 1200.0
    });
    let recording = Recording {
        name: "counts".into(),
        payload: None,
        channels: vec![motor, link],
    };
    let series = prepare(recording, None, TipRegistration::Arc).expect("a series");
    let found = identify(&series.samples, Prior::default()).expect("a vibration");
    let best = found.recommended().expect("a line").mode;
    assert!((best.mode.hertz() / 7.3 - 1.0).abs() < 2e-3, "{best:?}");
    assert!(
        (best.mode.damping_ratio() / 0.03 - 1.0).abs() < 0.05,
        "{best:?}"
    );
}

/// Over what the tracker of the simulated arm saw, in a frame of its own.
#[test]
fn the_verb_compares_the_registrations() {
    let folder = tempfile::tempdir().expect("a folder");
    let quell = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("quell").expect("the binary");
        let output = command.current_dir(folder.path()).args(arguments).output();
        let output = output.expect("it runs");
        assert!(output.status.success(), "{output:?}");
        output.stdout
    };
    quell(&["move", "--json"]);
    let mut frequencies = Vec::new();
    for chosen in ["arc", "icp"] {
        let told = quell(&[
            "identify",
            "out/unshaped",
            "--model",
            "out/model.toml",
            "--registration",
            chosen,
            "--force",
            "--json",
        ]);
        let told: serde_json::Value = serde_json::from_slice(&told).expect("JSON");
        let ways = told["registrations"].as_array().expect("a list");
        let names: Vec<_> = ways.iter().map(|way| way["method"].as_str()).collect();
        assert_eq!(names, [Some("arc"), Some("icp")]);
        for way in ways {
            let number = |key: &str| way[key].as_f64().expect("a number");
            // The tracker's 10 um in two coordinates, and what the vibration at the ends turns the path of closest
            // points; 8.12 Hz and 0.084 are the arm's.
            assert!((0.013..0.02).contains(&number("residual_mm")), "{way}");
            assert!(number("angle_error_mrad").abs() < 0.4, "{way}");
            assert!((number("frequency_hz") / 8.12 - 1.0).abs() < 0.005, "{way}");
            assert!((number("damping_ratio") - 0.084).abs() < 0.005, "{way}");
        }
        assert_eq!(ways[0]["angle_error_mrad"], 0.0);
        let at = |lines: &serde_json::Value| lines[0]["frequency_hz"].clone();
        let way = usize::from(chosen == "icp");
        assert_eq!(at(&told["offline"]), ways[way]["frequency_hz"]);
        frequencies.push([0, 1].map(|way| ways[way]["frequency_hz"].clone()));
    }
    // Whichever is chosen, both are told alike.
    assert_eq!(frequencies[0], frequencies[1]);
}

/// Of 20 machines that do not change, in two moves each, none is told to: neither of one mode, nor of two, which one mode
/// fits differently in each stretch.
#[test]
fn a_mode_that_stays_the_same_is_not_told_to_change() {
    for second in [0.0, 0.1] {
        for seed in 0..20_u32 {
            let of = |step: u32, least: f64, most: f64| {
                let share = f64::from((seed * step + 3) % 20) / 20.0;
                least * (most / least).powf(share)
            };
            let truth = Truth {
                frequency_hz: of(1, 4.0, 13.0),
                damping_ratio: of(7, 0.01, 0.08),
                across: false,
            };
            let other = Truth {
                frequency_hz: of(3, 1.1, 2.5) * truth.frequency_hz,
                ..truth
            };
            let mut samples = two_moves(&truth, 0.0, 0);
            for (sample, other) in samples.iter_mut().zip(two_moves(&other, 0.0, 0)) {
                sample.deformation += second * (other.deformation - sample.deformation);
            }
            add_noise(&mut samples, of(9, 1e-6, 5e-5), seed.into());
            let found = identify(&samples, Prior::default()).expect("a vibration");
            let best = found.recommended().expect("a mode");
            assert!(best.decays_agree, "{second} {truth:?}: {best:?}");
            assert!(
                second > 0.0 || best.between == [0.0; 2],
                "{truth:?}: {best:?}"
            );
        }
    }
}
