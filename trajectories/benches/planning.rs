//! Cost of a plan beside bare Ruckig (C++) and rsruckig (its port to Rust) on the same random problems.
//!
//! `cargo bench -p quell-trajectories --bench planning`: 20 000 problems of 1 and of 7 axes, moving starts,
//! targets at rest (half of them) or moving. The durations are compared, and the times set as ratios: each is
//! the least of a few rounds over all problems, one after the other. Bare Ruckig only solves and tells the
//! duration, by objects made for each problem (`ruckig`) or once for all (`kept`); a plan is checked, and says of
//! each axis what it does when.

use quell_trajectories::{AxisState, Limits, Planner};
use rsruckig::error::IgnoreErrorHandler;
use std::time::Instant;

const PROBLEMS: usize = 20_000;
const ROUNDS: usize = 5;
const MOST_AXES: usize = 7;

/// From a state to a state within limits, one entry for each axis.
struct Problem {
    from: Vec<AxisState>,
    to: Vec<AxisState>,
    limits: Vec<Limits>,
}

/// SplitMix64: the next number in [-1, 1).
fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn problems(axes: usize) -> Vec<Problem> {
    let mut seed = 1;
    let mut problem = |k: usize| {
        let mut one = || {
            let mut draw = || draw(&mut seed);
            let limits = Limits {
                velocity: 2.0 + draw(),
                acceleration: 10.0 + 5.0 * draw(),
                jerk: 80.0 + 40.0 * draw(),
            };
            let mut state = |share: f64| AxisState {
                position: 2.0 * draw(),
                velocity: share * limits.velocity * draw(),
                acceleration: share * limits.acceleration * draw(),
            };
            // Slow enough that the acceleration can come to rest before the velocity is at its limit.
            (
                state(0.5),
                state(if k.is_multiple_of(2) { 0.0 } else { 0.3 }),
                limits,
            )
        };
        let mut problem = Problem {
            from: Vec::new(),
            to: Vec::new(),
            limits: Vec::new(),
        };
        for _ in 0..axes {
            let (from, to, limits) = one();
            problem.from.push(from);
            problem.to.push(to);
            problem.limits.push(limits);
        }
        problem
    };
    (0..PROBLEMS).map(&mut problem).collect()
}

fn planned(problems: &[Problem], axes: usize) -> Vec<f64> {
    let Ok(planner) = Planner::new(axes) else {
        return Vec::new();
    };
    let plan = |p: &Problem| planner.plan(&p.from, &p.to, &p.limits);
    let duration = |p| plan(p).map_or(f64::NAN, |trajectory| trajectory.duration());
    problems.iter().map(duration).collect()
}

/// Sets the input of either library to a problem: their fields bear the same names.
macro_rules! set {
    ($input:ident, $problem:expr) => {
        let states = $problem.from.iter().zip(&$problem.to);
        for (i, ((from, to), limits)) in states.zip(&$problem.limits).enumerate() {
            $input.current_position[i] = from.position;
            $input.current_velocity[i] = from.velocity;
            $input.current_acceleration[i] = from.acceleration;
            $input.target_position[i] = to.position;
            $input.target_velocity[i] = to.velocity;
            $input.target_acceleration[i] = to.acceleration;
            $input.max_velocity[i] = limits.velocity;
            $input.max_acceleration[i] = limits.acceleration;
            $input.max_jerk[i] = limits.jerk;
        }
    };
}

/// Ruckig's objects for a number of axes.
struct Bare {
    input: ruckig::InputParameter,
    trajectory: ruckig::Trajectory,
    solver: ruckig::Ruckig,
}

impl Bare {
    fn new(axes: usize) -> Self {
        Self {
            input: ruckig::InputParameter::new(axes),
            trajectory: ruckig::Trajectory::new_direct(axes),
            solver: ruckig::Ruckig::new_direct_and_offline(axes),
        }
    }

    fn duration(&mut self, p: &Problem) -> f64 {
        let input = &mut self.input;
        set!(input, p);
        match self.solver.calculate(input, &mut self.trajectory) {
            ruckig::Result::Working => self.trajectory.get_duration(),
            _ => f64::NAN,
        }
    }
}

fn bare(problems: &[Problem], axes: usize) -> Vec<f64> {
    let duration = |p| Bare::new(axes).duration(p);
    problems.iter().map(duration).collect()
}

fn bare_and_kept(problems: &[Problem], axes: usize) -> Vec<f64> {
    let mut kept = Bare::new(axes);
    problems.iter().map(|p| kept.duration(p)).collect()
}

fn ported<const AXES: usize>(problems: &[Problem]) -> Vec<f64> {
    let duration = |p: &Problem| {
        let mut input = rsruckig::input_parameter::InputParameter::<AXES>::new(None);
        set!(input, p);
        let mut trajectory = rsruckig::trajectory::Trajectory::<AXES>::new(None);
        let mut solver = rsruckig::ruckig::Ruckig::<AXES, IgnoreErrorHandler>::new(None, 0.001);
        match solver.calculate(&input, &mut trajectory) {
            Ok(rsruckig::result::RuckigResult::Working) => trajectory.get_duration(),
            _ => f64::NAN,
        }
    };
    problems.iter().map(duration).collect()
}

/// Solves all problems and tells their durations, s.
type Solve<'a> = Box<dyn Fn() -> Vec<f64> + 'a>;

/// Least time of a problem, s, and the durations.
fn timed(solve: &dyn Fn() -> Vec<f64>, best: &mut (f64, Vec<f64>)) {
    let start = Instant::now();
    let durations = solve();
    let time = start.elapsed().as_secs_f64() / PROBLEMS as f64;
    *best = (time.min(best.0), durations);
}

/// The largest relative difference of durations, how many differ by more than 1e-9, how many only one solved.
fn differences(a: &[f64], b: &[f64]) -> (f64, usize, usize) {
    let relative = |(a, b): (&f64, &f64)| (a - b).abs() / a.max(1e-3);
    let both: Vec<f64> = a
        .iter()
        .zip(b)
        .map(relative)
        .filter(|d| !d.is_nan())
        .collect();
    let alone = a
        .iter()
        .zip(b)
        .filter(|(a, b)| a.is_nan() != b.is_nan())
        .count();
    let largest = both.iter().copied().fold(0.0, f64::max);
    (largest, both.iter().filter(|&&d| d > 1e-9).count(), alone)
}

fn main() {
    for axes in [1, MOST_AXES] {
        let problems = problems(axes);
        let solvers: [(&str, Solve); 4] = [
            ("ruckig", Box::new(|| bare(&problems, axes))),
            ("kept", Box::new(|| bare_and_kept(&problems, axes))),
            (
                "rsruckig",
                Box::new(|| match axes {
                    1 => ported::<1>(&problems),
                    _ => ported::<MOST_AXES>(&problems),
                }),
            ),
            ("quell", Box::new(|| planned(&problems, axes))),
        ];
        let mut best = [const { (f64::INFINITY, Vec::new()) }; 4];
        for _ in 0..ROUNDS {
            for ((_, solve), best) in solvers.iter().zip(&mut best) {
                timed(solve, best);
            }
        }
        let reference = best[0].clone();
        for ((name, _), (time, durations)) in solvers.iter().zip(&best) {
            let (largest, count, alone) = differences(&reference.1, durations);
            let unsolved = durations.iter().filter(|d| d.is_nan()).count();
            println!(
                "{axes} axes {name:9} {:7.2} us, ratio {:5.2}; durations: largest difference {largest:.1e}, \
                 {count} of {PROBLEMS} differ, {alone} solved by one only, {unsolved} unsolved",
                1e6 * time,
                time / reference.0,
            );
        }
    }
}
