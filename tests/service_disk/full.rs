//! A disk that is full, at any call: what is told to be there is there, also after a kill.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

use quell::service::contract::{DiskState, EngineEnds, Handle, RecordingNews, Snapshot, channels};
use quell::service::disk::{Disk, Storage};
use quell::service::recorder::{RecordError, Recorder, Shelf};
use quell::service::state::{State, StateFile};
use tokio::sync::mpsc::UnboundedReceiver;

use super::faulty::Faulty;
use super::moves::a_move;
use super::wary::Wary;
use super::{BOUNDS, check_recording, names};

fn runtime() -> tokio::runtime::Runtime {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build();
    runtime.expect("a runtime")
}

fn recorder(folder: &Path, storage: Arc<dyn Storage>) -> (Recorder, Handle, EngineEnds) {
    let (handle, ends) = channels(Snapshot::default());
    let shelf = Shelf::on(folder, BOUNDS, Disk::new(storage)).expect("a shelf");
    (Recorder::start(&handle, shelf), handle, ends)
}

/// Which recordings are told to be there, by name.
fn told(ends: &mut EngineEnds) -> BTreeMap<String, u64> {
    heard(&mut ends.recordings, BTreeMap::new())
}

fn heard(
    recordings: &mut UnboundedReceiver<RecordingNews>,
    mut there: BTreeMap<String, u64>,
) -> BTreeMap<String, u64> {
    while let Ok(news) = recordings.try_recv() {
        match news {
            RecordingNews::Kept { move_id, name } => there.insert(name, move_id),
            RecordingNews::Gone { name } => there.remove(&name),
        };
    }
    there
}

/// Two moves on a disk, and the end of the process. What was told to be there, then.
fn two_moves(folder: &Path, storage: Arc<dyn Storage>) -> BTreeMap<String, u64> {
    runtime().block_on(async {
        let (recorder, _handle, mut ends) = recorder(folder, storage);
        for id in 1..=2 {
            for batch in a_move(id) {
                ends.stream.send(Arc::new(batch)).expect("a listener");
            }
        }
        recorder.close().await;
        told(&mut ends)
    })
}

/// Two moves, and a kill just before a call: to the disk it is one that takes nothing from then on. What
/// had been told to be there when it came.
fn killed(folder: &Path, last: u64) -> BTreeMap<String, u64> {
    type Heard = (
        Option<UnboundedReceiver<RecordingNews>>,
        BTreeMap<String, u64>,
    );
    let heard_so_far = Arc::new(Mutex::new(Heard::default()));
    let at_the_kill = Arc::clone(&heard_so_far);
    let disk = Faulty::new(move |call, _| {
        let mut so_far = at_the_kill.lock().expect("no panic");
        if call >= last
            && let Some(mut recordings) = so_far.0.take()
        {
            so_far.1 = heard(&mut recordings, BTreeMap::new());
        }
        call >= last
    });
    runtime().block_on(async {
        let (recorder, _handle, ends) = recorder(folder, Arc::new(disk));
        heard_so_far.lock().expect("no panic").0 = Some(ends.recordings);
        for id in 1..=2 {
            for batch in a_move(id) {
                ends.stream.send(Arc::new(batch)).expect("a listener");
            }
        }
        recorder.close().await;
    });
    let so_far = heard_so_far.lock().expect("no panic");
    assert!(so_far.0.is_none(), "call {last} was never made");
    so_far.1.clone()
}

/// Starts anew on a disk that works, and holds against it what was told.
fn hold(folder: &Path, told: &BTreeMap<String, u64>, words: &str) {
    let shelf = Shelf::open(folder, BOUNDS).expect("a shelf");
    for (name, id) in told {
        let path = shelf.path(name);
        let path = path.unwrap_or_else(|error| panic!("{words}: {name} was told: {error}"));
        check_recording(&path);
        let about = shelf.about(name).expect("a file");
        assert!(
            about.result.is_none_or(|result| result.id == *id),
            "{words}"
        );
    }
    let hidden = names(folder).into_iter().find(|name| name.starts_with('.'));
    assert_eq!(hidden, None, "{words}: nothing is left unfinished");
}

#[test]
fn a_kill_or_a_full_disk_at_any_call_loses_nothing_that_was_told() {
    let calls = {
        let folder = tempfile::tempdir().expect("a folder");
        let disk = Faulty::new(|_, _| false);
        let there = two_moves(folder.path(), Arc::new(disk.clone()));
        assert_eq!(there.len(), 2);
        hold(folder.path(), &there, "a disk that works");
        disk.calls()
    };
    assert!(calls > 60, "{calls}");
    let mut most = 0;
    for first in 0..calls {
        let folder = tempfile::tempdir().expect("a folder");
        let there = killed(folder.path(), first);
        most = most.max(there.len());
        hold(folder.path(), &there, &format!("killed at call {first}"));
        let folder = tempfile::tempdir().expect("a folder");
        let disk = Faulty::new(move |call, _| call >= first);
        let there = two_moves(folder.path(), Arc::new(disk));
        hold(folder.path(), &there, &format!("full from call {first} on"));
        // A disk that has room again after a few calls.
        let folder = tempfile::tempdir().expect("a folder");
        let disk = Faulty::new(move |call, _| (first..first + 7).contains(&call));
        let there = two_moves(folder.path(), Arc::new(disk));
        hold(
            folder.path(),
            &there,
            &format!("full at seven calls from {first} on"),
        );
    }
}

#[test]
fn a_full_disk_is_told_and_so_is_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = Faulty::new(|_, _| true);
    runtime().block_on(async {
        let (recorder, _handle, mut ends) = recorder(folder.path(), Arc::new(disk.clone()));
        for batch in a_move(1) {
            ends.stream.send(Arc::new(batch)).expect("a listener");
        }
        let refused = match recorder.begin("joint_1", 0).await {
            Err(RecordError::NotKept { reason, .. }) => reason,
            other => panic!("{other:?}"),
        };
        assert!(refused.contains("no storage space"), "{refused}");
        let handle = recorder.shelf().disk().clone();
        let view = handle.view();
        assert_eq!((view.state, view.faults.len()), (DiskState::Failing, 1));
        assert!(view.faults[0].reason.contains("no storage space"));
        assert!(view.faults[0].since_unix_time_s > 1e9);
        // There is room again: the next move is recorded, and the fault is over.
        disk.refuse(|_, _| false);
        for batch in a_move(2) {
            ends.stream.send(Arc::new(batch)).expect("a listener");
        }
        recorder.close().await;
        let view = handle.view();
        assert_eq!((view.state, view.faults.len()), (DiskState::Fine, 0));
        let there = told(&mut ends);
        assert!(there.contains_key("move-000002"), "{there:?}");
        hold(folder.path(), &there, "at the end");
    });
}

#[test]
fn what_the_disk_had_taken_is_put_onto_the_shelf_when_there_is_room_again() {
    let folder = tempfile::tempdir().expect("a folder");
    // It grows on the disk, and cannot be made whole.
    let is_csv = |path: &Path| path.to_string_lossy().ends_with(".csv.gz");
    let disk = Faulty::new(move |_, path| is_csv(path));
    runtime().block_on(async {
        let (recorder, _handle, mut ends) = recorder(folder.path(), Arc::new(disk.clone()));
        for batch in a_move(1) {
            ends.stream.send(Arc::new(batch)).expect("a listener");
        }
        while recorder.shelf().disk().view().recordings_lost == 0 {
            tokio::time::sleep(std::time::Duration::from_millis(1)).await;
        }
        let there = told(&mut ends);
        assert!(there.is_empty(), "withdrawn: {there:?}");
        // It may just be asked whether there is room.
        let left = names(folder.path()).into_iter();
        let left: Vec<_> = left.filter(|name| !name.starts_with(".leaving-")).collect();
        assert_eq!(left, [".unfinished-move-000001"]);
        disk.refuse(|_, _| false);
        // Nothing moves; time goes on.
        let mut rest = a_move(2);
        rest.iter_mut().for_each(|batch| batch.events.clear());
        for batch in rest {
            ends.stream.send(Arc::new(batch)).expect("a listener");
        }
        recorder.close().await;
        let there = told(&mut ends);
        assert_eq!(there.get("move-000001"), Some(&1), "{there:?}");
        assert_eq!(names(folder.path()), ["move-000001"]);
        let part = check_recording(&folder.path().join("move-000001"));
        assert!(part.channels[0].time.len() > 100);
        let about = recorder.shelf().about("move-000001").expect("a file");
        assert_eq!(about.result.map(|result| result.id), Some(1));
    });
}

#[test]
fn a_recording_is_told_only_once_it_is_on_the_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    runtime().block_on(async {
        let disk = Faulty::new(|_, _| false);
        let (recorder, handle, mut ends) = recorder(folder.path(), Arc::new(disk));
        for batch in &a_move(1)[..11] {
            ends.stream
                .send(Arc::new(batch.clone()))
                .expect("a listener");
        }
        while ends.recordings.is_empty() {
            tokio::task::yield_now().await;
        }
        let there = told(&mut ends);
        assert_eq!(there.get("move-000001"), Some(&1));
        assert_eq!(names(folder.path()), [".unfinished-move-000001"]);
        // It is told to be unfinished to whoever asks for it.
        let error = recorder.shelf().path("move-000001").expect_err("not yet");
        assert!(error.to_string().contains("not finished"), "{error}");
        // The process is killed here: nobody closes anything.
        drop((recorder, handle, ends));
    });
    let shelf = Shelf::open(folder.path(), BOUNDS).expect("a shelf");
    check_recording(&shelf.path("move-000001").expect("it was told"));
}

#[test]
fn what_takes_a_name_is_on_the_medium() {
    let folder = tempfile::tempdir().expect("a folder");
    let wary = Arc::new(Wary::default());
    let there = two_moves(folder.path(), Arc::clone(&wary) as Arc<dyn Storage>);
    assert_eq!(there.len(), 2);
    let disk = Disk::new(Arc::clone(&wary) as Arc<dyn Storage>);
    let file = quell::service::state::StateFile::within(folder.path(), disk);
    file.save(&Default::default()).expect("a state");
    let renamed = wary.renamed.lock().expect("no panic");
    assert!(renamed.is_empty(), "names that may be lost: {renamed:?}");
}

/// Recordings have taken all that there is: the state goes into the room that was kept for it.
#[test]
fn a_full_disk_takes_the_next_state_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let room = folder.path().join("state.json.room");
    let faulty = Faulty::new(|_, _| false);
    let file = StateFile::within(folder.path(), Disk::new(Arc::new(faulty.clone())));
    let state = |last_move| State {
        last_move,
        ..State::default()
    };
    file.save(&state(1)).expect("room");
    let kept = std::fs::metadata(&room).expect("room is kept").len();
    assert!(
        kept >= std::fs::metadata(folder.path().join("state.json"))
            .expect("a state")
            .len()
    );
    // What is not the room itself has none, as long as that is there.
    let there = room.clone();
    faulty.refuse(move |_, path| path.ends_with("state.json.new") && there.exists());
    for last_move in [2, 3] {
        file.save(&state(last_move))
            .expect("the room that was kept");
        assert_eq!(file.load(0.001).last_move, last_move);
        assert!(room.exists(), "it is kept again");
    }
    // A disk that takes nothing at all.
    faulty.refuse(|_, _| true);
    assert!(file.save(&state(4)).is_err());
    assert_eq!(file.load(0.001).last_move, 3);
}
