//! A Parquet file: every column, then the first as stamps and the second as a motor position.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::recording::Table;
use quell_fuzz::{Folder, check_table};
use std::sync::LazyLock;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.write("input.parquet", bytes);
    match Table::open(&path) {
        Ok(table) => check_table(&table, &FOLDER),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
