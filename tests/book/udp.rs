//! The four steps of the page on UDP: its configuration, its robot, enable, move.

use super::markdown::read;
use super::root;
use super::service::Service;
use super::skipped::skipped;
use serde_json::Value;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// So long a busy machine may take for a step; a test that fails takes this long.
const PATIENCE: Duration = Duration::from_secs(60);

/// The robot of the page; it ends when it is dropped.
struct Robot(Child);

impl Drop for Robot {
    fn drop(&mut self) {
        // It runs until it is killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < PATIENCE, "{what}");
        sleep(Duration::from_millis(50));
    }
}

fn moves(key: Option<&str>) {
    let page = std::fs::read_to_string(root().join("docs/src/guide/udp.md")).unwrap();
    let page = read(&page);
    let mut text = page
        .blocks
        .iter()
        .find(|block| block.is("quell"))
        .unwrap()
        .text
        .clone();
    text += &key.map_or(String::new(), |key| format!("\n[udp]\nkey = \"{key}\"\n"));
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("quell.toml");
    std::fs::write(&config, text).unwrap();
    let data = folder.path().join("data");
    let (config, data) = (config.to_str().unwrap(), data.to_str().unwrap());
    let service = Service::start(&["--config", config, "--data", data]);
    let mut robot = Command::new("python3");
    robot
        .arg(root().join("examples/udp_robot.py"))
        .arg(service.udp.as_ref().unwrap());
    let _robot = Robot(robot.args(key).spawn().unwrap());
    until("it is not enabled", || {
        service.ask("POST", "/api/v1/enable", "").0 == 200
    });
    let order = r#"{"joint": "joint_1", "target_deg": 10}"#;
    until("it does not move", || {
        service.ask("POST", "/api/v1/move", order).0 == 200
    });
    until("it does not arrive", || {
        let state: Value =
            serde_json::from_str(&service.ask("GET", "/api/v1/state", "").1).unwrap();
        let at = state["joints"][0]["motor_rad"].as_f64();
        at.is_some_and(|at| (at - 10f64.to_radians()).abs() < 1e-6)
    });
}

#[test]
fn the_smallest_robot_goes_where_it_is_told_signed_or_not() {
    if Command::new("python3").arg("--version").output().is_err() {
        skipped("the robot of the page on UDP: there is no python3");
        return;
    }
    moves(None);
    moves(Some("sixteen characters or more"));
}
