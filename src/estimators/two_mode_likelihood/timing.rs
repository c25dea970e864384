//! What the parts of a tick take, of which the budgets are made:
//! `cargo test --release --lib two_mode_likelihood::timing -- --ignored --nocapture`.

use super::fit::{Priors, fit, profile};
use super::grid::{Grid, MODES};
use super::pair::Pair;
use crate::estimators::Sample;
use crate::estimators::likelihood::Window;
use quell_shapers::Mode;
use std::hint::black_box;
use std::time::Instant;

const SAMPLES: usize = 1000;
const VARIANCE: f64 = 1e-10;

/// Least of 300 times, ns: what the work takes where nothing comes between.
fn least<T>(mut run: impl FnMut() -> T) -> f64 {
    let times = (0..300).map(|_| {
        let begin = Instant::now();
        black_box(run());
        1e9 * begin.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

/// Two modes in motion at 250 Hz.
fn window() -> Window {
    let mut window = Window::with_capacity(SAMPLES);
    for k in 0..SAMPLES {
        let time = 0.004 * k as f64;
        window.push(Sample {
            time,
            motor_position: 0.1 * (1.7 * time).sin(),
            deformation: 1e-3 * (50.0 * time).cos() + 5e-4 * (69.0 * time).cos(),
        });
    }
    window
}

#[test]
#[ignore = "prints times and asserts nothing"]
fn what_a_solution_takes_in_samples() {
    let modes = [8.0, 11.0].map(|hertz| Mode::from_hertz(hertz, 0.03).unwrap());
    let window = window();
    let priors = Priors {
        mean: [50f64.ln(), 0.03],
        precision: [1.0; 14],
    };
    let walked = |weights| {
        let mut pair = Pair::new(modes, 0.004);
        pair.weights = weights;
        for _ in 0..SAMPLES {
            pair.absorb(&window);
        }
        pair
    };
    let pair = walked(None);
    let fitted = || fit(black_box(&pair), &priors, VARIANCE, &[0.0; 4]);
    let weights = fitted().map(|fit| fit.residual);
    let sample = least(|| walked(weights)) / SAMPLES as f64;
    let solved = least(fitted);
    let profiled = least(|| profile(black_box(&pair), &priors, VARIANCE));
    // A budget of one takes one sample a call, or one pair.
    let mut grid = Grid::new(modes[0], 0.004);
    let mut advance = |calls: usize| {
        grid.begin(modes[0], 0.004);
        for _ in 0..calls {
            grid.advance(&window, &priors, VARIANCE, &mut 1);
        }
    };
    let pairs = MODES * (MODES - 1) / 2;
    let walk = least(|| advance(SAMPLES));
    let of_a_pair = (least(|| advance(SAMPLES + pairs)) - walk) / pairs as f64;
    println!(
        "a sample of a pair {sample:.0} ns; in such: a fit {:.1}, a profile {:.1}, a sample of the grid {:.1}, a pair of it {:.1}",
        solved / sample,
        profiled / sample,
        walk / SAMPLES as f64 / sample,
        of_a_pair / sample,
    );
}
