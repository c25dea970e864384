//! How long a move and its settling last with ZVD, and as the fastest move that leaves no more: over random problems.
//!
//! `cargo bench --bench tolerance`

use std::time::Instant;

use quell::controller::plan_shaped;
use quell::shapers::{GridTrain, Mode, Shaper, UncertainMode, Zvd, common_train};
use quell::tolerance::{Fastest, Moving, Tolerance, ToleranceError, fastest, share_left};
use quell::trajectories::{Limits, Planner};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PROBLEMS: usize = 300;
const LONG: usize = 100;
const PERIOD: f64 = 1e-3;
/// Shares of the unshaped vibration that are allowed, beside what ZVD itself leaves.
const ALLOWED: [f64; 3] = [0.01, 0.02, 0.05];

/// A joint that moves, and the same move with ZVD.
struct Problem {
    moving: Moving,
    train: GridTrain,
    /// Until the command rests with ZVD, s.
    shaped: f64,
    /// Periods of the mode that the unshaped move lasts.
    periods: f64,
}

impl Problem {
    /// Arms that ring at 3 to 20 Hz, modes known to 0.25 to 5 %, moves of 2 to 90 degrees.
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let mode = mode(rng, [3.0, 20.0]);
        let acceleration = log(rng, [300.0, 1200.0]).to_radians();
        let distance = log(rng, [2.0, 90.0]).to_radians();
        let limits = Limits {
            velocity: log(rng, [60.0, 180.0]).to_radians(),
            acceleration,
            jerk: acceleration / log(rng, [0.03, 0.15]),
        };
        Self::new(distance, limits, vec![mode])
    }

    /// Moves of 0.6 to 56 s, at 1 to 180 degrees a second that are reached in 0.05 to 5 s, one to three modes.
    fn long(rng: &mut ChaCha8Rng) -> Self {
        let mut hertz = [3.0, 20.0];
        let modes = (0..rng.random_range(1..=3)).map(|_| {
            let known = mode(rng, hertz);
            let [low, high] = [1.5, 3.0].map(|ratio| ratio * known.mode.natural_frequency());
            hertz = [low, high].map(|frequency| frequency / core::f64::consts::TAU);
            known
        });
        let modes = modes.collect();
        let velocity = log(rng, [1.0, 180.0]).to_radians();
        let acceleration = velocity / log(rng, [0.05, 5.0]);
        let limits = Limits {
            velocity,
            acceleration,
            jerk: acceleration / log(rng, [0.03, 0.5]),
        };
        Self::new(velocity * log(rng, [0.5, 50.0]), limits, modes)
    }

    fn new(distance: f64, limits: Limits, modes: Vec<UncertainMode>) -> Self {
        let moving = Moving {
            ends: [0.0, distance],
            limits,
            modes,
            lever: 1.0,
        };
        let each = moving.modes.iter();
        let each = each.map(|known| Zvd.on_grid(known.mode, PERIOD).unwrap());
        let train = common_train(&each.collect::<Vec<_>>()).unwrap();
        let planner = Planner::new(1).unwrap();
        let slowed = plan_shaped(&planner, moving.ends, moving.limits, &train).unwrap();
        let planned = (slowed.plan.samples() - 1) as f64 * PERIOD;
        Self {
            shaped: planned + train.duration(),
            periods: planned / moving.modes[0].mode.damped_period(),
            moving,
            train,
        }
    }

    /// The fastest that leaves `residual`, what ZVD leaves where it is absent.
    fn fastest(&self, residual: Option<f64>) -> Result<Fastest, ToleranceError> {
        let own = || share_left(&self.moving, &self.train);
        let residual = residual.map_or_else(own, Ok)?;
        let tolerance = Tolerance {
            residual: Some(residual),
            deviation: None,
        };
        fastest(core::slice::from_ref(&self.moving), tolerance, PERIOD)
    }
}

/// A number of which each decade is as likely.
fn log(rng: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    rng.random_range(low.ln()..high.ln()).exp()
}

/// A mode of some frequency, known to 0.25 to 5 %.
fn mode(rng: &mut ChaCha8Rng, hertz: [f64; 2]) -> UncertainMode {
    let mode = Mode::from_hertz(log(rng, hertz), log(rng, [0.005, 0.1])).unwrap();
    UncertainMode {
        mode,
        natural_frequency_std: log(rng, [0.0025, 0.05]) * mode.natural_frequency(),
        damping_ratio_std: 0.1 * mode.damping_ratio(),
    }
}

fn main() {
    let mut rng = ChaCha8Rng::seed_from_u64(19);
    let problems: Vec<Problem> = (0..PROBLEMS).map(|_| Problem::random(&mut rng)).collect();
    println!("{PROBLEMS} moves; duration over that with ZVD, which settles with its end\n");
    println!("left, % of unshaped  moves  median   90 %    most  unattained  ms (median, most)");
    let cells = [None].into_iter().chain(ALLOWED.map(Some));
    for allowed in cells {
        let name = allowed.map_or("as ZVD".into(), |share: f64| format!("{}", 100.0 * share));
        row(&name, &problems, allowed);
    }
    for (least, most) in [(0.0, 2.0), (2.0, 5.0), (5.0, 100.0)] {
        let some = problems.iter();
        let some = some.filter(|one| (least..most).contains(&one.periods));
        let name = format!("as ZVD, {least} to {most} periods");
        row(&name, some, None);
    }
    let long: Vec<Problem> = (0..LONG).map(|_| Problem::long(&mut rng)).collect();
    for count in 1..=3 {
        let some = long.iter().filter(|one| one.moving.modes.len() == count);
        row(&format!("as ZVD, long, modes: {count}"), some, None);
    }
    row("5, long", &long, Some(0.05));
}

fn row<'a>(name: &str, problems: impl IntoIterator<Item = &'a Problem>, allowed: Option<f64>) {
    let (mut ratios, mut times, mut unattained) = (Vec::new(), Vec::new(), 0);
    for problem in problems {
        let start = Instant::now();
        let found = problem.fastest(allowed);
        times.push(1e3 * start.elapsed().as_secs_f64());
        match found {
            Ok(found) => ratios.push(found.duration() / problem.shaped),
            Err(ToleranceError::Unattainable { .. }) => unattained += 1,
            Err(other) => panic!("{other}"),
        }
    }
    let count = ratios.len();
    let [median, ninety, most] = quantiles(&mut ratios);
    let [time, _, longest] = quantiles(&mut times);
    println!(
        "{name:24} {count:4}  {median:6.3} {ninety:6.3}  {most:6.3}  {unattained:10}  {time:.0}, {longest:.0}"
    );
}

/// Median, 90th percentile, largest.
fn quantiles(values: &mut [f64]) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    [0.5, 0.9, 1.0].map(at)
}
