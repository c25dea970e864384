//! Printers of known modes: how near `identify` comes to them, and what its shaper leaves beside Klipper's.
//!
//! `cargo bench --bench printers -- [COUNT] [--klipper KLIPPY]` makes COUNT printers (200) of one or two modes, each
//! recorded as Klipper records: pulses of 5 to 133 Hz, 3200 samples a second, noise and rounding of an ADXL345. The
//! toolhead is integrated in time, piece by piece in closed form; the fit works in frequency. With the folder `klippy` of
//! Klipper, and Python with NumPy, its own calibration is run beside on the same samples (benches/peers/klipper.py).

use quell::identification::output_only::{FoundMode, output_only, vibration};
use quell::identification::printer::{best, settings, smoothing, within};
use quell::recording::{Channel, Recording, Role};
use quell_shapers::{Impulse, ImpulseTrain, residual_vibration};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::TAU;
use std::io::Write;
use std::process::Command;
use std::time::Instant;

const RATE: f64 = 3200.0;
/// Noise, mm/s^2, and step of the sensor.
const NOISE: f64 = 60.0;
const STEP: f64 = 38.3;

/// Natural frequency, Hz, damping ratio, and share in the toolhead's motion.
type Truth = [f64; 3];

/// Instants, s, and accelerations, mm/s^2, of Klipper's test of resonances.
fn pulses() -> Vec<[f64; 2]> {
    let (mut time, mut frequency, mut sign, mut all) = (0.0, 5.0, 1.0, Vec::new());
    while frequency < 133.0 {
        let quarter = 0.25 / frequency;
        all.push([time, sign * 75.0 * frequency]);
        all.push([time + quarter, -sign * 75.0 * frequency]);
        time += 2.0 * quarter;
        frequency += 2.0 * quarter;
        sign = -sign;
    }
    all.push([time, 0.0]);
    all
}

/// Acceleration of the toolhead. A mode's own motion relative to the carriage obeys `x'' + 2 xi w x' + w^2 x = -a`; over a
/// piece of constant `a` it has a closed form.
fn toolhead(modes: &[Truth], samples: usize) -> Vec<f64> {
    let pulses = pulses();
    let mut total = vec![0.0; samples];
    for [hertz, xi, share] in modes {
        let w = TAU * hertz;
        let wd = w * (1.0 - xi * xi).sqrt();
        let (mut x, mut v, mut next, mut a, mut now) = (0.0, 0.0, 0, 0.0, 0.0);
        for (k, value) in total.iter_mut().enumerate() {
            let until = k as f64 / RATE;
            loop {
                let ends = pulses.get(next).map_or(f64::INFINITY, |pulse| pulse[0]);
                let to = until.min(ends);
                let (rest, dt) = (-a / (w * w), to - now);
                let (sine, cosine) = (wd * dt).sin_cos();
                let decay = (-xi * w * dt).exp();
                let (from, slope) = (x - rest, v);
                let other = (slope + xi * w * from) / wd;
                x = rest + decay * (from * cosine + other * sine);
                v = decay * (slope * cosine - (w * w * from + xi * w * slope) / wd * sine);
                now = to;
                if ends > until {
                    break;
                }
                a = pulses[next][1];
                next += 1;
            }
            // x'' + a, the acceleration over ground.
            *value += share * (-2.0 * xi * w * v - w * w * x);
        }
    }
    total
}

struct Row {
    frequency: f64,
    damping: f64,
    found: usize,
    modes: usize,
    /// What is left of the truth with the recommended shaper, with the best at Klipper's smoothing, and with Klipper's.
    left: [f64; 3],
    seconds: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let count = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(200);
    let klipper = arguments
        .iter()
        .position(|a| a == "--klipper")
        .and_then(|at| arguments.get(at + 1));
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let rows: Vec<Row> = (0..count)
        .map(|_| one(&mut rng, klipper.map(String::as_str)))
        .collect();
    report(&rows, klipper.is_some());
}

fn one(rng: &mut ChaCha8Rng, klipper: Option<&str>) -> Row {
    let mut modes = vec![[
        rng.random_range(25.0..90.0),
        rng.random_range(0.02..0.12),
        1.0,
    ]];
    if rng.random_bool(0.5) {
        let share = rng.random_range(0.2..0.5);
        let above: f64 = modes[0][0] * rng.random_range(1.25_f64..2.0);
        modes[0][2] = 1.0 - share;
        modes.push([above.min(120.0), rng.random_range(0.02..0.12), share]);
    }
    let samples = ((pulses().last().map_or(0.0, |p| p[0]) + 1.0) * RATE) as usize;
    let noise = Normal::new(0.0, NOISE).expect("a standard deviation above 0");
    let mut sensor = |values: Vec<f64>| -> Vec<f64> {
        let read = |value: f64| ((value + noise.sample(rng)) / STEP).round() * STEP;
        values.into_iter().map(read).collect()
    };
    let axes = [
        toolhead(&modes, samples),
        vec![0.0; samples],
        vec![9806.0; samples],
    ]
    .map(&mut sensor);
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / RATE).collect();
    let theirs = klipper.and_then(|klippy| calibrate(klippy, &time, &axes));
    let columns = axes
        .iter()
        .map(|axis| axis.iter().map(|v| v / 1e3).collect())
        .collect();
    let (role, unit) = (Role::TipAcceleration, "m/s^2".into());
    let channel = Channel {
        role,
        unit,
        time,
        columns,
    };
    let recording = Recording {
        name: "printer".into(),
        payload: None,
        channels: vec![channel],
    };
    let begun = Instant::now();
    let found = vibration(&recording)
        .and_then(|v| output_only(&v))
        .map_or(Vec::new(), |found| found.modes);
    let seconds = begun.elapsed().as_secs_f64();
    let (frequency, damping) = errors(&modes, &found);
    Row {
        frequency,
        damping,
        found: found.len(),
        modes: modes.len(),
        left: left(&modes, &found, theirs),
        seconds,
    }
}

/// The worst relative errors of frequency and damping ratio; infinite where a mode is missed.
fn errors(modes: &[Truth], found: &[FoundMode]) -> (f64, f64) {
    let mut worst = (0.0_f64, 0.0_f64);
    for [hertz, xi, _] in modes {
        let off = |mode: &&FoundMode| (mode.known.mode.hertz() / hertz - 1.0).abs();
        let nearest = found.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(mode) = nearest else {
            return (f64::INFINITY, f64::INFINITY);
        };
        worst.0 = worst.0.max(off(&mode));
        worst.1 = worst
            .1
            .max((mode.known.mode.damping_ratio() / xi - 1.0).abs());
    }
    worst
}

/// The sum of what a train leaves of each true mode, by their shares.
fn truly_left(modes: &[Truth], train: &ImpulseTrain) -> f64 {
    modes
        .iter()
        .map(|[hertz, xi, share]| share * residual_vibration(train, TAU * hertz, *xi))
        .sum()
}

fn left(modes: &[Truth], found: &[FoundMode], theirs: Option<ImpulseTrain>) -> [f64; 3] {
    let recordings = [found.to_vec()];
    let settings = settings(&recordings).unwrap_or_default();
    let own = best(settings.iter(), 0.05).map_or(1.0, |one| truly_left(modes, &one.train));
    let Some(theirs) = theirs else {
        return [own, f64::NAN, f64::NAN];
    };
    let equal = within(&recordings, smoothing(&theirs, 5000.0, 5.0))
        .ok()
        .flatten();
    let equal = equal.map_or(1.0, |one| truly_left(modes, &one.train));
    [own, equal, truly_left(modes, &theirs)]
}

/// The impulses that Klipper's calibration recommends.
fn calibrate(klippy: &str, time: &[f64], axes: &[Vec<f64>; 3]) -> Option<ImpulseTrain> {
    let file = tempfile::NamedTempFile::new().ok()?;
    let mut out = std::io::BufWriter::new(file.as_file());
    writeln!(out, "#time,accel_x,accel_y,accel_z").ok()?;
    for (k, t) in time.iter().enumerate() {
        writeln!(
            out,
            "{t:.6},{:.3},{:.3},{:.3}",
            axes[0][k], axes[1][k], axes[2][k]
        )
        .ok()?;
    }
    out.flush().ok()?;
    let python = std::env::var("PYTHON").unwrap_or("python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/klipper.py");
    let run = Command::new(python)
        .arg(script)
        .arg(klippy)
        .arg(file.path())
        .output()
        .ok()?;
    if !run.status.success() {
        eprintln!("{}", String::from_utf8_lossy(&run.stderr));
        return None;
    }
    let text = String::from_utf8(run.stdout).ok()?;
    let pairs = text.lines().filter_map(|line| line.split_once(' '));
    let impulse = |(time, amplitude): (&str, &str)| {
        Some(Impulse {
            time: time.parse().ok()?,
            amplitude: amplitude.parse().ok()?,
        })
    };
    let mut impulses: Vec<Impulse> = pairs.map(impulse).collect::<Option<_>>()?;
    let sum: f64 = impulses.iter().map(|i| i.amplitude).sum();
    impulses.iter_mut().for_each(|i| i.amplitude /= sum);
    ImpulseTrain::new(&impulses).ok()
}

fn report(rows: &[Row], beside: bool) {
    let quantile = |of: &dyn Fn(&Row) -> f64, share: f64| {
        let mut all: Vec<f64> = rows.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all[(share * (all.len() - 1) as f64).round() as usize]
    };
    println!(
        "{} printers, {} of them of two modes",
        rows.len(),
        rows.iter().filter(|row| row.modes > 1).count()
    );
    let line = |name: &str, of: &dyn Fn(&Row) -> f64, unit: &str| {
        let [half, most, all] = [0.5, 0.95, 1.0].map(|share| quantile(of, share));
        println!("{name:34} {half:9.3} {most:9.3} {all:9.3} {unit}");
    };
    println!("{:34} {:>9} {:>9} {:>9}", "", "median", "95 %", "worst");
    line("error of frequency", &|row| 100.0 * row.frequency, "%");
    line("error of damping ratio", &|row| 100.0 * row.damping, "%");
    line(
        "left by the recommended shaper",
        &|row| 100.0 * row.left[0],
        "%",
    );
    if beside {
        line(
            "left at Klipper's smoothing",
            &|row| 100.0 * row.left[1],
            "%",
        );
        line("left by Klipper's shaper", &|row| 100.0 * row.left[2], "%");
    }
    line("time of the fit", &|row| row.seconds, "s");
    let good = rows
        .iter()
        .filter(|row| row.frequency < 0.01 && row.damping < 0.15)
        .count();
    let more = rows.iter().filter(|row| row.found > row.modes).count();
    println!("{good} within 1 % and 15 %; {more} with a mode that is not there");
}
