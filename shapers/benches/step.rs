//! Cost of one step of the filters, beside a tight loop in C that is compiled and run here.
//!
//! `cargo bench -p quell-shapers --bench step`: trains of 2, 3 and 5 impulses on a grid of 1 kHz (3, 5 and 9
//! taps, because an impulse between two ticks becomes two). Times are the least of many rounds, Rust and C
//! in turn. The sums of all outputs agree to the bit. Where valgrind is there, it counts instructions.

use quell_shapers::{AdaptiveFilter, GridTrain, Mode, Setpoint, ShapingFilter, shaper_by_name};
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

const TICK: f64 = 0.001;
const CAPACITY: usize = 256;
const STEPS: u32 = 200_000;
const ROUNDS: u32 = 10;
const TURNS: usize = 5;
const TRAINS: [(&str, usize); 3] = [("zv", 2), ("zvd", 3), ("ei3", 5)];

fn train(name: &str) -> Option<GridTrain> {
    let mode = Mode::from_hertz(8.12, 0.03).ok()?;
    shaper_by_name(name)?.on_grid(mode, TICK).ok()
}

/// Runs a filter for so many steps and rounds: least time of a step, ns, and the sum of all outputs.
type Step = Box<dyn FnMut(u32, u32) -> (f64, f64)>;

/// Least time of a step of all rounds, ns, and the sum of all outputs.
fn run(steps: u32, rounds: u32, mut step: impl FnMut(Setpoint) -> Setpoint) -> (f64, f64) {
    let (mut least, mut sum) = (f64::INFINITY, 0.0);
    for _ in 0..rounds {
        let start = Instant::now();
        for k in 0..steps {
            let x = 1e-3 * f64::from(k & 1023);
            let out = step(Setpoint {
                position: x,
                velocity: 2.0 * x,
                acceleration: 3.0 * x,
            });
            sum += out.position + out.velocity + out.acceleration;
        }
        least = least.min(1e9 * start.elapsed().as_secs_f64() / f64::from(steps));
    }
    (least, sum)
}

fn filter(kind: &str, train: &GridTrain) -> Option<Step> {
    if kind == "shaping" {
        let mut filter = ShapingFilter::new(TICK, CAPACITY);
        filter.install(train).ok()?;
        return Some(Box::new(move |n, rounds| {
            run(n, rounds, |input| filter.step(input))
        }));
    }
    let mut filter = AdaptiveFilter::new(TICK, CAPACITY, 4096);
    filter.install(train).ok()?;
    Some(Box::new(move |n, rounds| {
        run(n, rounds, |input| filter.step(input))
    }))
}

/// The C loop, compiled; nothing without a C compiler.
fn compiled() -> Option<std::path::PathBuf> {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/step.c");
    let program = std::env::temp_dir().join(format!("quell-step-{}", std::process::id()));
    let done = Command::new("cc")
        .args(["-O2", "-std=c11", "-ffp-contract=off", source, "-o"])
        .arg(&program)
        .status();
    done.is_ok_and(|status| status.success()).then_some(program)
}

fn c_loop(program: &std::path::Path, train: &GridTrain) -> Option<(f64, f64)> {
    let mut command = Command::new(program);
    command.args([STEPS.to_string(), ROUNDS.to_string()]);
    for tap in train.taps() {
        command.args([tap.delay.to_string(), format!("{:e}", tap.amplitude)]);
    }
    let output = String::from_utf8(command.output().ok()?.stdout).ok()?;
    let (time, sum) = output.trim().split_once(' ')?;
    Some((time.parse().ok()?, sum.parse().ok()?))
}

/// Instructions of one step: this program under valgrind with many and with twice as many steps.
fn instructions(kind: &str, name: &str) -> Option<f64> {
    let program = std::env::current_exe().ok()?;
    let count = |steps: u32| -> Option<f64> {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(&program)
            .args(["only", kind, name, &steps.to_string()])
            .output()
            .ok()?;
        let text = String::from_utf8(output.stderr).ok()?;
        let line = text.lines().find(|line| line.contains("Collected"))?;
        line.rsplit(' ').next()?.parse().ok()
    };
    Some((count(2 * STEPS)? - count(STEPS)?) / f64::from(STEPS))
}

fn compare(c: Option<&std::path::Path>, kind: &str, name: &str, impulses: usize) -> Option<()> {
    let train = train(name)?;
    let (mut rust, mut reference) = ((f64::INFINITY, 0.0), None::<(f64, f64)>);
    for _ in 0..TURNS {
        let (time, sum) = filter(kind, &train)?(STEPS, ROUNDS);
        rust = (time.min(rust.0), sum);
        if let Some((time, sum)) = c.and_then(|program| c_loop(program, &train)) {
            reference = Some((reference.map_or(time, |least| time.min(least.0)), sum));
        }
    }
    let beside = match reference {
        Some((time, sum)) => format!(
            "C {time:5.1} ns, ratio {:.2}, {}",
            rust.0 / time,
            if sum == rust.1 { "equal" } else { "NOT EQUAL" }
        ),
        None => "no C compiler".into(),
    };
    let counted =
        instructions(kind, name).map_or("no valgrind".into(), |n| format!("{n:.0} instructions"));
    println!(
        "{kind:8} {impulses} impulses {:2} taps {:5.1} ns a step; {beside}; {counted}",
        train.taps().len(),
        rust.0
    );
    Some(())
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, only, kind, name, steps] = arguments.as_slice()
        && only == "only"
    {
        let step = train(name).and_then(|train| filter(kind, &train));
        if let (Some(mut step), Ok(steps)) = (step, steps.parse()) {
            black_box(step(steps, 1));
        }
        return;
    }
    let c = compiled();
    for kind in ["shaping", "adaptive"] {
        for (name, impulses) in TRAINS {
            if compare(c.as_deref(), kind, name, impulses).is_none() {
                println!("{kind} {name}: could not be run");
            }
        }
    }
    if let Some(program) = c {
        std::fs::remove_file(program).ok();
    }
}
