//! A recorded command in place of moves.

use super::{quell, residual, simulate};
use quell::recording::{Recording, Role};
use std::f64::consts::TAU;
use tempfile::TempDir;

#[test]
fn a_recorded_command_gives_the_same_measurements_again() {
    let folder = TempDir::new().unwrap();
    let planned = "--target 30 --target 0 --noise 0 --out planned";
    let planned = simulate(folder.path(), planned);
    let again = "--command planned --noise 0 --out again";
    let again = simulate(folder.path(), again);
    assert_eq!(
        again["remarks"].as_array().map(Vec::len),
        Some(0),
        "{again}"
    );
    // The same command as a CSV in deg, by rows a second instead of stamps.
    let command = Recording::from_path(folder.path().join("planned")).unwrap();
    let command = command.channel(Role::CommandPosition).unwrap();
    let rows = command.columns[0]
        .iter()
        .map(|rad| format!("{:?}\n", rad.to_degrees()));
    let csv = format!("axis\n{}", rows.collect::<String>());
    std::fs::write(folder.path().join("command.csv"), csv).unwrap();
    let csv = "--command command.csv --column axis --unit deg --rate 250 --noise 0 --out csv";
    let csv = simulate(folder.path(), csv);

    let read = |name: &str| Recording::from_path(folder.path().join(name)).unwrap();
    let tip = |recording: &Recording| {
        recording
            .channel(Role::TipPosition)
            .unwrap()
            .columns
            .clone()
    };
    let reference = tip(&read("planned"));
    for (name, document) in [("again", again), ("csv", csv)] {
        assert_eq!(document["moves"].as_array().map(Vec::len), Some(2));
        for leg in 0..2 {
            assert!((residual(&document, leg) - residual(&planned, leg)).abs() < 1e-3);
        }
        // Velocities of a command known by its positions only: of second order in the tick, less
        // than a tenth of the tracker's noise.
        for (seen, expected) in tip(&read(name)).iter().zip(&reference) {
            let worst = seen
                .iter()
                .zip(expected)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(worst < 1e-6, "{name}: {worst} m");
            assert_eq!(seen.len(), expected.len());
        }
    }
}

/// `A (1 - cos w t) / 2` for whole periods with rest on both sides: A w / 2, A w^2 / 2, A w^3 / 2
/// are its peaks of velocity, acceleration and jerk.
#[test]
fn limits_that_a_recorded_command_exceeds_are_told() {
    let folder = TempDir::new().unwrap();
    let wave = |k: i32| match f64::from(k - 250) / 1000.0 * 1.5 {
        t if (0.0..2.0).contains(&t) => 20.0 * (1.0 - (TAU * t).cos()),
        _ => 0.0,
    };
    let rows = (0..2000).map(|k| format!("{:?},{:?}\n", f64::from(k) * 1e-3, wave(k)));
    let csv = format!("time_s,q_deg\n{}", rows.collect::<String>());
    std::fs::write(folder.path().join("wave.csv"), csv).unwrap();
    let arguments = "--command wave.csv --column q_deg --unit deg";
    let document = simulate(folder.path(), arguments);
    let remarks = document["remarks"].as_array().unwrap();
    let w = TAU * 1.5;
    for (order, (name, limit)) in (1..).zip([
        ("velocity", 150.0),
        ("acceleration", 573.0),
        ("jerk", 4584.0),
    ]) {
        let remark = remarks
            .iter()
            .find(|text| text.as_str().unwrap().contains(name));
        let remark = remark
            .unwrap_or_else(|| panic!("no {name} in {remarks:?}"))
            .as_str()
            .unwrap();
        let told = remark
            .split("by ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next())
            .unwrap();
        let told: f64 = told.parse().unwrap();
        let expected = 100.0 * (20.0 * w.powi(order) / limit - 1.0);
        // The jumps of acceleration where the wave begins and ends are jerks without bound.
        let as_told = match name {
            "jerk" => told > expected,
            _ => (told - expected).abs() < 0.1,
        };
        assert!(as_told, "{remark}: expected {expected} %");
    }
    // Stopped dead in the middle of the second rise.
    let cut = std::fs::read_to_string(folder.path().join("wave.csv")).unwrap();
    let cut: Vec<&str> = cut.lines().take(1100).collect();
    std::fs::write(folder.path().join("cut.csv"), cut.join("\n")).unwrap();
    let arguments = "simulate --command cut.csv --column q_deg --unit deg";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let assert = quell(folder.path(), &arguments).assert().success();
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(text.contains("Note: the command ends in motion"), "{text}");
}
