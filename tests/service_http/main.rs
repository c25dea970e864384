//! The answers of the service to the outside, and its refusals.

mod client;
mod connections;
mod jobs;
#[path = "../moves/mod.rs"]
mod moves;
mod openapi;
mod recordings;
#[path = "../small/mod.rs"]
mod small;
mod stand_in;
mod streams;

use client::Client;
use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::http::{Settings, check};
use rand::{Rng, SeedableRng};
use stand_in::{outside, settings};

const MOVE: &str = r#"{"joint": "joint_1", "target_deg": 30}"#;

/// Path, body, status, and words of the sentence.
const REFUSED: &[(&str, &str, u16, &str)] = &[
    ("/api/move", "", 400, "EOF"),
    ("/api/move", "{", 400, "EOF"),
    ("/api/move", "[]", 400, "the body is not what it should be"),
    (
        "/api/move",
        r#" ["joint_1", 1, null, null]"#,
        400,
        "an object is wanted, not an array",
    ),
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
fn udp_beyond_this_machine_needs_a_key_or_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quell.toml");
    let load = |robot: &str, address: &str, more: &str| {
        let udp = format!("[udp]\naddress = \"{address}\"\n{more}\n");
        std::fs::write(&file, format!("[service]\nrobot = \"{robot}\"\n{udp}")).unwrap();
        Config::load(Some(&file), &Overrides::default())
    };
    for address in [
        "0.0.0.0:7871",
        "192.168.1.5:7871",
        "[::]:7871",
        "[::ffff:10.0.0.1]:7871",
    ] {
        let refused = load("udp", address, "").err().unwrap().to_string();
        assert!(
            refused.contains(&format!("udp.address = {address}")),
            "{refused}"
        );
        for words in [
            "udp.key",
            "openssl rand -hex 32",
            "udp.allow_unsigned = true",
        ] {
            assert!(refused.contains(words), "{refused}");
        }
        let key = "key = \"0123456789abcdef\"";
        assert!(load("udp", address, key).unwrap().udp_key.is_some());
        assert!(load("udp", address, "allow_unsigned = true").is_ok());
        // Without a robot over UDP nothing listens there.
        assert!(load("embedded", address, "").is_ok());
    }
    for address in ["127.0.0.1:7871", "[::1]:7871", "[::ffff:127.0.0.1]:7871"] {
        assert!(load("udp", address, "").is_ok(), "{address}");
    }
    let overrides = Overrides {
        robot: Some(RobotKind::Udp),
        udp: Some("0.0.0.0:7871".parse().unwrap()),
        ..Overrides::default()
    };
    assert!(
        Config::load(None, &overrides).is_err(),
        "also on the command line"
    );
}

#[test]
fn a_hundred_thousand_mutated_bodies_are_each_answered() {
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
    for _ in 0..100_000 {
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
        metrics.contains("quell_http_requests_total 100000\n"),
        "each is counted"
    );
}
