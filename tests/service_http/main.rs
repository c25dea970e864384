//! What the service says to the outside, and what it refuses.

mod client;
mod stand_in;
mod streams;

use client::Client;
use quell::recording::{Recording, Role};
use quell::service::contract::{Batch, Event, Measured, MoveResult, MoveStart, Quantity, TickRow};
use quell::service::http::{Settings, check};
use quell::service::recorder::{Bounds, Shelf};
use rand::{Rng, SeedableRng};
use serde_json::Value;
use stand_in::{BOUNDS, outside, settings};
use std::sync::Arc;
use std::time::{Duration, Instant};

const MOVE: &str = r#"{"joint": "joint_1", "target_deg": 30}"#;

/// Path, body, status, and words of the sentence.
const REFUSED: &[(&str, &str, u16, &str)] = &[
    ("/api/move", "", 400, "EOF"),
    ("/api/move", "{", 400, "EOF"),
    ("/api/move", "[]", 400, "the body is not what it should be"),
    ("/api/move", "\u{0}", 400, "expected value"),
    ("/api/move", "{}", 400, "missing field `joint`"),
    (
        "/api/move",
        r#"{"joint": "joint_1"}"#,
        422,
        "exactly one of target_deg and target_rad",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 1, "target_rad": 1}"#,
        422,
        "exactly one",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_9", "target_deg": 1}"#,
        422,
        "there are: joint_1",
    ),
    (
        "/api/move",
        r#"{"joint": 1, "target_deg": 1}"#,
        400,
        "expected a string",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": "1"}"#,
        400,
        "expected f64",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 1e999}"#,
        400,
        "out of range",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": NaN}"#,
        400,
        "expected value",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 101}"#,
        422,
        "moves from -100 to 100",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_rad": -1.8}"#,
        422,
        "moves from -1.745",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 1, "speed": 1}"#,
        400,
        "unknown field `speed`",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "joint": "joint_1", "target_deg": 1}"#,
        400,
        "duplicate",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 1, "shaper": "nonsense"}"#,
        422,
        "no shaper \"nonsense\"",
    ),
    (
        "/api/move",
        r#"{"joint": "joint_1", "target_deg": 1, "shaper": "zv"}"#,
        409,
        "until it rests",
    ),
    ("/api/stop", r#"{"now": true}"#, 400, "unknown field `now`"),
    ("/api/stop", "nonsense", 400, "expected"),
    ("/api/shaper", "{}", 422, "nothing to change"),
    (
        "/api/shaper",
        r#"{"enabled": 1}"#,
        400,
        "expected a boolean",
    ),
    (
        "/api/shaper",
        r#"{"mode": {"frequency_hz": 8}}"#,
        400,
        "missing field `damping_ratio`",
    ),
    (
        "/api/shaper",
        r#"{"mode": {"frequency_hz": 8, "damping_ratio": 0.1, "q": 1}}"#,
        400,
        "unknown field `q`",
    ),
    ("/api/payload", r#"{"mass_kg": -1}"#, 422, "0 or more"),
    (
        "/api/payload",
        r#"{"mass_kg": 2}"#,
        422,
        "finite and plausible",
    ),
    ("/api/payload", r#"{"mass_kg": 0.5}"#, 503, "stopping"),
    (
        "/api/recordings",
        r#"{"recording": true}"#,
        404,
        "nothing is recorded",
    ),
    (
        "/api/diagnose",
        r#"{"recording": "a"}"#,
        404,
        "nothing is recorded",
    ),
    (
        "/api/diagnose",
        r#"{"model": "a"}"#,
        400,
        "missing field `recording`",
    ),
    (
        "/api/nothing",
        "{}",
        404,
        "there is nothing at /api/nothing",
    ),
    ("/api/state", "{}", 405, "does not take this method"),
];

#[test]
fn what_is_wrong_is_refused_with_a_sentence() {
    let outside = outside(settings(), None);
    let mut client = Client::new(outside.address);
    assert_eq!(client.post("/api/move", MOVE).json()["accepted"], "move");
    assert_eq!(client.post("/api/stop", "").json()["accepted"], "stop");
    for &(path, body, status, words) in REFUSED {
        let answer = client.post(path, body);
        assert_eq!(answer.status, status, "{path} {body}: {}", answer.error());
        assert!(
            answer.error().contains(words),
            "{path} {body}: {}",
            answer.error()
        );
    }
    let plain = client.send("POST", "/api/move", &[], MOVE.as_bytes());
    assert_eq!(plain.status, 415, "{}", plain.text());
    let long = client.post("/api/move", &" ".repeat(5000));
    assert_eq!(
        (long.status, long.error().as_str()),
        (413, "the body is longer than 4096 bytes")
    );
    let mut client = Client::new(outside.address);
    for path in [
        "/api/stream",
        "/api/diagnose/1",
        "/api/diagnose/x",
        "/api/%ff",
        "/%2e%2e/etc",
    ] {
        let answer = client.get(path);
        assert!((400..500).contains(&answer.status), "{path}");
        assert!(!answer.error().is_empty(), "{path}: {}", answer.text());
    }
    // The limits themselves are reached, whatever rounding does to degrees.
    let limit = client.post("/api/move", r#"{"joint": "joint_1", "target_deg": 100}"#);
    assert_eq!(limit.status, 200);
    let metrics = client.get("/metrics").text();
    assert!(
        metrics.contains("quell_http_refused_total{code=\"415\"} 1\n"),
        "{metrics}"
    );
    assert!(metrics.contains("quell_mode_frequency_hertz{joint=\"joint_1\"} 8\n"));
    assert_eq!(
        client.get("/api/state").json()["joints"][0]["name"],
        "joint_1"
    );
    assert_eq!(client.get("/api/estimates").json()[0]["shaper"], "zvd");
}

#[test]
fn only_this_machine_is_let_in_without_a_token() {
    let outside = outside(settings(), None);
    let mut client = Client::new(outside.address);
    let port = outside.address.port();
    let ask = |client: &mut Client, host: &str, origin: Option<&str>| {
        let mut headers = vec![("Host", host), ("Content-Type", "application/json")];
        headers.extend(origin.map(|origin| ("Origin", origin)));
        client.send("POST", "/api/stop", &headers, b"").status
    };
    let local = format!("localhost:{port}");
    assert_eq!(ask(&mut client, &local, None), 200);
    assert_eq!(ask(&mut client, "127.0.0.1", None), 200);
    assert_eq!(ask(&mut client, "[::1]:80", None), 200);
    assert_eq!(
        ask(&mut client, &local, Some(&format!("http://{local}"))),
        200
    );
    for host in [
        "evil.example",
        "localhost.evil.example",
        "10.0.0.1",
        "",
        "127.0.0.1.evil.example",
    ] {
        assert_eq!(ask(&mut client, host, None), 403, "{host}");
    }
    for origin in [
        "http://evil.example",
        "null",
        "http://localhost:1",
        "file://",
    ] {
        assert_eq!(ask(&mut client, &local, Some(origin)), 403, "{origin}");
    }
    let page = client.get("/");
    assert!(page.text().contains("<title>Quell</title>"));
    assert!(page.head.contains("default-src 'none'"), "{}", page.head);
}

#[test]
fn others_need_the_token() {
    let everywhere = "0.0.0.0:80".parse().unwrap();
    let error = check(everywhere, None).unwrap_err().to_string();
    assert!(error.contains("give a token"), "{error}");
    assert!(check(everywhere, Some("short")).is_err());
    assert!(check("[::1]:80".parse().unwrap(), None).is_ok());
    let token = "0123456789+/=abcd";
    assert!(check(everywhere, Some(token)).is_ok());
    let settings = Settings {
        token: Some(token.into()),
        ..settings()
    };
    let outside = outside(settings, None);
    let mut client = Client::new(outside.address);
    let with = |client: &mut Client, method: &str, path: &str, value: &str| {
        let headers = [("Authorization", value), ("Host", "robot.example")];
        client.send(method, path, &headers, b"").status
    };
    assert_eq!(client.get("/").status, 200);
    for path in ["/api/state", "/metrics", "/api/stream", "/api/recordings/a"] {
        assert_eq!(client.get(path).status, 401, "{path}");
    }
    assert_eq!(
        with(&mut client, "GET", "/api/state", "Bearer 0123456789+/=abcd"),
        200
    );
    assert_eq!(
        with(&mut client, "POST", "/api/stop", "Bearer 0123456789+/=abcd"),
        200
    );
    assert_eq!(
        with(&mut client, "POST", "/api/stop", "Bearer 0123456789+/=abce"),
        401
    );
    assert_eq!(
        with(&mut client, "POST", "/api/stop", "0123456789+/=abcd"),
        401
    );
    let query = "?token=0123456789%2B%2F%3Dabcd";
    assert_eq!(client.get(&format!("/api/state{query}")).status, 200);
    // What commands must not be a link.
    assert_eq!(client.post(&format!("/api/stop{query}"), "").status, 401);
}

#[test]
fn connections_that_are_too_many_or_say_nothing_do_no_harm() {
    let settings = Settings {
        max_connections: 4,
        ..settings()
    };
    let outside = outside(settings, None);
    let mut held: Vec<_> = (0..4).map(|_| Client::new(outside.address)).collect();
    for client in &mut held {
        assert_eq!(client.get("/metrics").status, 200);
    }
    let refused = Client::new(outside.address).read().unwrap();
    assert_eq!(
        (refused.status, refused.error().contains("too many")),
        (503, true)
    );
    held.pop();
    let until = Instant::now() + Duration::from_secs(10);
    while Instant::now() < until {
        std::thread::sleep(Duration::from_millis(20));
        let metrics = held[0].get("/metrics").text();
        if metrics.contains("quell_http_connections 3\n") {
            break;
        }
    }
    let mut again = Client::new(outside.address);
    assert_eq!(again.get("/metrics").status, 200, "a place is free again");
}

#[test]
fn ten_thousand_mutated_bodies_are_each_answered() {
    let outside = outside(settings(), None);
    let mut client = Client::new(outside.address);
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let seeds = [
        ("/api/move", MOVE),
        (
            "/api/shaper",
            r#"{"kind": "zvd", "mode": {"frequency_hz": 8.0, "damping_ratio": 0.1}}"#,
        ),
        ("/api/payload", r#"{"mass_kg": 0.25}"#),
        (
            "/api/diagnose",
            r#"{"recording": "move-000001", "model": "kind = \"flexible_joint\""}"#,
        ),
        ("/api/stop", "{}"),
    ];
    let mut statuses = std::collections::BTreeMap::new();
    for _ in 0..10_000 {
        let (path, body) = seeds[random.random_range(0..seeds.len())];
        let mut bytes = body.as_bytes().to_vec();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..bytes.len());
            match random.random_range(0..4) {
                0 => bytes[at] = random.random(),
                1 => bytes.truncate(at.max(1)),
                2 => bytes.insert(at, random.random()),
                _ => bytes[at] ^= 1 << random.random_range(0..8),
            }
        }
        let json = [("Content-Type", "application/json")];
        let answer = client.send("POST", path, &json, &bytes);
        let sentence = answer.status == 200 || !answer.error().is_empty();
        assert!(
            sentence,
            "{} {:?}",
            answer.status,
            String::from_utf8_lossy(&bytes)
        );
        *statuses.entry(answer.status).or_insert(0) += 1;
    }
    println!("{statuses:?}");
    assert!(!statuses.contains_key(&500), "{statuses:?}");
    let metrics = client.get("/metrics").text();
    assert!(
        metrics.contains("quell_http_requests_total 10000\n"),
        "each is counted"
    );
}

/// A move of half a second from 2 s on, as the engine tells of it.
fn a_move(id: u64) -> Vec<Batch> {
    let name = Some(format!("move-{id:06}"));
    let times: Vec<f64> = (0..450).map(|k| 0.01 * f64::from(k)).collect();
    let batch = |(number, times): (usize, &[f64])| Batch {
        number: number as u64 + 1000 * id,
        ticks: times.iter().map(|&time| row(time)).collect(),
        measured: times.iter().map(|&time| measured(time)).collect(),
        events: Vec::new(),
    };
    let mut batches: Vec<_> = times.chunks(20).enumerate().map(batch).collect();
    batches[10].events.push(Event::MoveStarted(MoveStart {
        id,
        joint: "joint_1".into(),
        time_s: 2.0,
        recording: name.clone(),
        ..MoveStart::default()
    }));
    batches[14].events.push(Event::MoveEnded(MoveResult {
        id,
        joint: "joint_1".into(),
        recording: name,
        ..MoveResult::default()
    }));
    batches
}

fn row(time: f64) -> TickRow {
    TickRow {
        time,
        position: (time - 2.0).clamp(0.0, 0.5),
        ..TickRow::default()
    }
}

fn measured(time: f64) -> Measured {
    Measured {
        received: time,
        stamp: time + 700.0,
        joint: 0,
        quantity: Quantity::MotorPosition,
        value: [time, 0.0, 0.0],
        refused: false,
    }
}

/// Asks until the list of recordings has so many, or ten seconds are over.
fn listed(client: &mut Client, count: usize) -> Value {
    let until = Instant::now() + Duration::from_secs(10);
    loop {
        let list = client.get("/api/recordings").json();
        if list.as_array().is_some_and(|list| list.len() == count) || Instant::now() > until {
            return list;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn moves_are_recorded_whole_and_within_bounds() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join(".unfinished-move-000000")).unwrap();
    let outside = outside(settings(), Some((folder.path(), BOUNDS)));
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        0,
        "what was not finished goes"
    );
    let mut client = Client::new(outside.address);
    for batch in a_move(1) {
        outside.stream.send(Arc::new(batch)).unwrap();
    }
    let list = listed(&mut client, 1);
    assert_eq!(list[0]["name"], "move-000001");
    let recording = Recording::from_path(folder.path().join("move-000001")).unwrap();
    // A second of rest before it and after it.
    let command = recording.channel(Role::CommandPosition).unwrap();
    assert_eq!((command.time.len(), command.time[0]), (300, 0.0));
    let motor = recording.channel(Role::MotorPosition).unwrap();
    assert!(
        (motor.time[0]).abs() < 1e-9,
        "the clocks are brought together"
    );
    let file = folder.path().join("move-000001/recording.mcap");
    let same = Recording::from_path(&file).unwrap();
    assert_eq!(
        same.channel(Role::MotorPosition).unwrap().columns,
        motor.columns
    );
    let archive = client.get("/api/recordings/move-000001");
    let mut archive = tar::Archive::new(archive.body.as_slice());
    let files: Vec<_> = archive
        .entries()
        .unwrap()
        .map(|e| e.unwrap().path().unwrap().into_owned())
        .collect();
    assert!(
        files
            .iter()
            .any(|file| file.ends_with("move-000001/recording.toml")),
        "{files:?}"
    );
    for name in [
        "..",
        "../move-000001",
        "%2e%2e",
        "..%2f..%2fetc%2fpasswd",
        ".",
        "move-000002",
        "a%00b",
    ] {
        let answer = client.get(&format!("/api/recordings/{name}"));
        assert_eq!(answer.status, 404, "{name}: {}", answer.text());
    }
    // The same number again, as after a loss of the service's state, and again on demand.
    for batch in a_move(1) {
        outside.stream.send(Arc::new(batch)).unwrap();
    }
    assert_eq!(listed(&mut client, 2)[1]["name"], "move-000001-2");
    assert_eq!(
        client
            .post("/api/recordings", r#"{"recording": true}"#)
            .status,
        200
    );
    assert_eq!(
        client
            .post("/api/recordings", r#"{"recording": true}"#)
            .status,
        409
    );
    outside.stream.send(Arc::new(a_move(3).remove(15))).unwrap();
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(
        client
            .post("/api/recordings", r#"{"recording": false}"#)
            .status,
        200
    );
    assert_eq!(
        client
            .post("/api/recordings", r#"{"recording": false}"#)
            .status,
        409
    );
    let sizes: u64 = listed(&mut client, 3)
        .as_array()
        .unwrap()
        .iter()
        .map(|e| e["bytes"].as_u64().unwrap())
        .sum();
    let bounds = Bounds {
        bytes: sizes - 1,
        ..BOUNDS
    };
    let shelf = Shelf::open(folder.path(), bounds).unwrap();
    let left: Vec<_> = shelf
        .list()
        .unwrap()
        .into_iter()
        .map(|entry| entry.name)
        .collect();
    assert!(
        left.len() == 2 && !left.contains(&"move-000001".to_string()),
        "the oldest goes: {left:?}"
    );
}
