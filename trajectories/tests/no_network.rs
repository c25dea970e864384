//! Nothing in this crate opens a network connection.
//!
//! Ruckig's community edition contains a client that posts waypoints to a service. The test runs
//! [`plans_of_every_kind`] again, in a process of its own: once in a network namespace without
//! interfaces, once under strace, whose record must hold no call that opens a socket.

#[path = "../../tests/absent/skipped.rs"]
mod skipped;

use std::path::Path;
use std::process::{Command, Output};

use quell_trajectories::{AxisState, Limits, Planner};
use skipped::skipped;

/// Set for the process in the empty namespace, which then makes sure that it is cut off.
const ISOLATED: &str = "QUELL_TEST_ISOLATED";

#[test]
fn plans_of_every_kind() {
    if std::env::var_os(ISOLATED).is_some() {
        // An address kept for documents (RFC 5737); to connect UDP looks a route up, sends nothing.
        let socket = std::net::UdpSocket::bind("0.0.0.0:0").unwrap();
        socket
            .connect("192.0.2.1:9")
            .expect_err("the namespace has a way out");
    }
    let limit = Limits {
        velocity: 1.0,
        acceleration: 2.0,
        jerk: 10.0,
    };
    for axes in 1..=7 {
        let planner = Planner::new(axes).unwrap();
        let (from, limits) = (vec![AxisState::at_rest(0.0); axes], vec![limit; axes]);
        let to: Vec<_> = (0..axes)
            .map(|k| AxisState::at_rest(1.0 - 0.3 * k as f64))
            .collect();
        let there = planner.plan(&from, &to, &limits).unwrap();
        planner
            .plan(&there.state_at(0.3), &from, &limits)
            .unwrap()
            .sample(0.001)
            .unwrap();
        planner
            .plan_stop(&there.state_at(0.5), &limits)
            .unwrap()
            .sample(0.001)
            .unwrap();
        planner.plan(&from, &to[1..], &limits).unwrap_err();
    }
}

/// Runs this file's other test in a process of its own, below `wrapper`.
fn again_under(wrapper: &[&str]) -> std::io::Result<Output> {
    let mut command = Command::new(wrapper[0]);
    command.args(&wrapper[1..]).arg(std::env::current_exe()?);
    if wrapper[0] == "unshare" {
        command.env(ISOLATED, "1");
    }
    command
        .args(["--exact", "plans_of_every_kind", "--test-threads=1"])
        .output()
}

fn works(command: &[&str]) -> bool {
    let output = Command::new(command[0])
        .args(&command[1..])
        .arg("true")
        .output();
    output.is_ok_and(|output| output.status.success())
}

fn succeeded(output: &Output) {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("1 passed"),
        "{output:?}"
    );
}

#[test]
fn no_connection_is_opened() {
    let record = std::env::temp_dir().join(format!("quell-strace-{}", std::process::id()));
    let trace = [
        "strace",
        "-f",
        "-e",
        "trace=network",
        "-o",
        &record.to_string_lossy(),
    ];
    let namespaces = [
        ["unshare", "--net"].as_slice(),
        &["unshare", "--map-root-user", "--net"],
    ];
    let namespace = namespaces.into_iter().find(|command| works(command));
    let traced = works(&trace);
    if let Some(namespace) = namespace {
        succeeded(&again_under(namespace).unwrap());
    }
    if traced {
        succeeded(&again_under(&trace).unwrap());
        assert_opens_no_socket(&record);
    }
    let _ = std::fs::remove_file(&record);
    if namespace.is_none() && !traced {
        skipped("neither unshare --net nor strace works here");
    }
}

/// The record holds every call of the network kind, of all threads.
fn assert_opens_no_socket(record: &Path) {
    let calls = std::fs::read_to_string(record).unwrap();
    let outward = ["socket(", "connect(", "sendto(", "sendmsg(", "sendmmsg("];
    let found = calls
        .lines()
        .find(|line| outward.iter().any(|call| line.contains(call)));
    assert_eq!(found, None, "a socket was opened");
}
