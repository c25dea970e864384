//! The program itself, as its users start it.

use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::client::Client;

/// The time that a slow machine may take for one step.
const PATIENCE: Duration = Duration::from_secs(120);

/// A process that ends with the test.
pub struct Process {
    pub child: Child,
    pub address: SocketAddr,
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The arguments of a service of the embedded arm on a data folder.
pub fn arguments(data: &Path) -> [String; 5] {
    let data = data.display().to_string();
    ["serve", "--http", "127.0.0.1:0", "--data", &data].map(str::to_owned)
}

/// Starts a service by a command that has its arguments.
pub fn start(command: &mut Command) -> Process {
    let mut child = command.stdout(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let first = lines.next().and_then(Result::ok).unwrap_or_default();
    // Its output must be taken as long as it lives.
    std::thread::spawn(move || lines.for_each(drop));
    let address = first
        .split("http://")
        .nth(1)
        .map(|rest| rest.trim_end_matches('/'));
    let address = address.and_then(|address| address.parse().ok());
    Process {
        address: address.unwrap_or_else(|| panic!("no address in {first:?}")),
        child,
    }
}

/// A service of this build on a folder.
pub fn serve(data: &Path) -> Process {
    start(Command::new(env!("CARGO_BIN_EXE_quell")).args(arguments(data)))
}

/// Asks until an answer holds.
pub fn until(client: &mut Client, path: &str, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
    let since = Instant::now();
    loop {
        let answer = client.get(path).json();
        if holds(&answer) {
            return answer;
        }
        assert!(since.elapsed() < PATIENCE, "{what}: {answer:#}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Lets moves begin, once the joint is known to stand where it is commanded to be.
pub fn enable(client: &mut Client) {
    let since = Instant::now();
    while client.post("/api/v1/enable", "").status != 200 {
        assert!(since.elapsed() < PATIENCE, "it is not enabled");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Commands a move and waits for its end; says what was answered.
pub fn go(client: &mut Client, degrees: f64) -> Value {
    let body = format!(r#"{{"joint": "joint_1", "target_deg": {degrees}}}"#);
    until(client, "/api/state", "it rests", |state| {
        state["joints"][0]["phase"] == "rest"
    });
    enable(client);
    let answer = client.post("/api/move", &body);
    assert_eq!(answer.status, 200, "{}{}", answer.head, answer.error());
    let id = answer.json()["id"].clone();
    let state = until(client, "/api/state", "the move ends", |state| {
        result(state, &id).is_some()
    });
    result(&state, &id).expect("it was just there").clone()
}

/// The result of a move, in the state.
pub fn result<'a>(state: &'a Value, id: &Value) -> Option<&'a Value> {
    let moves = state["moves"].as_array()?;
    moves.iter().find(|done| done["id"] == *id)
}
