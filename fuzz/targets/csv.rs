//! A CSV file: its first column as stamps, the second as a motor position.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::recording::Table;
use quell_fuzz::{Folder, check_table};
use std::sync::LazyLock;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.write("input.csv", bytes);
    if let Ok(table) = Table::open(&path) {
        check_table(&table, &FOLDER);
    }
});
