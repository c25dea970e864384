//! The service as a process against a robot that is another one: `tests/robots/udp_arm.py`, over UDP
//! at 1 kHz with a clock of its own, jitter, and 2 % loss both ways. Twelve moves here, of which only that is judged
//! which no busy machine can change; the same command makes two hundred, and judges what they leave. `tests/station`
//! judges that on a simulated clock.

#[path = "absent/skipped.rs"]
mod skipped;

use skipped::skipped;
use std::process::Command;

/// Runs the campaign; skipped, with a word, where there is no Python.
fn campaign(options: &[&str]) {
    if Command::new("python3").arg("--version").output().is_err() {
        skipped("there is no python3: the service is not tried with another robot");
        return;
    }
    let output = Command::new("python3")
        .arg("-B")
        .arg(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/robots/campaign.py"
        ))
        .arg(assert_cmd::cargo::cargo_bin!("quell"))
        .arg("--stamps")
        .args(options)
        .output()
        .expect("it starts");
    let [said, errors] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    println!("{said}");
    assert!(output.status.success(), "{said}\n{errors}");
}

#[test]
fn twelve_moves_keep_every_limit() {
    campaign(&["--moves", "12", "--change"]);
}

#[test]
fn a_tracker_of_the_tip_is_registered_by_the_first_move() {
    campaign(&["--moves", "5", "--sensor", "tip", "--divider", "2"]);
}

#[test]
fn what_was_learned_outlives_a_kill_in_mid_move() {
    campaign(&["--kill"]);
}
