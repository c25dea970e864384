//! The recommended shaper beside the best that there is: all impulse times and positive amplitudes within
//! the same delay, least worst residual over the same uncertainty of frequency and damping ratio.
//!
//! `cargo bench -p quell-shapers --bench optimum`. The best amplitudes on a fine grid of times are a convex
//! problem: `|H| <= V` is `Re(exp(-j phi) H) <= V` for every phase, which is a game between times and pairs of
//! mode and phase. Pairs are added where the residual is above the value, until none is by 0.05 %. The value
//! is then the least residual of any train on the grid, from below. What it shares with the numerical shaper
//! is the idea; the grid, the modes and the solver are its own.

mod game;

use quell_shapers::{
    Candidate, Criterion, HUMP_TOLERANCE, Impulse, ImpulseTrain, Mode, Optimal, Requirements,
    SHAPERS, Shaper, Standing, UncertainMode, recommend, residual_vibration,
};
use std::f64::consts::TAU;
use std::time::Instant;

const TIMES: usize = 240;
const FREQUENCIES: usize = 61;
const RATIOS: usize = 5;
/// Damping ratios are known to this part of themselves.
const DAMPING_SPREAD: f64 = 0.5;

/// Modes over the box: angular frequency around 1, damping ratio from and to.
fn modes(spread: f64, (least, most): (f64, f64)) -> Vec<(f64, f64)> {
    let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    let ratios = if least == most { 1 } else { RATIOS };
    (0..FREQUENCIES)
        .flat_map(|i| (0..ratios).map(move |k| (i, k)))
        .map(|(i, k)| {
            let along = if ratios == 1 { 0.0 } else { share(k, ratios) };
            (
                1.0 + spread * (2.0 * share(i, FREQUENCIES) - 1.0),
                least + (most - least) * along,
            )
        })
        .collect()
}

/// Damping ratios around one.
fn ratios_around(damping_ratio: f64) -> (f64, f64) {
    let spread = DAMPING_SPREAD * damping_ratio;
    (damping_ratio - spread, damping_ratio + spread)
}

/// `exp(mu omega tau)`: real and imaginary part.
fn wave(mode: (f64, f64), tau: f64) -> (f64, f64) {
    let (omega, xi) = mode;
    let radius = (-xi * omega * tau).exp();
    let (sin, cos) = ((1.0 - xi * xi).sqrt() * omega * tau).sin_cos();
    (radius * cos, radius * sin)
}

fn worst(train: &ImpulseTrain, modes: &[(f64, f64)]) -> f64 {
    let residual = |mode: &(f64, f64)| residual_vibration(train, mode.0, mode.1);
    modes.iter().map(residual).fold(0.0, f64::max)
}

/// Size and phase of what a train leaves of each mode.
fn residuals(
    delay: f64,
    (times, amplitudes): (&[f64], &[f64]),
    modes: &[(f64, f64)],
) -> Vec<(f64, f64)> {
    let left = |&mode: &(f64, f64)| {
        let add = |sum: (f64, f64), (t, a): (&f64, &f64)| {
            let (re, im) = wave(mode, delay - t);
            (sum.0 + a * re, sum.1 + a * im)
        };
        let (re, im) = times.iter().zip(amplitudes).fold((0.0, 0.0), add);
        (re.hypot(im), im.atan2(re))
    };
    modes.iter().map(left).collect()
}

/// The least worst residual of any train of that delay, from below, and the train that reaches it.
fn optimum(delay: f64, modes: &[(f64, f64)]) -> Option<(f64, ImpulseTrain)> {
    let times: Vec<f64> = (0..=TIMES)
        .map(|j| delay * j as f64 / TIMES as f64)
        .collect();
    let payoff = |mode: (f64, f64), phase: f64| -> Vec<f64> {
        let (sin, cos) = phase.sin_cos();
        let pay = |t: &f64| {
            let (re, im) = wave(mode, delay - t);
            cos * re + sin * im
        };
        times.iter().map(pay).collect()
    };
    let mut rows: Vec<Vec<f64>> = (0..8)
        .map(|k| payoff(modes[0], k as f64 * TAU / 8.0))
        .collect();
    for _ in 0..200 {
        let (strategy, _, value) = game::solve(&rows);
        let residuals = residuals(delay, (&times, &strategy), modes);
        let largest = residuals.iter().map(|r| r.0).fold(0.0, f64::max);
        if largest <= value * 1.0005 + 1e-9 {
            let impulses: Vec<Impulse> = times
                .iter()
                .zip(&strategy)
                .filter(|(_, a)| **a > 1e-9)
                .map(|(&time, &amplitude)| Impulse { time, amplitude })
                .collect();
            return Some((value, ImpulseTrain::new(&impulses).ok()?));
        }
        let mut order: Vec<usize> = (0..modes.len()).collect();
        order.sort_by(|&a, &b| residuals[b].0.total_cmp(&residuals[a].0));
        let mut taken: Vec<usize> = Vec::new();
        for k in order {
            let apart = taken
                .iter()
                .all(|&t| (modes[t].0 - modes[k].0).abs() > 1e-3 || modes[t].1 != modes[k].1);
            if residuals[k].0 > value * 1.0002 && apart && taken.len() < 6 {
                rows.push(payoff(modes[k], residuals[k].1));
                taken.push(k);
            }
        }
    }
    None
}

/// The recommendation where 5 % are acceptable, of a table with or without the numerical shaper: its name, its
/// train.
fn recommended(known: &UncertainMode, with_optimal: bool) -> Option<(&'static str, ImpulseTrain)> {
    let wanted = |longest_delay: f64, acceptable: f64| Requirements {
        longest_delay,
        criterion: Criterion::Worst95,
        acceptable,
        tolerance: 0.0,
        allow_negative: false,
    };
    let found = recommend(&[*known], &wanted(f64::INFINITY, HUMP_TOLERANCE)).ok()?;
    let shapers = found
        .candidates
        .iter()
        .filter(|c| with_optimal || c.shaper.name() != "optimal");
    let good = |c: &&Candidate| {
        c.standing == Standing::Eligible && c.worst_95 <= HUMP_TOLERANCE * (1.0 + 1e-9)
    };
    let shortest = shapers.filter(good).min_by(|a, b| {
        let same = (a.delay - b.delay).abs() < 1e-9;
        if same {
            a.worst_95.total_cmp(&b.worst_95)
        } else {
            a.delay.total_cmp(&b.delay)
        }
    })?;
    Some((
        shortest.shaper.name(),
        shortest.shaper.design(known.mode).ok()?,
    ))
}

/// The numerical shaper's train, and the least time of a few runs, us.
fn solved(shaper: &Optimal, mode: Mode, delay: f64) -> Option<(ImpulseTrain, f64)> {
    let mut least = f64::INFINITY;
    let mut train = ImpulseTrain::identity();
    for _ in 0..10 {
        let start = Instant::now();
        train = shaper.within(mode, delay).ok()?.0;
        least = least.min(1e6 * start.elapsed().as_secs_f64());
    }
    Some((train, least))
}

/// One line of the table.
fn compare(spread: f64, damping_ratio: f64) -> Option<()> {
    let mode = Mode::new(1.0, damping_ratio).ok()?;
    let known = UncertainMode {
        mode,
        natural_frequency_std: 0.5 * spread,
        damping_ratio_std: 0.5 * DAMPING_SPREAD * damping_ratio,
    };
    let modes = modes(spread, ratios_around(damping_ratio));
    let (classic, train) = recommended(&known, false)?;
    let (best, better) = recommended(&known, true)?;
    let delay = train.duration();
    let (least, _) = optimum(delay, &modes)?;
    let shaper = Optimal {
        frequency_spread: spread,
        damping_spread: DAMPING_SPREAD,
    };
    let (numerical, time) = solved(&shaper, mode, delay)?;
    let [classic_left, best_left, left] =
        [&train, &better, &numerical].map(|train| worst(train, &modes));
    println!(
        "+-{:2.0} %, xi {damping_ratio:.2}: {classic:4} {:.2} periods, {:6.3} %; optimum {:6.3} %, ratio {:5.2}; \
         with optimal in the table: {best:7} {:6.3} %; solved for it: {:6.3} %, ratio {:.3}, {} impulses, {time:.0} us",
        100.0 * spread,
        delay / mode.damped_period(),
        100.0 * classic_left,
        100.0 * least,
        classic_left / least,
        100.0 * best_left,
        100.0 * left,
        left / least,
        numerical.impulses().len(),
    );
    Some(())
}

/// The largest ratio to the optimum within a number of periods: of the table's best, and of the numerical shaper.
fn by_delay(periods: f64) -> Option<()> {
    let (mut table, mut numerical, mut slowest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (spread, xi) in boxes() {
        let mode = Mode::new(1.0, xi).ok()?;
        let modes = modes(spread, ratios_around(xi));
        let delay = periods * mode.damped_period();
        let (least, _) = optimum(delay, &modes)?;
        let others = SHAPERS
            .iter()
            .filter(|s| s.is_convex() && s.name() != "optimal");
        let trains = others.filter_map(|shaper| shaper.design(mode).ok());
        let fitting = trains.filter(|train| train.duration() <= delay * (1.0 + 1e-9));
        let best = fitting
            .map(|train| worst(&train, &modes))
            .fold(f64::INFINITY, f64::min);
        let shaper = Optimal {
            frequency_spread: spread,
            damping_spread: DAMPING_SPREAD,
        };
        let (train, time) = solved(&shaper, mode, delay)?;
        slowest = slowest.max(time);
        // Below a ten-thousandth of the vibration it does not look any further.
        let floor = least.max(1e-4);
        table = table.max(best.max(1e-4) / floor);
        numerical = numerical.max(worst(&train, &modes).max(1e-4) / floor);
    }
    println!(
        "within {periods} periods: the table's best is up to {table:.2} times the optimum, the numerical shaper \
         {numerical:.3}, at most {slowest:.0} us"
    );
    Some(())
}

/// One line of the table of estimates: what [`Shaper::design_for`] makes of standard deviations of so much of the
/// frequency, and of so much damping ratio, as a decay tells both equally well.
fn for_estimate(deviation: f64, damping_ratio: f64) -> Option<()> {
    let known = UncertainMode {
        mode: Mode::new(1.0, damping_ratio).ok()?,
        natural_frequency_std: deviation,
        damping_ratio_std: deviation,
    };
    let least_ratio = (damping_ratio - 2.0 * deviation).max(0.0);
    let ratios = (least_ratio, damping_ratio + 2.0 * deviation);
    let modes = modes(2.0 * deviation, ratios);
    let mut time = f64::INFINITY;
    let mut train = ImpulseTrain::identity();
    for _ in 0..10 {
        let start = Instant::now();
        train = Optimal::TYPICAL.design_for(&known).ok()?;
        time = time.min(1e6 * start.elapsed().as_secs_f64());
    }
    let delay = train.duration();
    let (least, _) = optimum(delay, &modes)?;
    let left = worst(&train, &modes);
    println!(
        "deviations {:.1} %, xi {damping_ratio:.2}: {:.2} periods, {:6.3} %; optimum {:6.3} %, ratio {:.3}; {time:.0} us",
        100.0 * deviation,
        delay / known.mode.damped_period(),
        100.0 * left,
        100.0 * least,
        left / least,
    );
    Some(())
}

fn boxes() -> impl Iterator<Item = (f64, f64)> {
    let spreads = [0.05, 0.1, 0.15, 0.2, 0.25];
    spreads
        .into_iter()
        .flat_map(|spread| [0.0, 0.02, 0.05, 0.1, 0.2].map(|xi| (spread, xi)))
}

fn main() {
    for (spread, damping_ratio) in boxes() {
        if compare(spread, damping_ratio).is_none() {
            println!("+-{:.0} %, xi {damping_ratio}: not solved", 100.0 * spread);
        }
    }
    for deviation in [0.005, 0.01, 0.02, 0.04, 0.08] {
        for damping_ratio in [0.0, 0.02, 0.08, 0.2] {
            if for_estimate(deviation, damping_ratio).is_none() {
                println!("deviations {deviation}, xi {damping_ratio}: not solved");
            }
        }
    }
    for periods in [0.5, 1.0, 1.5, 2.0] {
        if by_delay(periods).is_none() {
            println!("{periods} periods: not solved");
        }
    }
}
