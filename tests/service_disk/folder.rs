//! One folder, one service.

use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use quell::service::disk::{Disk, FileSystem, FolderError};

use super::process::{arguments, serve};

#[test]
fn a_second_service_on_a_folder_is_refused_in_one_sentence() {
    let data = tempfile::tempdir().expect("a folder");
    let first = serve(data.path());
    let second = Command::new(env!("CARGO_BIN_EXE_quell"))
        .args(arguments(data.path()))
        .output()
        .expect("it runs");
    assert!(!second.status.success());
    let said = String::from_utf8_lossy(&second.stderr).replace(['\n', '│', ' '], "");
    let pid = format!("process{},since", first.child.id());
    let folder = data.path().display().to_string();
    for word in [pid.as_str(), folder.as_str(), "isinuseby"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    // A service that was killed leaves its file, and not its lock.
    drop(first);
    assert!(data.path().join("quell.lock").exists());
    drop(serve(data.path()));
}

#[test]
fn the_lock_is_held_as_long_as_anybody_may_write() {
    let data = tempfile::tempdir().expect("a folder");
    let open = || Disk::of(data.path(), Arc::new(FileSystem));
    let disk = open().expect("a free folder");
    let clone = disk.clone();
    drop(disk);
    match open() {
        Err(FolderError::Taken { folder, holder }) => {
            assert_eq!(folder, data.path());
            let pid = format!("process {},", std::process::id());
            assert!(holder.starts_with(&pid), "{holder}");
        }
        other => panic!("{other:?}"),
    }
    drop(clone);
    open().expect("free again");
}

/// A child that is being started has a copy of every open file until its program replaces ours.
#[test]
fn the_lock_is_free_when_it_is_given_back_although_children_are_being_started() {
    let data = tempfile::tempdir().expect("a folder");
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                let child = Command::new(env!("CARGO_BIN_EXE_quell"))
                    .arg("--version")
                    .output();
                assert!(child.expect("it runs").status.success());
            }
        });
        let taken = (0..2000).find_map(|_| Disk::of(data.path(), Arc::new(FileSystem)).err());
        done.store(true, Ordering::Relaxed);
        assert!(taken.is_none(), "{taken:?}");
    });
}
