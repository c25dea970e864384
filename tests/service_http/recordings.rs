//! Moves on disk, by way of the interface.

use super::client::Client;
use super::moves::a_move;
use super::stand_in::{BOUNDS, outside, settings};
use quell::recording::{McapFile, Recording, Role};
use quell::service::contract::{Event, MoveEnd};
use quell::service::recorder::{Bounds, RecordingEnd, Shelf};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

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
    // The modes that were known and the train in force, as ROS 2 hears them.
    let topics = McapFile::open(&file).unwrap();
    for name in ["/quell/joint_1/modes", "/quell/joint_1/impulses"] {
        let topic = topics.topics().iter().find(|topic| topic.name == name);
        let topic = topic.expect("a topic");
        let kind = "std_msgs/msg/Float64MultiArray";
        assert_eq!((topic.kind.as_str(), topic.messages), (kind, 1), "{name}");
    }
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
    // A long one is sent as it is read.
    let long = std::fs::File::create(folder.path().join("move-000001/long")).unwrap();
    long.set_len(20_000_000).unwrap();
    let archive = client.get("/api/recordings/move-000001");
    let mut archive = tar::Archive::new(archive.body.as_slice());
    let sizes = archive.entries().unwrap().map(|e| e.unwrap().size());
    assert_eq!(sizes.max(), Some(20_000_000));
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
}

#[test]
fn what_a_fault_stops_is_recorded_until_a_second_of_rest_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let outside = outside(settings(), Some((folder.path(), BOUNDS)));
    let mut batches = a_move(1);
    for batch in &mut batches {
        for event in &mut batch.events {
            if let Event::MoveEnded(result) = event {
                (result.interrupted, result.ended) = (true, Some(MoveEnd::Fault));
                result.fault = Some("it is held".into());
            }
        }
        // Nobody commands it any more; it brakes for half a second after the end of its move, at 3 s.
        batch.ticks.retain(|row| row.time < 3.5);
        for row in batch.ticks.iter_mut().filter(|row| row.time < 3.5) {
            row.velocity = if row.time < 3.45 { 0.1 } else { 0.0 };
        }
    }
    for batch in batches {
        outside.stream.send(Arc::new(batch)).unwrap();
    }
    let mut client = Client::new(outside.address);
    let list = listed(&mut client, 1);
    assert_eq!(list[0]["ended"], "move", "{list}");
    assert_eq!(list[0]["result"]["ended"], "fault");
    assert_eq!(list[0]["result"]["fault"], "it is held");
    let of_csv = Recording::from_path(folder.path().join("move-000001")).unwrap();
    let of_mcap = folder.path().join("move-000001/recording.mcap");
    for recording in [of_csv, Recording::from_path(of_mcap).unwrap()] {
        // From a second before the move, at 2 s.
        let last = |role| *recording.channel(role).unwrap().time.last().unwrap();
        assert!((last(Role::CommandPosition) - 2.49).abs() < 1e-6);
        assert!(
            last(Role::MotorPosition) > 3.3,
            "{}",
            last(Role::MotorPosition)
        );
    }
}

#[test]
fn what_a_kill_cuts_is_kept_as_far_as_it_came() {
    let [folder, left] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let outside = outside(settings(), Some((folder.path(), BOUNDS)));
    // It has begun and does not end.
    let batches = a_move(7);
    for batch in &batches[..14] {
        outside.stream.send(Arc::new(batch.clone())).unwrap();
    }
    // As the disk is at the kill; the last batches are not asked for, since they may be on their way.
    let name = ".unfinished-move-000007";
    let file = folder.path().join(name).join("recording.mcap");
    let until = Instant::now() + Duration::from_secs(10);
    let rows = |file: &Path| {
        let recording = Recording::from_path(file).ok()?;
        Some(recording.channel(Role::CommandPosition)?.time.len())
    };
    while rows(&file) < Some(150) && Instant::now() < until {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::fs::create_dir(left.path().join(name)).unwrap();
    for entry in std::fs::read_dir(folder.path().join(name)).unwrap() {
        let path = entry.unwrap().path();
        let kept = left.path().join(name).join(path.file_name().unwrap());
        std::fs::copy(path, kept).unwrap();
    }
    let shelf = Shelf::open(left.path(), BOUNDS).unwrap();
    let list = shelf.list().unwrap();
    assert_eq!((list.len(), list[0].name.as_str()), (1, "move-000007"));
    assert!(list[0].about.result.is_none() && list[0].about.duration_s >= 1.4);
    assert_eq!(list[0].about.ended, RecordingEnd::Cut);
    let recording = Recording::from_path(shelf.path("move-000007").unwrap()).unwrap();
    let [command, motor] = [Role::CommandPosition, Role::MotorPosition];
    let lengths = [command, motor].map(|role| recording.channel(role).unwrap().time.len());
    assert!(
        lengths[0] >= 150 && lengths[1] + 1 >= lengths[0],
        "{lengths:?}"
    );
    // The rest comes, and the recording is whole, once.
    for batch in &batches[14..] {
        outside.stream.send(Arc::new(batch.clone())).unwrap();
    }
    let mut client = Client::new(outside.address);
    assert_eq!(listed(&mut client, 1)[0]["name"], "move-000007");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let whole = folder.path().join("move-000007/recording.mcap");
    assert_eq!(rows(&whole), Some(300));
}

#[test]
fn what_is_too_much_goes_oldest_first() {
    let folder = tempfile::tempdir().unwrap();
    let outside = outside(settings(), Some((folder.path(), BOUNDS)));
    let mut client = Client::new(outside.address);
    for batch in a_move(1) {
        outside.stream.send(Arc::new(batch)).unwrap();
    }
    assert_eq!(listed(&mut client, 1)[0]["name"], "move-000001");
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
