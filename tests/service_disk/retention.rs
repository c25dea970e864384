//! The clearing of the shelf when there is too much: by the order of creation, whatever the clock said.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, SystemTime};

use quell::recording::{Channel, Recording, Role};
use quell::service::config::{Config, Overrides};
use quell::service::recorder::{About, Bounds, Shelf};

use super::{BOUNDS, names};

const DAY: f64 = 86_400.0;

/// Puts a recording onto the shelf, made at a wall time, s.
fn put(shelf: &Shelf, name: &str, unix_time_s: f64) {
    let about = About {
        unix_time_s,
        ..About::default()
    };
    let channel = Channel {
        role: Role::CommandPosition,
        unit: "rad".into(),
        time: vec![0.0, 0.1],
        columns: vec![vec![0.0, 1.0]],
    };
    let recording = Recording {
        name: name.into(),
        payload: None,
        channels: vec![channel],
    };
    let kept = shelf.put(name, &about, |draft| draft.recording(&recording));
    assert_eq!(kept.expect("there is room"), name);
}

fn listed(shelf: &Shelf) -> Vec<String> {
    let list = shelf.list().expect("a list");
    list.into_iter().map(|entry| entry.name).collect()
}

/// As though it had been written so long ago: what a clock that jumps forward makes of it.
fn age(folder: &Path, days: f64) {
    let then = SystemTime::now() - Duration::from_secs_f64(days * DAY);
    for name in std::fs::read_dir(folder).expect("a folder") {
        let file = File::open(name.expect("a file").path()).expect("a file");
        file.set_modified(then).expect("a time");
    }
    let folder = File::open(folder).expect("a folder");
    folder.set_modified(then).expect("a time");
}

#[test]
fn a_clock_that_jumps_deletes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    for name in ["a", "b", "c"] {
        put(&shelf, name, 1.7e9);
        age(&folder.path().join(name), 400.0);
    }
    let again = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    assert_eq!(listed(&again), ["a", "b", "c"]);
    assert!(again.tidy().expect("tidy").is_empty());
}

#[test]
fn the_first_made_go_first_although_the_clock_ran_backwards() {
    let folder = tempfile::tempdir().expect("a folder");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    // Each is younger by the clock than what was made after it, over a restart too.
    for (index, name) in ["d", "c"].into_iter().enumerate() {
        put(&shelf, name, 1.7e9 - 100.0 * DAY * index as f64);
        age(&folder.path().join(name), 100.0 * index as f64);
    }
    drop(shelf);
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    for (index, name) in ["b", "a"].into_iter().enumerate() {
        put(&shelf, name, 1e9 - 100.0 * DAY * index as f64);
        age(&folder.path().join(name), 1000.0 + 100.0 * index as f64);
    }
    assert_eq!(listed(&shelf), ["d", "c", "b", "a"]);
    let bounds = Bounds { count: 2, ..BOUNDS };
    let shelf = Shelf::open(folder.path(), bounds).expect("a shelf");
    assert_eq!(listed(&shelf), ["b", "a"]);
}

#[test]
fn the_last_ones_stay_however_large_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let bounds = |last| Bounds {
        bytes: 1,
        count: 1,
        last,
    };
    let shelf = Shelf::open(folder.path(), bounds(3)).expect("a shelf");
    for name in ["a", "b", "c", "d"] {
        put(&shelf, name, 0.0);
    }
    assert_eq!(shelf.tidy().expect("tidy"), ["a"]);
    assert_eq!(listed(&shelf), ["b", "c", "d"]);
    // The newest stays in any case.
    let shelf = Shelf::open(folder.path(), bounds(0)).expect("a shelf");
    assert_eq!(listed(&shelf), ["d"]);
    assert_eq!(names(folder.path()), ["d"]);
}

#[test]
fn those_of_an_earlier_version_are_the_oldest() {
    let folder = tempfile::tempdir().expect("a folder");
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    put(&shelf, "new", 0.0);
    for (name, time) in [("second", 2e9), ("first", 1e9)] {
        put(&shelf, name, time);
        // They had no number.
        let path = folder.path().join(name).join("about.json");
        let text = std::fs::read(&path).expect("a file");
        let mut about: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
        about.as_object_mut().expect("an object").remove("number");
        std::fs::write(&path, about.to_string()).expect("a file");
    }
    let shelf = Shelf::open(folder.path(), Bounds { count: 2, ..BOUNDS }).expect("a shelf");
    assert_eq!(listed(&shelf), ["second", "new"]);
}

#[test]
fn what_was_half_removed_at_a_kill_goes_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join(".leaving-a")).expect("a folder");
    let _ = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn the_configuration_says_what_has_replaced_the_age() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("quell.toml");
    let refused = |text: &str| {
        std::fs::write(&file, text).expect("a file");
        let error = Config::load(Some(&file), &Overrides::default()).err();
        error.expect("refused").to_string()
    };
    let age = refused("[recording]\nmax_age_days = 30\n");
    for word in ["max_age_days = 30", "max_size_mb", "max_count", "keep_last"] {
        assert!(age.contains(word), "{age}");
    }
    let both = refused("[recording]\nenabled = false\nrequired = true\n");
    assert!(both.contains("recording.required"), "{both}");
    let none = refused("[recording]\nkeep_last = 0\n");
    assert!(none.contains("recording.keep_last = 0"), "{none}");
}
