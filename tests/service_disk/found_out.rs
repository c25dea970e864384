//! A folder of recordings that can take none: the state says so, also while nothing is recorded and while files are open.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use quell::service::contract::{
    Batch, DiskState, EngineEnds, Event, Handle, MoveResult, MoveStart, RecordingNews, Snapshot,
    channels,
};
use quell::service::disk::{Disk, FileSystem, make_folder};
use quell::service::recorder::{Recorder, Shelf};

use super::moves::a_move;
use super::{BOUNDS, check_recording, names};

/// Something that happens to a folder, which goes to another place.
type Happens = fn(&Path, &Path);

/// What happens to a folder of recordings, and what is told of it.
const HAPPENS: [(Happens, &str); 2] = [
    (taken_away, "the folder is gone"),
    (made_a_file, "it is a file, and a folder is needed"),
];

fn taken_away(folder: &Path, away: &Path) {
    fs::rename(folder, away).expect("it goes");
}

fn made_a_file(folder: &Path, away: &Path) {
    taken_away(folder, away);
    fs::write(folder, "a file").expect("a file");
}

fn brought_back(folder: &Path, away: &Path) {
    if folder.is_file() {
        fs::remove_file(folder).expect("it goes");
    }
    fs::rename(away, folder).expect("it comes back");
}

/// A recorder on a real folder, driven by the times of its batches.
struct Driven {
    _data: tempfile::TempDir,
    folder: PathBuf,
    away: PathBuf,
    recorder: Recorder,
    _handle: Handle,
    ends: EngineEnds,
    there: BTreeMap<String, u64>,
}

impl Driven {
    fn new() -> Self {
        let data = tempfile::tempdir().expect("a folder");
        let (folder, away) = (data.path().join("recordings"), data.path().join("away"));
        let (handle, ends) = channels(Snapshot::default());
        let shelf = Shelf::on(&folder, BOUNDS, Disk::new(Arc::new(FileSystem)));
        Self {
            recorder: Recorder::start(&handle, shelf.expect("a shelf")),
            _data: data,
            folder,
            away,
            _handle: handle,
            ends,
            there: BTreeMap::new(),
        }
    }

    /// Sends batches, and waits until all are taken.
    async fn take(&mut self, batches: &[Batch]) {
        for batch in batches {
            let batch = Arc::new(batch.clone());
            self.ends.stream.send(batch).expect("a listener");
        }
        // What has arrived is taken before a request: one that is refused, as nothing runs on demand.
        assert!(self.recorder.end().await.is_err());
        while let Ok(news) = self.ends.recordings.try_recv() {
            match news {
                RecordingNews::Kept { move_id, name } => self.there.insert(name, move_id),
                RecordingNews::Gone { name } => self.there.remove(&name),
            };
        }
    }

    fn assert_failing(&self, words: &str) {
        let view = self.recorder.shelf().disk().view();
        assert_eq!(view.state, DiskState::Failing, "{words}");
        let told = format!("{}: {words}", self.folder.display());
        assert_eq!(view.faults[0].reason, told);
    }

    fn assert_fine(&self) {
        let view = self.recorder.shelf().disk().view();
        assert_eq!(view.state, DiskState::Fine, "{view:?}");
    }
}

/// Nothing moves; time goes on from the end of a move.
fn rest_from(start: f64) -> Vec<Batch> {
    let mut rest = a_move(9);
    for batch in &mut rest {
        batch.events.clear();
        batch.time += start;
        batch.ticks.iter_mut().for_each(|row| row.time += start);
        for one in &mut batch.measured {
            (one.received, one.stamp) = (one.received + start, one.stamp + start);
        }
    }
    rest
}

/// A move of two joints.
fn a_move_of_two() -> Vec<Batch> {
    let mut batches = a_move(1);
    for batch in &mut batches {
        let (ticks, measured) = (batch.ticks.clone(), batch.measured.clone());
        let second = ticks.into_iter().map(|mut row| {
            row.joint = 1;
            row
        });
        batch.ticks.extend(second);
        let second = measured.into_iter().map(|mut one| {
            one.joint = 1;
            one
        });
        batch.measured.extend(second);
    }
    let (joint, name) = ("joint_2", Some("move-000002".to_owned()));
    batches[10].events.push(Event::MoveStarted(MoveStart {
        id: 2,
        joint: joint.into(),
        joint_index: 1,
        time_s: 2.0,
        recording: name.clone(),
        ..MoveStart::default()
    }));
    let ended = MoveResult {
        id: 2,
        joint: joint.into(),
        recording: name,
        ..MoveResult::default()
    };
    // The second goes on for longer.
    batches[17].events.push(Event::MoveEnded(Box::new(ended)));
    batches
}

fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread().build();
    runtime.expect("a runtime").block_on(test);
}

#[test]
fn a_folder_that_takes_nothing_is_told_before_the_next_move() {
    run(async {
        for (happens, words) in HAPPENS {
            let mut driven = Driven::new();
            driven.take(&rest_from(0.0)).await;
            driven.assert_fine();
            happens(&driven.folder, &driven.away);
            driven.take(&rest_from(4.5)).await;
            driven.assert_failing(words);
            brought_back(&driven.folder, &driven.away);
            driven.take(&rest_from(9.0)).await;
            driven.assert_fine();
            assert_eq!(driven.recorder.shelf().disk().view().recordings_lost, 0);
        }
    });
}

/// Whoever has a file open can write on into it, wherever it is: that is no folder that takes recordings.
#[test]
fn a_folder_that_goes_under_open_files_is_told_and_the_recordings_are_whole_when_it_is_back() {
    run(async {
        for (happens, words) in HAPPENS {
            let mut driven = Driven::new();
            let batches = a_move_of_two();
            driven.take(&batches[..14]).await;
            driven.assert_fine();
            assert_eq!(driven.there.len(), 2, "{:?}", driven.there);
            happens(&driven.folder, &driven.away);
            driven.take(&batches[14..17]).await;
            driven.assert_failing(words);
            assert_eq!(driven.there.len(), 0, "withdrawn: {:?}", driven.there);
            brought_back(&driven.folder, &driven.away);
            driven.take(&batches[17..]).await;
            driven.take(&rest_from(4.5)).await;
            driven.assert_fine();
            assert_eq!(names(&driven.folder), ["move-000001", "move-000002"]);
            assert_eq!(driven.there.len(), 2, "{:?}", driven.there);
            for name in ["move-000001", "move-000002"] {
                let rows = check_recording(&driven.folder.join(name)).channels[0]
                    .time
                    .len();
                assert!(rows > 250, "{name}: {rows}");
            }
            assert_eq!(driven.recorder.shelf().disk().view().recordings_lost, 0);
        }
    });
}

/// One of two is lost: what the other has open does not make the folder one that works.
#[test]
fn a_recording_that_is_lost_is_told_while_another_goes_on() {
    run(async {
        let mut driven = Driven::new();
        let batches = a_move_of_two();
        driven.take(&batches[..14]).await;
        made_a_file(&driven.folder, &driven.away);
        // The first ends, and its rest after it.
        driven.take(&batches[14..21]).await;
        driven.assert_failing("it is a file, and a folder is needed");
        assert_eq!(driven.recorder.shelf().disk().view().recordings_lost, 1);
        driven.take(&batches[21..]).await;
        driven.take(&rest_from(4.5)).await;
        driven.assert_failing("it is a file, and a folder is needed");
        assert_eq!(driven.recorder.shelf().disk().view().recordings_lost, 2);
        brought_back(&driven.folder, &driven.away);
        driven.take(&rest_from(9.0)).await;
        driven.assert_fine();
        // As far as the disk had taken them.
        assert_eq!(names(&driven.folder), ["move-000001", "move-000002"]);
    });
}

#[test]
fn a_file_in_the_place_of_a_folder_is_told_at_the_start() {
    let data = tempfile::tempdir().expect("a folder");
    let path = data.path().join("recordings");
    fs::write(&path, "a file").expect("a file");
    let told = format!("{}: it is a file, and a folder is needed", path.display());
    let refused = Shelf::open(&path, BOUNDS).expect_err("no folder");
    assert_eq!(refused.to_string(), told);
    assert!(make_folder(&path).is_err());
    assert_eq!(fs::read(&path).expect("it is left alone"), b"a file");
}
