//! The data folder under faults: a full disk at any call, kills, a clock that jumps, a second service.

#[path = "../service_http/client.rs"]
mod client;
mod ended;
mod faulty;
mod folder;
mod found_out;
mod full;
mod kill;
mod limited;
#[path = "../moves/mod.rs"]
mod moves;
mod process;
mod retention;
mod salvage;
mod service;
mod wary;

use std::path::Path;

use quell::recording::Recording;
use quell::service::recorder::Bounds;

/// More than any test here takes.
const BOUNDS: Bounds = Bounds {
    bytes: 100_000_000,
    count: 1000,
    last: 1,
};

/// Names in a folder, the hidden ones too, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.expect("an entry");
        entry.file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<_> = entries.map(name).collect();
    names.sort();
    names
}

/// Holds a recording on the shelf against what others expect of one: the manifest is read, the MCAP file
/// has what the reader of the format's own library wants, and both have the same commands.
fn check_recording(folder: &Path) -> Recording {
    let recording = Recording::from_path(folder).expect("a recording");
    let bytes = std::fs::read(folder.join("recording.mcap")).expect("a file");
    let messages = mcap::MessageStream::new(&bytes).expect("an MCAP file that is whole");
    let messages = messages.collect::<Result<Vec<_>, _>>();
    let messages = messages.expect("messages").len();
    let summary = mcap::Summary::read(&bytes).expect("a footer");
    let statistics = summary.and_then(|summary| summary.stats);
    let counted = statistics.expect("a summary").message_count;
    assert_eq!(counted as usize, messages);
    let same = Recording::from_path(folder.join("recording.mcap")).expect("a recording");
    let of = |recording: &Recording| recording.channels[0].columns.clone();
    assert_eq!(of(&same), of(&recording), "{}", folder.display());
    recording
}
