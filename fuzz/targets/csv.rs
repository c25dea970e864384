//! A CSV file: its first column as stamps, the second as a motor position.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::recording::{Recording, Role, Table};
use quell_fuzz::{Folder, check_recording};
use std::sync::LazyLock;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.write("input.csv", bytes);
    let Ok(table) = Table::open(&path) else {
        return;
    };
    let width = table.header().len();
    for row in table.rows().flatten() {
        assert_eq!(row.len(), width);
    }
    let [first, second, ..] = table.header() else {
        return;
    };
    for rate_hz in [250.0, 1.0] {
        let _ = table
            .stamps_at_rate(first, rate_hz)
            .map_err(|error| error.to_string());
    }
    let (time, columns) = match (table.stamps(first), table.numbers(&[second])) {
        (Ok(time), Ok(columns)) => (time, columns),
        (time, columns) => {
            let told = [time.err(), columns.err()].into_iter().flatten();
            return told.for_each(|error| assert!(!error.to_string().is_empty()));
        }
    };
    let (role, unit) = (Role::MotorPosition, "rad".into());
    let channels = vec![quell::recording::Channel {
        role,
        unit,
        time,
        columns,
    }];
    check_recording(
        Recording {
            name: String::new(),
            payload: None,
            channels,
        },
        &FOLDER,
    );
});
