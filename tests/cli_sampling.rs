//! What sampling does to a vibration: modes above the range, images, counters that begin again, rounding.

mod verb;

use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use tempfile::TempDir;
use verb::{has, quell};

/// Steps of the simulation a second.
const STEPS: f64 = 50_000.0;

/// A joint that goes forth and back by 1 within 0.1 s, with rests of 0.9 s: instants, motor side and link.
fn joint(rate: f64, (hertz, ratio): (f64, f64), duration: f64, seconds: f64) -> Vec<[f64; 3]> {
    let w = TAU * hertz;
    let acceleration = |t: f64| {
        let (k, sign) = (t % 1.0 - 0.3, if t % 2.0 < 1.0 { 1.0 } else { -1.0 });
        match (0.0..duration).contains(&k) {
            true => sign * TAU / duration.powi(2) * (TAU * k / duration).sin(),
            false => 0.0,
        }
    };
    let (every, h) = ((STEPS / rate) as usize, 1.0 / STEPS);
    let mut state = [0.0_f64; 4];
    let mut out = Vec::new();
    for k in 0..(seconds * STEPS) as usize {
        let t = k as f64 * h;
        if k % every == 0 {
            out.push([t, state[0], state[0] + state[2]]);
        }
        let slope =
            |s: [f64; 4], a: f64| [s[1], a, s[3], -w * w * s[2] - 2.0 * ratio * w * s[3] - a];
        let first = slope(state, acceleration(t));
        let middle = core::array::from_fn(|i| state[i] + 0.5 * h * first[i]);
        let second = slope(middle, acceleration(t + 0.5 * h));
        state = core::array::from_fn(|i| state[i] + h * second[i]);
    }
    out
}

/// A repeatable disturbance of -1 to 1.
fn noise(k: usize) -> f64 {
    let mixed = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 40) as f64 / f64::from(1 << 23) - 1.0
}

fn written(head: &str, rows: impl Iterator<Item = String>) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = format!("{head}\n");
    for row in rows {
        writeln!(text, "{row}").unwrap();
    }
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    folder
}

#[test]
fn a_mode_above_the_searched_range_is_told_with_its_frequency() {
    for (mode, words) in [
        ((26.0, 0.01), "rings at 26.0 Hz"),
        // Its image at 100 samples a second.
        ((72.0, 0.005), "72.0 Hz looks the same"),
    ] {
        let rows = joint(100.0, mode, 0.05, 20.0).into_iter().enumerate();
        let row = |(k, [t, u, y]): (usize, [f64; 3])| {
            format!(
                "{t:.2},{:.6},{:.6}",
                0.01 * u + 1e-5 * noise(k),
                0.01 * y + 1e-5 * noise(k + 9999)
            )
        };
        let folder = written("time_s,motor_rad,link_rad", rows.map(row));
        let (told, error) = quell(&folder, &["identify", "run.csv"]);
        has(
            &error,
            &[
                "no mode was found from 0.1",
                "to 20.0 Hz that explains the motion",
                words,
            ],
        );
        assert!(told.is_empty(), "{told}");
    }
}

#[test]
fn a_fast_mode_of_an_accelerometer_alone_may_be_an_image() {
    let decay = |hertz: f64, t: f64| {
        let w = TAU * hertz;
        (-0.004 * w * t).exp() * (w * t).sin() + 1e-3 * noise((1e4 * t) as usize)
    };
    for (hertz, words) in [
        (63.0, "37.00 Hz may be 63.00 Hz, or 137.00 or 163.00 Hz"),
        (8.0, ""),
    ] {
        let row = |k: u32| {
            format!(
                "{:.2},{:.5}",
                f64::from(k) / 100.0,
                decay(hertz, f64::from(k) / 100.0)
            )
        };
        let folder = written("time_s,acc_g", (0..1500).map(row));
        let told = quell(&folder, &["identify", "run.csv"]).0;
        has(&told, &[words, "Recommended"]);
        assert_eq!(told.contains("may be"), !words.is_empty(), "{told}");
    }
}

#[test]
fn a_counter_that_begins_again_is_told_and_read_without_its_jumps() {
    let mode = (5.5, 0.03);
    for (bits, begins, size) in [
        (16, -32768.0, 50_000.0),
        (16, 0.0, 50_000.0),
        (12, 0.0, 3_000.0),
    ] {
        let period = 2_f64.powi(bits);
        let read = |value: f64| {
            ((size * value).round() + 0.7 * period - begins)
                .floor()
                .rem_euclid(period)
                + begins
        };
        let rows = joint(500.0, mode, 0.3, 10.0).into_iter();
        let folder = written(
            "time_s,motor_counts,link_counts",
            rows.map(|[t, u, y]| format!("{t:.3},{},{}", read(u), read(y))),
        );
        // It is not taken out silently.
        let (_, error) = quell(&folder, &["identify", "run.csv"]);
        has(&error, &[&format!("begins again at {period}")]);
        let told = quell(&folder, &["inspect", "run.csv"]).0;
        has(&told, &["begins again at", "it jumps by that"]);
        let path = folder.path().join("recording.toml");
        let manifest = std::fs::read_to_string(&path).unwrap();
        has(&manifest, &[&format!("wrap = {period}  # guessed")]);
        let told = quell(&folder, &["identify", "--json", "recording.toml"]).0;
        let told: Value = serde_json::from_str(&told).unwrap();
        let [hertz, ratio] = ["frequency_hz", "damping_ratio"]
            .map(|key| told["recommended"]["modes"][0][key].as_f64().unwrap());
        assert!(
            (hertz / mode.0 - 1.0).abs() < 1e-3 && (ratio / mode.1 - 1.0).abs() < 0.02,
            "{hertz}, {ratio}"
        );
        // A manifest that does not say it is refused with what to write.
        let without = manifest.replace("wrap = ", "# ");
        std::fs::write(&path, without).unwrap();
        for verb in ["identify", "inspect"] {
            let (told, error) = quell(&folder, &[verb, "recording.toml", "--json"]);
            has(
                &(told + &error),
                &[&format!("write wrap = {period} in its [[channel]]")],
            );
        }
        let broken = manifest.replacen(&format!("wrap = {period}"), "wrap = -1.0", 1);
        std::fs::write(&path, broken).unwrap();
        has(
            &quell(&folder, &["inspect", "recording.toml"]).1,
            &["wrap", "-1 is not above 0"],
        );
    }
}

/// Without a manifest nobody else would say that stamps are read in another way than they stand there.
#[test]
fn a_counter_of_time_that_begins_again_is_told_without_a_manifest() {
    let row = |k: usize| {
        let (t, w) = (k as f64 / 500.0, TAU * 5.5);
        let rings = if t < 1.0 {
            0.0
        } else {
            (-0.03 * w * (t - 1.0)).exp() * (w * (t - 1.0)).cos()
        };
        let count = ((1_u64 << 32) - 3_000_000 + 2_000 * k as u64) % (1 << 32);
        format!("{count},{:.6}", rings + 0.003 * noise(k))
    };
    let folder = written("time_us,accel_x_g", (0..4_000).map(row));
    let (told, error) = quell(&folder, &["identify", "run.csv"]);
    has(&told, &["Recommended"]);
    has(
        &error,
        &["run.csv: \"time_us\" is read with time_wrap = 4294967296: the time falls by that once"],
    );
    // A manifest says it, and so does `inspect`.
    quell(&folder, &["inspect", "run.csv"]);
    assert_eq!(quell(&folder, &["identify", "recording.toml"]).1, "");
}

#[test]
fn noise_below_the_rounding_is_called_rounding() {
    let rows = joint(500.0, (5.5, 0.03), 0.3, 6.0).into_iter();
    let folder = written(
        "time_s,motor_rad,link_rad",
        rows.map(|[t, u, y]| format!("{t:.3},{:.3},{:.3}", 2.0 * u, 2.0 * y)),
    );
    let told = quell(&folder, &["inspect", "run.csv"]).0;
    let lines = told
        .lines()
        .filter(|line| line.contains("rounding") && line.contains("0.001"));
    assert_eq!(lines.count(), 2, "{told}");
}

#[test]
fn a_move_within_one_sample_does_not_make_a_mode_of_an_image() {
    // At 100 samples a second 80 Hz looks like 20 Hz, 82 Hz like 18 Hz and 88 Hz like 12 Hz.
    for hertz in [80.0, 82.0, 88.0] {
        let rows = joint(100.0, (hertz, 0.005), 0.01, 12.0).into_iter();
        let row = |(k, [t, u, y]): (usize, [f64; 3])| {
            format!(
                "{t:.2},{:.6},{:.6}",
                0.01 * u + 1e-5 * noise(k),
                0.01 * y + 1e-5 * noise(k + 9999)
            )
        };
        let folder = written("time_s,motor_rad,link_rad", rows.enumerate().map(row));
        let (told, error) = quell(&folder, &["identify", "run.csv"]);
        let image = format!("the link rings at {:.1} Hz", 100.0 - hertz);
        let mode = format!("{hertz:.1} Hz looks the same");
        has(&error, &[&image, &mode, "above half the rate"]);
        assert!(told.is_empty(), "{told}");
        let needed = error.split("record with ").nth(1).unwrap();
        let needed: f64 = needed.split(' ').next().unwrap().parse().unwrap();
        assert!((needed / (5.0 * hertz) - 1.0).abs() < 0.01, "{error}");
    }
    // A slow mode after such a move is known.
    let rows = joint(100.0, (12.0, 0.005), 0.01, 12.0).into_iter();
    let folder = written(
        "time_s,motor_rad,link_rad",
        rows.map(|[t, u, y]| format!("{t:.2},{u:.6},{y:.6}")),
    );
    let told = quell(&folder, &["identify", "run.csv"]).0;
    has(&told, &["Recommended: 12.0"]);
}
