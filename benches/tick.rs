//! Cost of a tick of one axis and of seven: trajectory, shaper, estimation, adaptation.
//!
//! `cargo bench --bench tick`: the embedded arm at 250 Hz with its tracker at 333 Hz makes moves with
//! payloads that change, so that there is always something to learn. What its sensors said is
//! recorded first; timed is the controller alone, on that recording. Times are the least of some rounds.
//! Where valgrind is there, it counts instructions.

#[path = "../tests/embedded/mod.rs"]
mod embedded;

use embedded::axis_settings;
use quell::controller::{AxisSettings, Controller, Setpoint};
use quell::estimators::{ESTIMATORS, EstimatorEntry};
use quell::learning::Hold;
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::signal::Measurement;
use quell_shapers::{GridTrain, Mode, Tap, UncertainMode, shaper_by_name};
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const PERIOD: f64 = 0.004;
const TICKS: usize = 20_000;
/// Ticks of which instructions are counted.
const COUNTED: usize = 5_000;
/// Ticks between two moves: the vibration has died.
const PAUSE: usize = 600;
const ROUNDS: usize = 5;
const LIMITS: Limits = Limits {
    velocity: 2.6,
    acceleration: 10.0,
    jerk: 80.0,
};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// The measurements before each tick, and the moves: tick, from, to.
struct Tape {
    measured: Vec<Vec<Measurement>>,
    moves: Vec<(usize, f64, f64)>,
}

#[derive(Clone, Copy)]
struct Case {
    estimator: &'static EstimatorEntry,
    shaper: &'static str,
    /// Whether the train is one that was solved between moves, for three modes.
    solved: bool,
}

/// A train as long as a period of 8 Hz with as many impulses as there may be.
fn solved() -> Outcome<GridTrain> {
    let count = (0.125 / PERIOD) as u32;
    let tap = |delay| Tap {
        delay,
        amplitude: 1.0 / f64::from(count),
    };
    let taps: Vec<Tap> = (0..count).map(tap).collect();
    Ok(GridTrain::from_taps(&taps, PERIOD)?)
}

fn controller(case: Case) -> Outcome<Controller> {
    let belief = Mode::from_hertz(10.15, 0.084)?;
    let settings = AxisSettings {
        limits: LIMITS,
        estimator: case.estimator,
        shaper: shaper_by_name(case.shaper),
        ..axis_settings(belief, PERIOD, 0.003)
    };
    let mut controller = Controller::new(settings, 0.0)?;
    if case.solved {
        let known = UncertainMode::believed(belief);
        controller.set_train(shaper_by_name(case.shaper), &known, &solved()?)?;
        controller.hold(Some(Hold::SeveralModes));
        controller.keep_samples(128);
    }
    Ok(controller)
}

fn plan(from: f64, to: f64) -> Outcome<SampledTrajectory> {
    let ends = [from, to].map(AxisState::at_rest);
    let trajectory = Planner::new(1)?.plan(&ends[..1], &ends[1..], &[LIMITS])?;
    Ok(trajectory.sample(PERIOD)?)
}

/// Controller and arm in a loop.
fn tape(ticks: usize, case: Case) -> Outcome<Tape> {
    let mut arm = ArmSimulation::new(&Robot::rx170(), 0, &SimulationOptions::default())?;
    let mut controller = controller(case)?;
    let mut tape = Tape {
        measured: vec![Vec::new()],
        moves: Vec::new(),
    };
    let mut since = 0;
    for tick in 0..ticks {
        since += 1;
        if since >= PAUSE && controller.is_settled() {
            arm.set_payload([0.0, 40.0, 15.0, 60.0][tape.moves.len() % 4])?;
            let from = controller.planned().position;
            let to = if from < 0.25 { 0.5 } else { 0.0 };
            controller
                .load(plan(from, to)?)
                .map_err(|(_, error)| error)?;
            tape.moves.push((tick, from, to));
            since = 0;
        }
        let setpoint = controller.tick(&tape.measured[tick]);
        let command = Command {
            position: setpoint.position,
            velocity: Some(setpoint.velocity),
        };
        tape.measured.push(arm.step(command, PERIOD).to_vec());
    }
    Ok(tape)
}

/// Seconds of each tick, the clock's own cost taken off, and the sum of all setpoints.
fn replay(tape: &Tape, axes: usize, case: Case, hears: bool) -> Outcome<(Vec<f64>, f64)> {
    let controllers = (0..axes).map(|_| controller(case));
    let mut controllers = controllers.collect::<Outcome<Vec<_>>>()?;
    let (mut moves, mut sum) = (tape.moves.iter().peekable(), 0.0);
    let mut seconds = Vec::with_capacity(tape.measured.len());
    for (tick, measured) in tape.measured.iter().enumerate() {
        if let Some(&(_, from, to)) = moves.next_if(|planned| planned.0 == tick) {
            for controller in &mut controllers {
                controller
                    .load(plan(from, to)?)
                    .map_err(|(_, error)| error)?;
            }
        }
        let inbox = if hears { measured.as_slice() } else { &[] };
        let start = Instant::now();
        for controller in &mut controllers {
            sum += total(controller.tick(inbox));
            controller.clear_samples();
        }
        let end = Instant::now();
        let clock = end.elapsed();
        seconds.push((end - start).saturating_sub(clock).as_secs_f64());
    }
    Ok((seconds, sum))
}

fn total(setpoint: Setpoint) -> f64 {
    setpoint.position + setpoint.velocity + setpoint.acceleration
}

/// Instructions of one tick: this program under valgrind, the recording replayed once and twice.
fn instructions(axes: usize, case: Case) -> Option<f64> {
    let program = std::env::current_exe().ok()?;
    let count = |rounds: &str| -> Option<f64> {
        let output = std::process::Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg("--toggle-collect=*Controller*tick*")
            .arg(&program)
            .args([
                "only",
                &axes.to_string(),
                case.estimator.name,
                case.shaper,
                rounds,
            ])
            .output()
            .ok()?;
        let text = String::from_utf8(output.stderr).ok()?;
        let line = text.lines().find(|line| line.contains("Collected"))?;
        line.rsplit(' ').next()?.parse().ok()
    };
    Some((count("2")? - count("1")?) / COUNTED as f64)
}

fn print(tape: &Tape, axes: usize, case: Case, hears: bool) -> Outcome<()> {
    let mut least: Option<Vec<f64>> = None;
    for _ in 0..ROUNDS {
        let (seconds, _) = replay(tape, axes, case, hears)?;
        let seconds = &seconds[..TICKS];
        let least = least.get_or_insert_with(|| seconds.to_vec());
        for (least, now) in least.iter_mut().zip(seconds) {
            *least = least.min(*now);
        }
    }
    let mut least = least.unwrap_or_default();
    let mean = 1e9 * least.iter().sum::<f64>() / TICKS as f64;
    least.sort_by(f64::total_cmp);
    let at = |part: f64| 1e9 * least[((TICKS - 1) as f64 * part) as usize];
    let counted = match hears && !case.solved && case.estimator.name == ESTIMATORS[0].name {
        true => instructions(axes, case).map_or("no valgrind".into(), |n| format!("{n:.0}")),
        false => "-".into(),
    };
    let name = match (hears, case.solved) {
        (false, _) => "nothing measured",
        (true, true) => "held, three modes",
        (true, false) => case.estimator.name,
    };
    println!(
        "{name:22}{:8}{axes:5}{mean:9.0}{:9.0}{:9.0}{:9.0}  {counted:>12}",
        case.shaper,
        at(0.5),
        at(0.99),
        at(1.0)
    );
    Ok(())
}

/// Seconds that it takes to retune a plan in motion for a new way, at a control period: the most of some instants, each the least of
/// some rounds. The train has sixteen impulses.
fn retuned(period: f64, modes: &[f64]) -> Outcome<f64> {
    let limits = Limits {
        jerk: 1000.0,
        ..LIMITS
    };
    let modes = modes.iter().map(|hertz| {
        let mode = Mode::from_hertz(*hertz, 0.03)?;
        Ok(UncertainMode {
            mode,
            natural_frequency_std: 0.003 * mode.natural_frequency(),
            damping_ratio_std: 0.003,
        })
    });
    let modes = modes.collect::<Outcome<Vec<_>>>()?;
    let step = (0.2 / period) as u32 / 16;
    let tap = |k| Tap {
        delay: k * step,
        amplitude: 1.0 / 16.0,
    };
    let train = GridTrain::from_taps(&(0..16).map(tap).collect::<Vec<_>>(), period)?;
    let planner = Planner::new(1)?;
    let towards = |from: AxisState, to: f64| {
        let plan = planner.plan(&[from], &[AxisState::at_rest(to)], &[limits])?;
        plan.sample(period)
    };
    let mut most: f64 = 0.0;
    for tenth in 1..7 {
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            let settings = AxisSettings {
                limits,
                shaper: shaper_by_name("zvd"),
                ..axis_settings(Mode::from_hertz(8.0, 0.05)?, period, period)
            };
            let mut controller = Controller::new(settings, 0.0)?;
            let first = towards(AxisState::at_rest(0.0), 1.0)?;
            controller.load(first).map_err(|(_, error)| error)?;
            for _ in 0..(0.1 * f64::from(tenth) / period) as usize {
                controller.tick(&[]);
            }
            let now = controller.planned();
            let from = AxisState {
                position: now.position,
                velocity: now.velocity,
                acceleration: now.acceleration,
            };
            let next = towards(from, 0.6)?;
            controller.load(next).map_err(|(_, error)| error)?;
            let start = Instant::now();
            black_box(controller.retune(&train, &modes[0], &modes));
            least = least.min(start.elapsed().as_secs_f64());
        }
        most = most.max(least);
    }
    Ok(most)
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, only, axes, name, shaper, rounds] = arguments.as_slice()
        && only == "only"
    {
        let case = Case {
            estimator: quell::estimators::estimator(name).ok_or("no such estimator")?,
            shaper: shaper_by_name(shaper).ok_or("no such shaper")?.name(),
            solved: false,
        };
        let tape = tape(COUNTED, case)?;
        for _ in 0..rounds.parse()? {
            black_box(replay(&tape, axes.parse()?, case, true)?);
        }
        return Ok(());
    }
    println!(
        "Nanoseconds of a tick at 250 Hz with a tracker at 333 Hz, over {TICKS} ticks with moves."
    );
    println!(
        "{:22}{:8}{:>5}{:>9}{:>9}{:>9}{:>9}  {:>12}",
        "", "", "axes", "mean", "median", "99 %", "most", "instructions"
    );
    let zvd = |estimator| Case {
        estimator,
        shaper: "zvd",
        solved: false,
    };
    let three = Case {
        solved: true,
        ..zvd(&ESTIMATORS[0])
    };
    let solved = Case {
        estimator: &ESTIMATORS[0],
        shaper: "optimal",
        solved: false,
    };
    let singles = ESTIMATORS.iter().map(zvd);
    for (k, case) in [three]
        .into_iter()
        .chain(singles)
        .chain([solved])
        .enumerate()
    {
        let tape = tape(TICKS, case)?;
        if k == 0 {
            print(&tape, 1, case, false)?;
        }
        print(&tape, 1, case, true)?;
        print(&tape, 7, case, true)?;
    }
    println!(
        "Microseconds of a retune of a new way in motion, the most of some instants: one mode, three modes."
    );
    for period in [0.001, 0.002, 0.004] {
        let [one, three] = [&[8.0][..], &[8.0, 19.0, 31.0]].map(|modes| retuned(period, modes));
        println!(
            "{:6.0} Hz{:9.0}{:9.0}",
            1.0 / period,
            1e6 * one?,
            1e6 * three?
        );
    }
    Ok(())
}
