//! The example in C, built without std and without a heap, beside the filter in Rust.

use quell_shapers::{
    AdaptiveFilter, GridTrain, Mode, MotionLimits, Retune, RetuneOutcome, Setpoint, UncertainMode,
};
use quell_shapers::{Shaper, Tap, Zvd};
use std::path::{Path, PathBuf};
use std::process::Command;

const TICK: f64 = 0.004;
const MOVE: usize = 100;
const TICKS: usize = 400;

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a command; what it printed.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// The library as a controller gets it: with a panic handler of its own, which could not be linked beside
/// that of std.
fn library() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bare");
    run(Command::new(env!("CARGO"))
        .args([
            "rustc",
            "--locked",
            "-p",
            "quell-shapers-c",
            "--profile",
            "bare",
        ])
        .args([
            "--features",
            "bare",
            "--crate-type",
            "staticlib",
            "--target-dir",
        ])
        .arg(&target)
        .current_dir(folder()));
    target.join("bare/libquell_shapers_c.a")
}

/// What the example of this name prints.
fn example(name: &str, library: &Path) -> String {
    let program = library.with_file_name(name);
    // No fused multiplication and addition, so that the plan is the same number in both languages.
    run(Command::new("cc")
        .args([
            "-std=c11",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-O2",
            "-ffp-contract=off",
        ])
        .arg("-I")
        .arg(folder().join("include"))
        .arg(folder().join(format!("examples/{name}.c")))
        .arg(library)
        .arg("-lm")
        .arg("-o")
        .arg(&program));
    run(&mut Command::new(program))
}

fn planned(tick: usize) -> Setpoint {
    let (duration, x) = (MOVE as f64 * TICK, (tick as f64 / MOVE as f64).min(1.0));
    let rest = 1.0 - x;
    Setpoint {
        position: x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        velocity: 30.0 * x * x * rest * rest / duration,
        acceleration: 60.0 * x * rest * (1.0 - 2.0 * x) / (duration * duration),
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(' ')
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// Halfway the mode turns out to be another one.
fn retune(filter: &mut AdaptiveFilter) {
    let identified = Mode::from_hertz(9.0, 0.04).unwrap();
    let request = Retune {
        train: &Zvd.on_grid(identified, TICK).unwrap(),
        modes: &[UncertainMode {
            mode: identified,
            natural_frequency_std: 0.005 * identified.natural_frequency(),
            damping_ratio_std: 0.005,
        }],
        dead_band: 0.0,
        resolution: 0.0,
        limits: MotionLimits {
            velocity: 10.0,
            acceleration: 100.0,
            jerk: f64::INFINITY,
        },
    };
    let outcome = filter.retune(&request, MOVE / 2, |k| planned(MOVE / 2 + k));
    assert!(
        matches!(outcome, RetuneOutcome::Corrected(_)),
        "{outcome:?}"
    );
}

#[test]
fn the_example_in_c_gives_what_rust_gives() {
    let library = library();
    let printed = example("shape", &library);
    let line = |word: &str| printed.lines().find(|line| line.starts_with(word)).unwrap();
    let train = |word: &str| {
        let taps = numbers(line(word));
        let taps = taps.chunks(2).map(|pair| Tap {
            delay: pair[0] as u32,
            amplitude: pair[1],
        });
        GridTrain::from_taps(&taps.collect::<Vec<_>>(), TICK).unwrap()
    };
    let first = train("train");
    let both = train("both");
    for (hertz, damping) in [(8.0, 0.05), (19.0, 0.03)] {
        let mode = Mode::from_hertz(hertz, damping).unwrap();
        let left = both.residual_vibration(mode.natural_frequency(), mode.damping_ratio());
        assert!(left < 1e-12, "{hertz} Hz: {left}");
    }
    let mut filter = AdaptiveFilter::new(TICK, 128, 1024);
    filter.install(&first).unwrap();
    let steps: Vec<_> = printed
        .lines()
        .filter_map(|line| line.strip_prefix("step "))
        .collect();
    assert_eq!(steps.len(), TICKS);
    for (tick, line) in (1..).zip(steps) {
        let out = filter.step(planned(tick));
        let [out, seen] = [
            vec![out.position, out.velocity, out.acceleration],
            numbers(line),
        ];
        if tick <= MOVE / 2 {
            assert_eq!(out, seen, "tick {tick}");
        }
        // The correction depends on exp and sin, which come from another library without std.
        let near = out.iter().zip(&seen).all(|(a, b)| (a - b).abs() < 1e-8);
        assert!(near, "tick {tick}: {out:?} {seen:?}");
        if tick == MOVE / 2 {
            retune(&mut filter);
        }
    }
    let left = numbers(&line("residual").replace(',', ""));
    let [shaped, unshaped, settled] = left[..] else {
        panic!("{left:?}");
    };
    assert!(shaped < 1e-9 * unshaped && settled == 1.0, "{left:?}");
    // QUELL_NULL, QUELL_UNKNOWN_SHAPER, QUELL_MEMORY, QUELL_ALIGNMENT.
    assert_eq!(numbers(line("refused")), [1.0, 5.0, 3.0, 2.0]);

    // The short one steps to 1 over the length of the train.
    let steps: Vec<f64> = example("step", &library)
        .lines()
        .flat_map(numbers)
        .collect();
    assert_eq!((steps.len(), steps.last()), (40, Some(&1.0)));
    assert!(steps[0] < 1.0 && steps.is_sorted(), "{steps:?}");
}
