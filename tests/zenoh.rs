//! A robot on ROS 2 over Zenoh, in Python and of other libraries: skipped where these cannot be installed.
#![cfg(feature = "zenoh")]

#[path = "absent/python.rs"]
mod python;
#[path = "absent/skipped.rs"]
mod skipped;

use std::net::TcpListener;
use std::path::Path;

use python::python;

use quell::service::bridged::BRIDGED;
use quell::service::config::{Config, Overrides};
use quell::service::contract::{Request, Snapshot};
use quell::service::start;
use serde_json::Value;

const RATE: f64 = 250.0;

fn config(folder: &Path, port: u16) -> Config {
    let text = format!(
        "[service]\nrobot = \"zenoh\"\n[tick]\nrate_hz = {RATE}\nreal_time = false\n\
         [zenoh]\nconnect = []\nlisten = [\"tcp/127.0.0.1:{port}\"]\n"
    );
    let file = folder.join("quell.toml");
    std::fs::write(&file, text).expect("a file");
    let overrides = Overrides {
        data: Some(folder.join("data")),
        ..Overrides::default()
    };
    Config::load(Some(&file), &overrides).expect("a configuration")
}

fn floats(value: &Value) -> Vec<f64> {
    let values = value.as_array().expect("an array").iter();
    values
        .map(|value| value.as_f64().unwrap_or(f64::NAN))
        .collect()
}

#[test]
fn a_robot_on_ros_2_is_moved_by_trajectories() {
    let folder = tempfile::tempdir().expect("a folder");
    let free = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = free.local_addr().expect("an address").port();
    drop(free);
    let service = start(config(folder.path(), port)).expect("a service");
    let port = port.to_string();
    let handle = service.handle();
    // Who moves the robot waits for this file.
    let enabled = folder.path().join("enabled");
    let is_enabled = enabled.clone();
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        let runtime = runtime.expect("a runtime");
        // Once the robot is heard; this ends with the process.
        while runtime.block_on(handle.ask(Request::Enable)).is_err() {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        std::fs::write(is_enabled, "").expect("a file");
    });
    let arguments = ["robot.py".as_ref(), port.as_ref(), enabled.as_ref()];
    let Some(seen) = python("ros2", "zenoh.txt", &arguments) else {
        return;
    };
    let snapshot = service.handle().snapshot();
    let seen = serde_json::from_slice(&seen).expect("JSON");
    announced(&seen);
    commanded(&seen, &snapshot);
    told(&seen, &snapshot);
    moved(&snapshot);
}

/// Node, publishers and subscriptions, as `ros2 node list` and `ros2 topic list` look for them.
fn announced(seen: &Value) {
    let tokens = seen["tokens"].as_array().expect("tokens").iter();
    let tokens: Vec<_> = tokens.filter_map(Value::as_str).collect();
    let is_there = |kind: &str, rest: &str| {
        let parts = |token: &&&str| {
            let parts: Vec<_> = token.split('/').collect();
            parts[5] == kind && parts[6..].join("/").starts_with(rest)
        };
        assert_eq!(
            tokens.iter().filter(parts).count(),
            1,
            "{kind} {rest}: {tokens:#?}"
        );
    };
    is_there("NN", "%/%/quell");
    let array = "std_msgs::msg::dds_::Float64MultiArray_/RIHS01_";
    for topic in [
        "forward_position_controller%commands",
        "quell%joint_1%mode",
        "quell%joint_1%modes",
        "quell%joint_1%impulses",
    ] {
        is_there("MP", &format!("%/%/quell/%{topic}/{array}"));
    }
    is_there(
        "MS",
        "%/%/quell/%joint_states/sensor_msgs::msg::dds_::JointState_/RIHS01_",
    );
    is_there("MS", "%/%/quell/%imu/sensor_msgs::msg::dds_::Imu_/RIHS01_");
}

/// The command begins where the robot stands, ends at the last target, and keeps the limits on the way;
/// each message is numbered, dated and signed by one sender.
fn commanded(seen: &Value, snapshot: &Snapshot) {
    let commands = floats(&seen["commands"]);
    assert_eq!(
        (commands.first(), commands.last()),
        (Some(&0.3), Some(&0.9))
    );
    let [velocity, ..] = snapshot.joints[0].limits;
    let farthest = commands.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let farthest = farthest.fold(0.0, f64::max);
    assert!(
        farthest <= 1.01 * velocity / RATE,
        "a step of {farthest} rad"
    );
    assert_eq!(seen["labels"], serde_json::json!([["joint", 1, 1]]));
    let numbers = floats(&seen["numbers"]);
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1.0));
    assert_eq!(seen["senders"].as_array().map(Vec::len), Some(1));
    assert!(seen["age_s"].as_f64().expect("an age") < 120.0);
}

/// The mode that was learned is told, and the train that goes with it.
fn told(seen: &Value, snapshot: &Snapshot) {
    let mode = floats(&seen["mode"]["data"]);
    let truth = seen["frequency_hz"].as_f64().expect("a frequency");
    assert!(
        (mode[0] / truth - 1.0).abs() < 0.02,
        "{mode:?} Hz for {truth} Hz"
    );
    assert_eq!(mode.len(), 7);
    let train = &snapshot.joints[0].train;
    let dimensions = serde_json::json!([
        ["impulse", train.times_s.len(), 2 * train.times_s.len()],
        ["time_s,amplitude", 2, 2]
    ]);
    assert_eq!(seen["impulses"]["dimensions"], dimensions);
    let impulses = floats(&seen["impulses"]["data"]);
    let sum: f64 = impulses.iter().skip(1).step_by(2).sum();
    assert!((sum - 1.0).abs() < 1e-12, "{impulses:?}");
}

/// Only what made sense became a move, and the last one leaves nothing; damaged messages are counted.
fn moved(snapshot: &Snapshot) {
    let targets: Vec<_> = snapshot.moves.iter().map(|m| m.target_rad).collect();
    assert_eq!(targets, [0.9, 0.1, 0.9]);
    let last = &snapshot.moves[2];
    let (left, all) = (
        last.residual_rad.expect("measured"),
        last.unshaped_rad.expect("known"),
    );
    // A gap that is too long stops the robot, and that rings.
    if snapshot.tick.lateness_max_s < BRIDGED {
        assert!(left <= 0.03 * all, "left {left:e} of {all:e}");
    } else {
        println!(
            "ticks were missed for too long: what is left, {left:e} of {all:e}, is not judged"
        );
    }
    let link = &snapshot.link;
    assert_eq!(
        (link.malformed, link.unknown_joint, link.overflowed),
        (20, 0, 0),
        "{link:?}"
    );
    assert!(link.sent > 1000, "{link:?}");
    // The robot's clock is a minute ahead.
    let offset = link.clock_offset_s.expect("stamps");
    assert!((offset - 60.0).abs() < 5.0, "{offset} s");
}
