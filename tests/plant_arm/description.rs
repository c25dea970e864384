//! Robot descriptions that are refused.

use quell::plant::Robot;
use std::path::Path;

#[test]
fn bad_descriptions_are_refused_with_file_key_and_value() {
    let good = include_str!("../../crates/simulation/src/plant/rx170.toml");
    for (from, to, says) in [
        (
            "damping_ratio = 0.084",
            "damping_ratio = 1.2",
            "joint[1].mode[1].damping_ratio = 1.2",
        ),
        (
            "frequency_hz = 8.12",
            "frequency_hz = -8.12",
            "joint[1].mode[1].frequency_hz = -8.12",
        ),
        (
            "bandwidth_hz = 30.0",
            "bandwidth_hz = nan",
            "servo.bandwidth_hz = NaN",
        ),
        ("joint = 1", "joint = 7", "move.joint = 7"),
        ("rate_hz = 333.0", "rate_hz = 0.0", "tracker.rate_hz = 0"),
        (
            "mass_kg = 75.0",
            "mass_kg = -75.0",
            "joint[1].link.mass_kg = -75",
        ),
        ("\"across_joint\"", "\"somewhere\"", "somewhere"),
        ("noise_um", "noise_nm", "noise_nm"),
        (
            "jerk_deg_s3 = 4584.0 }\nmode",
            "jerk_deg_s3 = 0.0 }\nmode",
            "joint[1].limits.jerk_deg_s3",
        ),
        (
            "position_m = [0.0, 0.0, 0.22]",
            "position_m = [0.0, 0.0, 0.0, 0.0]",
            "tool.position_m = [0.0, 0.0, 0.0, 0.0]: it must be a list of 3 numbers",
        ),
    ] {
        assert!(good.contains(from), "{from}");
        let text = good.replacen(from, to, 1);
        let error = Robot::from_toml(&text, Path::new("my.toml"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("my.toml") && error.contains(says), "{error}");
    }
    let missing = Robot::from_file(Path::new("nowhere/none.toml"))
        .unwrap_err()
        .to_string();
    assert!(missing.contains("nowhere/none.toml"), "{missing}");
}
