//! Recordings that an earlier life of the service left unfinished.

use std::fs;
use std::path::Path;

use quell::recording::{McapWriter, Role};
use quell::service::contract::MoveResult;
use quell::service::recorder::{About, RecordingEnd, Shelf};

use super::{BOUNDS, check_recording, names};

/// A file of so many rows that was never finished.
fn journal(path: &Path, rows: u32) -> Vec<u8> {
    let file = Box::new(fs::File::create(path).expect("a file"));
    let writer = McapWriter::on(file, path, &["hip"], 1_700_000_000_000_000_000);
    let mut writer = writer.expect("a file");
    for row in 0..rows {
        let time = f64::from(row) / 1000.0;
        let written = writer.write_command(time, "hip", time, 1.0, 0.0);
        written.expect("a command");
        let sample = writer.write_sample(time, "hip", Role::MotorPosition, time, &[time]);
        sample.expect("a sample");
    }
    writer.flush().expect("room");
    // What a kill leaves: the writer would finish the file when it is dropped.
    let bytes = fs::read(path).expect("a file");
    drop(writer);
    fs::write(path, &bytes).expect("a file");
    bytes
}

fn unfinished(folder: &Path, name: &str) -> std::path::PathBuf {
    let folder = folder.join(format!(".unfinished-{name}"));
    fs::create_dir(&folder).expect("a folder");
    fs::write(
        folder.join("about.json"),
        r#"{"number": 7, "joint": "hip"}"#,
    )
    .expect("a file");
    folder
}

#[test]
fn a_file_that_a_kill_has_cut_is_mended_for_other_readers() {
    let folder = tempfile::tempdir().expect("a folder");
    let left = unfinished(folder.path(), "move-000009");
    let bytes = journal(&left.join("recording.mcap"), 1500);
    let cut = &bytes[..bytes.len() - 100];
    fs::write(left.join("recording.mcap"), cut).expect("a file");
    assert!(mcap::Summary::read(cut).is_err(), "others refuse it");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    assert_eq!(names(folder.path()), ["move-000009"]);
    let whole = check_recording(&folder.path().join("move-000009"));
    let command = whole.channel(Role::CommandPosition).expect("commands");
    // A quarter of a second is lost at most.
    assert!(command.time.len() >= 1250, "{}", command.time.len());
    assert!(whole.channel(Role::MotorPosition).is_some());
    let list = shelf.list().expect("a list");
    assert_eq!((list[0].about.number, shelf.number()), (7, 8));
    assert_eq!(shelf.last_move().expect("a number"), 9);
}

/// The disk has refused the end of a recording: the result of its move is known nevertheless.
#[test]
fn the_result_of_a_move_outlives_a_disk_that_refuses_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    for name in ["move-000003", "move-000004"] {
        let left = unfinished(folder.path(), name);
        journal(&left.join("recording.mcap"), 1500);
    }
    let known = About {
        number: 7,
        joint: "hip".into(),
        result: Some(MoveResult {
            id: 3,
            joint: "hip".into(),
            ..MoveResult::default()
        }),
        ..About::default()
    };
    let known = [("move-000003".to_owned(), known)];
    let salvaged = shelf.salvage(&[], &known).expect("room");
    assert_eq!(salvaged.len(), 2);
    let about = shelf.about("move-000003").expect("a description");
    assert_eq!(about.result.map(|result| result.id), Some(3));
    assert_eq!(about.ended, RecordingEnd::Cut);
    assert!(about.duration_s > 1.0, "{}", about.duration_s);
    let other = shelf.about("move-000004").expect("a description");
    assert!(other.result.is_none() && other.number == 7);
}

#[test]
fn what_cannot_be_read_is_set_aside_and_not_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let left = unfinished(folder.path(), "move-000001");
    fs::write(left.join("recording.mcap"), b"not what it should be").expect("a file");
    // In this one nothing was measured yet.
    unfinished(folder.path(), "move-000002");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    assert_eq!(names(folder.path()), [".unreadable-move-000001"]);
    let kept = folder.path().join(".unreadable-move-000001/recording.mcap");
    assert_eq!(fs::read(kept).expect("a file"), b"not what it should be");
    assert!(shelf.list().expect("a list").is_empty());
    assert_eq!(shelf.last_move().expect("a number"), 1);
}

#[test]
fn what_stands_behind_a_damage_is_kept_beside_what_can_be_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let left = unfinished(folder.path(), "move-000001");
    let mut bytes = journal(&left.join("recording.mcap"), 1500);
    // As a power failure leaves a file whose last blocks were never written.
    let from = bytes.len() * 2 / 3;
    bytes[from..].fill(0);
    fs::write(left.join("recording.mcap"), &bytes).expect("a file");
    let _ = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    let shelved = folder.path().join("move-000001");
    let part = check_recording(&shelved);
    let rows = part
        .channel(Role::CommandPosition)
        .expect("commands")
        .time
        .len();
    assert!((500..1500).contains(&rows), "{rows}");
    assert_eq!(
        fs::read(shelved.join("damaged.mcap")).expect("a file"),
        bytes
    );
}
