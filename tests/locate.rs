//! Locating a mismatch: residuals with a known cause, made here by integrating a forced oscillator.

use std::f64::consts::{PI, TAU};

use quell::diagnosis::{Dynamics, Located, Residual, locate};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const SIGMA: f64 = 1e-5;
const W: f64 = TAU * 8.0;
const XI: f64 = 0.05;
const PERIOD: f64 = 0.003;
/// Integration steps for one sample.
const FINE: usize = 8;

/// Motion of motor side and link at the samples.
struct Moves {
    time: Vec<f64>,
    motor: Vec<[f64; 3]>,
    link: Vec<[f64; 3]>,
}

/// Moves back and forth: speed up over 0.15 s, cruise, slow down, wait; accelerations are half sines.
fn motor(t: f64) -> [f64; 3] {
    const RAMP: f64 = 0.15;
    // Peak speed, time of cruise, when it starts.
    let moves = [
        (0.9, 0.30, 0.5),
        (-0.6, 0.20, 2.2),
        (0.4, 0.55, 3.6),
        (-1.0, 0.25, 5.1),
        (1.2, 0.40, 6.2),
        (-0.5, 0.80, 8.0),
        (-0.7, 0.20, 10.0),
        (0.8, 0.50, 11.4),
    ];
    let ramp = |t: f64, v: f64| {
        let (t, late) = (t.clamp(0.0, RAMP), (t - RAMP).max(0.0));
        let p = PI / RAMP;
        let inside = if late > 0.0 { 0.0 } else { 1.0 };
        [
            0.5 * v * (t - (p * t).sin() / p) + v * late,
            0.5 * v * (1.0 - (p * t).cos()),
            inside * 0.5 * v * p * (p * t).sin(),
        ]
    };
    let mut sum = [0.0; 3];
    for (v, cruise, start) in moves {
        for (sign, begin) in [(1.0, start), (-1.0, start + RAMP + cruise)] {
            let part = ramp(t - begin, sign * v);
            (0..3).for_each(|i| sum[i] += part[i]);
        }
    }
    sum
}

/// Runs `x'' = f(t, x, x')` by Runge-Kutta from rest; states at the samples.
fn integrate(count: usize, f: impl Fn(f64, [f64; 2]) -> f64) -> Vec<[f64; 3]> {
    let h = PERIOD / FINE as f64;
    let rate = |t: f64, x: [f64; 2]| [x[1], f(t, x)];
    let add = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let mut x = [0.0; 2];
    let mut samples = Vec::with_capacity(count);
    for step in 0..count * FINE {
        let t = step as f64 * h;
        let k1 = rate(t, x);
        if step % FINE == 0 {
            samples.push([x[0], x[1], k1[1]]);
        }
        let k2 = rate(t + 0.5 * h, add(x, k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, add(x, k2, 0.5 * h));
        let k4 = rate(t + h, add(x, k3, h));
        for i in 0..2 {
            x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    samples
}

/// Deformation of a joint of this mode with an extra acceleration `d(t, deformation, rate)`.
fn deformation(w: f64, xi: f64, d: impl Fn(f64, [f64; 2]) -> f64) -> Vec<[f64; 3]> {
    integrate(4400, |t, x| {
        -motor(t)[2] - 2.0 * xi * w * x[1] - w * w * x[0] + d(t, x)
    })
}

fn moves() -> Moves {
    let time: Vec<f64> = (0..4400).map(|k| PERIOD * k as f64).collect();
    let motor: Vec<[f64; 3]> = time.iter().map(|&t| motor(t)).collect();
    let bent = deformation(W, XI, |_, _| 0.0);
    let link = motor
        .iter()
        .zip(&bent)
        .map(|(m, d)| [0, 1, 2].map(|i| m[i] + d[i]))
        .collect();
    Moves { time, motor, link }
}

fn noise(seed: u64, count: usize, correlation: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut state = 0.0;
    let fresh = (1.0 - correlation * correlation).sqrt();
    (0..count)
        .map(|_| {
            let white: f64 = StandardNormal.sample(&mut random);
            state = correlation * state + fresh * white;
            SIGMA * state
        })
        .collect()
}

/// Takes from a residual what a refit of frequency, damping, output offset and clock would.
fn refitted(moves: &Moves, mut residual: Vec<f64>) -> Vec<f64> {
    let nominal = deformation(W, XI, |_, _| 0.0);
    let changed = |w: f64, xi: f64| -> Vec<f64> {
        let other = deformation(w, xi, |_, _| 0.0);
        other
            .iter()
            .zip(&nominal)
            .map(|(a, b)| a[0] - b[0])
            .collect()
    };
    let mut columns = vec![
        changed(1.001 * W, XI),
        changed(W, 1.01 * XI),
        vec![1.0; residual.len()],
        moves.link.iter().map(|l| l[1]).collect(),
    ];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for c in 0..columns.len() {
        let direction = columns[c].clone();
        let take = |series: &mut Vec<f64>| {
            let factor = dot(series, &direction) / dot(&direction, &direction);
            series
                .iter_mut()
                .zip(&direction)
                .for_each(|(s, d)| *s -= factor * d);
        };
        take(&mut residual);
        columns[c + 1..].iter_mut().for_each(take);
    }
    residual
}

fn located(moves: &Moves, residual: &[f64]) -> Located {
    locate(&Residual {
        time: &moves.time,
        residual,
        noise_std: SIGMA,
        motor: &moves.motor,
        link: &moves.link,
        dynamics: Dynamics {
            natural_frequency: W,
            damping_ratio: XI,
        },
        sensor_only: false,
    })
}

/// The residual of a joint with this extra acceleration against the one without, refitted, in noise.
fn missing(moves: &Moves, seed: u64, d: impl Fn(f64, [f64; 2]) -> f64) -> Vec<f64> {
    let with = deformation(W, XI, d);
    let without = deformation(W, XI, |_, _| 0.0);
    let clean = with.iter().zip(&without).map(|(a, b)| a[0] - b[0]);
    let noise = noise(seed, with.len(), 0.0);
    refitted(moves, clean.zip(noise).map(|(c, n)| c + n).collect())
}

fn show(name: &str, l: &Located) {
    println!(
        "{name}: {:?} coordinate {:?} phases {:?} f {:?}\n  gains {:.0} {:.0}\n  explained {:?}\n  shares {:?}\n  suspects {:?} f {:?} orders {:?} times {:?}",
        l.location.place,
        l.location.coordinate,
        l.location.phases,
        l.location.frequency_hz,
        l.dynamic_gain,
        l.sensor_gain,
        l.explained
            .iter()
            .map(|(n, e)| format!("{n} {e:.2}"))
            .collect::<Vec<_>>(),
        l.phases
            .iter()
            .map(|(n, e)| format!("{n} {e:.2}"))
            .collect::<Vec<_>>(),
        l.suspects,
        l.suspect_frequencies
            .iter()
            .map(|f| f / TAU)
            .collect::<Vec<_>>(),
        l.suspect_orders,
        l.location.times_s
    );
}

#[test]
fn explore() {
    let m = moves();
    let size = W * W * 1e-3;
    let start = std::time::Instant::now();
    let r = missing(&m, 1, |_, x| -0.1 * size * (x[1] / 1e-4).tanh());
    println!("made {:?}", start.elapsed());
    let start = std::time::Instant::now();
    let l = located(&m, &r);
    println!("located {:?}", start.elapsed());
    show("coulomb", &l);
    show(
        "cubic",
        &located(
            &m,
            &missing(&m, 2, |_, x| -0.3 * W * W * x[0].powi(3) / 9e-6),
        ),
    );
    show(
        "ripple",
        &located(
            &m,
            &missing(&m, 3, |t, _| 0.05 * size * (43.0 * motor(t)[0]).sin()),
        ),
    );
    show(
        "knock",
        &located(
            &m,
            &missing(&m, 4, |t, _| {
                if (t - 7.3).abs() < 0.005 {
                    2.0 * size
                } else {
                    0.0
                }
            }),
        ),
    );
    show(
        "force onset",
        &located(
            &m,
            &missing(&m, 5, |t, _| if t > 6.0 { 0.1 * size } else { 0.0 }),
        ),
    );
    show(
        "payload",
        &located(
            &m,
            &missing(&m, 6, |t, x| {
                if t > 6.0 {
                    -0.1 * (-2.0 * XI * W * x[1] - W * W * x[0])
                } else {
                    0.0
                }
            }),
        ),
    );
    show(
        "quadratic drag",
        &located(
            &m,
            &missing(&m, 7, |t, x| {
                let v = motor(t)[1] + x[1];
                -0.1 * size * v * v.abs()
            }),
        ),
    );
    show(
        "gravity",
        &located(&m, &missing(&m, 8, |t, _| 0.1 * size * motor(t)[0].sin())),
    );
    let second = integrate(4400, |t, x| {
        -motor(t)[2] - 0.04 * TAU * 24.0 * x[1] - (TAU * 24.0).powi(2) * x[0]
    });
    let noisy = |seed: u64, f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let n = noise(seed, 4400, 0.0);
        refitted(&m, (0..4400).map(|k| f(k) + n[k]).collect())
    };
    show(
        "second mode",
        &located(&m, &noisy(9, &|k| 0.3 * second[k][0])),
    );
    show(
        "skew",
        &located(&m, &noisy(10, &|k| 2e-5 * m.time[k] * m.link[k][1])),
    );
    show(
        "lag",
        &located(
            &m,
            &noisy(11, &|k| -0.005 * m.link[k][1] + 2.5e-5 * m.link[k][2]),
        ),
    );
    show(
        "sensor gain",
        &located(&m, &noisy(12, &|k| 0.001 * m.link[k][0])),
    );
    let mut hits = [0; 2];
    for seed in 0..100 {
        for (i, c) in [0.0, 0.8].into_iter().enumerate() {
            let l = located(&m, &refitted(&m, noise(1000 + seed, 4400, c)));
            if l.location.place.is_none()
                && l.suspects.is_empty()
                && l.suspect_frequencies.is_empty()
                && l.suspect_orders.is_empty()
            {
                hits[i] += 1;
            } else {
                show(&format!("noise {c} {seed}"), &l)
            }
        }
    }
    println!("nothing in white, AR(1): {hits:?}");
}
