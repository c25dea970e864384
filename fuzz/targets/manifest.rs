//! A manifest beside two CSV files and one MCAP file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::recording::{McapWriter, Recording, Role};
use quell_fuzz::{Folder, check_recording};
use std::sync::LazyLock;

static FOLDER: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::default();
    folder.write(
        "a.csv",
        b"t,q,x,y,z\n0,1,0,0,1\n0.1,2,0,1,1\n0.2,-3,0,2,1e300\n",
    );
    folder.write("b.csv", b"t;q\n0;1e-310\n0.001;nan\n");
    let path = folder.path().join("run.mcap");
    let file = Box::new(std::fs::File::create(&path).expect("a file"));
    let mut writer = McapWriter::on(file, &path, &["hip"], 1_000_000_000).expect("a file");
    for tick in 0..9 {
        let time = f64::from(tick) / 250.0;
        let written = writer.write_command(time, "hip", time, 1.0, 0.0);
        written.expect("a command");
        let written = writer.write_sample(time, "hip", Role::MotorPosition, time, &[0.4]);
        written.expect("a sample");
    }
    writer.finish().expect("the end");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    // A device is a file, too, and does not end.
    if bytes.windows(4).any(|window| window == b"/dev") {
        return;
    }
    let path = FOLDER.write("recording.toml", bytes);
    match Recording::from_path(&path) {
        Ok(recording) => check_recording(recording, &FOLDER),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
