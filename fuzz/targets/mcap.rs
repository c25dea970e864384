//! An MCAP file: its topics, every field of them, and every joint.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::recording::McapFile;
use quell_fuzz::{Folder, check_recording};
use std::sync::LazyLock;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

/// Fields of a topic that are read: definitions can name thousands.
const FIELDS: usize = 8;

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.write("input.mcap", bytes);
    let file = match McapFile::open(&path) {
        Ok(file) => file,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    file.remarks();
    for topic in file.topics() {
        topic.rate_hz();
        for field in topic.fields().iter().take(FIELDS) {
            for field in [field.clone(), field.replace("[]", "[0]")] {
                let numbers = file.numbers(&topic.name, &[&field], Some("log_time"));
                if let Ok((time, columns)) = numbers {
                    assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
                    assert!(columns.iter().all(|column| column.len() == time.len()));
                    assert!(columns.iter().flatten().all(|value| value.is_finite()));
                }
            }
        }
    }
    for joint in file.joints() {
        file.roles(&joint);
        if let Ok(recording) = file.recording(Some(&joint)) {
            check_recording(recording, &FOLDER);
        }
    }
});
