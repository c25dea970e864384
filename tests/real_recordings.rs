//! The public recordings of `examples/`: that their manifests read as they say. The recordings are
//! not part of the project; where they are absent, a test says so and returns.

use quell::diagnosis::{Options, Outcome, diagnose, score};
use quell::model::Model;
use quell::recording::{Recording, Role};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A copy of an example's folder whose manifests point to the recordings of `QUELL_RECORDINGS`, else of
/// `../shared/recordings` beside the project. Where those are absent, says so and gives nothing.
fn example(name: &str, recordings: &str) -> Option<TempDir> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shared = match std::env::var_os("QUELL_RECORDINGS") {
        Some(folder) => PathBuf::from(folder),
        None => root.join("../shared/recordings"),
    };
    let Ok(shared) = shared.join(recordings).canonicalize() else {
        println!(
            "skipped: {name} needs {}",
            shared.join(recordings).display()
        );
        return None;
    };
    let folder = TempDir::new().unwrap();
    for file in std::fs::read_dir(root.join("examples").join(name)).unwrap() {
        let file = file.unwrap();
        let text = std::fs::read_to_string(file.path()).unwrap();
        let text = text.replace("file = \"", &format!("file = \"{}/", shared.display()));
        std::fs::write(folder.path().join(file.file_name()), text).unwrap();
    }
    Some(folder)
}

/// Folder, manifest, roles, unit, rate and range of rows.
type Row = (
    &'static str,
    &'static str,
    &'static [Role],
    &'static str,
    f64,
    [usize; 2],
);

#[test]
fn examples_read_as_they_say() {
    use Role::*;
    let rows: &[Row] = &[
        (
            "emps",
            "emps",
            &[CommandPosition, MotorPosition],
            "m",
            1e3,
            [18703, 6138],
        ),
        (
            "silverbox",
            "silverbox",
            &[Force, LinkPosition],
            "V",
            610.3516,
            [10000, 40495],
        ),
        (
            "quanser",
            "quanser_2dsfl",
            &[MotorCurrent, MotorPosition, Deformation],
            "rad",
            500.0,
            [5000, 5000],
        ),
        (
            "friction_damper",
            "arts_friction_backlash",
            &[LinkPosition, Force],
            "N",
            1024.0,
            [4096, 18433],
        ),
        (
            "daisy_robot_arm",
            "daisy_robot_arm",
            &[Torque, LinkAcceleration],
            "raw",
            1.0,
            [683, 341],
        ),
        (
            "flexarm",
            "flexarm_ist",
            &[MotorVoltage, MotorPosition],
            "rad",
            50.0,
            [940, 320],
        ),
    ];
    for (name, recordings, roles, unit, rate_hz, counts) in rows {
        let Some(folder) = example(name, recordings) else {
            continue;
        };
        let mut ends = [f64::NAN; 2];
        for (index, part) in ["train.toml", "held_out.toml"].iter().enumerate() {
            let recording = Recording::from_path(folder.path().join(part)).unwrap();
            let found: Vec<Role> = recording.channels.iter().map(|c| c.role).collect();
            assert_eq!(&found, roles, "{name}, {part}");
            let last = recording.channels.last().unwrap();
            assert_eq!(last.unit, *unit, "{name}, {part}");
            assert_eq!(last.time.len(), counts[index], "{name}, {part}");
            let span = last.time[last.time.len() - 1] - last.time[0];
            let rate = (last.time.len() - 1) as f64 / span;
            assert!(
                (rate / rate_hz - 1.0).abs() < 1e-4,
                "{name}, {part}: {rate}"
            );
            ends[index] = last.time[0];
        }
        // Parts of one file keep its clock; two files begin at 0 both.
        let two_files = *name == "friction_damper";
        assert_eq!(ends[0] == ends[1], two_files, "{name}: {ends:?}");
    }
}

/// What a diagnosis of an example says, and what its model scores on the held-out part.
fn diagnosed(folder: &TempDir) -> (Outcome, quell::diagnosis::Score) {
    let read = |part: &str| Recording::from_path(folder.path().join(part)).unwrap();
    let model = Model::from_path(folder.path().join("model.toml")).unwrap();
    let (train, held_out) = (read("train.toml"), read("held_out.toml"));
    let options = Options::default();
    let outcome = diagnose(
        &model,
        &[train],
        std::slice::from_ref(&held_out),
        &options,
        &|_, _| (),
    );
    let outcome = outcome.unwrap();
    let scored = score(&outcome.model, &held_out).unwrap();
    (outcome, scored)
}

/// De Moor's data set is explained to 76.5 % by one mode and the direct term, to more than 89 % by two.
#[test]
fn the_flexible_robot_arm_has_a_second_mode() {
    let Some(folder) = example("daisy_robot_arm", "daisy_robot_arm") else {
        return;
    };
    let (outcome, scored) = diagnosed(&folder);
    let findings = &outcome.diagnosis.findings;
    assert_eq!(findings[0].effect, "second_mode");
    assert!(scored.fit_percent > 89.0, "{}", scored.fit_percent);
}

/// Slip in the damper's band: 57 % of the force is left by spring and dashpot, less than 16 % with a
/// force that remembers the way. Coulomb friction leaves 56 %.
#[test]
fn the_friction_damper_remembers_its_way() {
    let Some(folder) = example("friction_damper", "arts_friction_backlash") else {
        return;
    };
    let (outcome, scored) = diagnosed(&folder);
    let found = outcome.diagnosis.findings[0].effect.as_str();
    let memory = ["presliding_hysteresis", "hysteretic_stiffness"];
    assert!(memory.contains(&found), "{found}");
    assert!(scored.fit_percent > 84.0, "{}", scored.fit_percent);
}
