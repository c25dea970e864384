//! The diagnosis of all joints of a robot, each with the loads that its description gives along the motion of
//! all.

mod overview;
mod prepared;

use super::{Args, on_threads};
use crate::cli::out::{Out, Stage};
use crate::cli::progress::Progress;
use crate::cli::{CliError, next, output};
use crate::diagnosis::{Outcome, Verdict, diagnose};
use crate::model::{Model, Value};
use crate::recording::Recording;
use crate::report::page;
use crate::signal::read_urdf_tree;
use nalgebra::Vector3;
use prepared::Prepared;
use std::path::{Path, PathBuf};

/// Steps of the progress bar for a joint.
const STEPS: f64 = 100.0;
/// Files of the whole robot.
const FILES: [&str; 2] = ["index.html", "robot.json"];

/// The result of one joint.
pub(super) struct Told {
    pub joint: String,
    /// Its folder within that of --out.
    pub folder: String,
    pub outcome: Result<Outcome, String>,
}

/// Diagnoses every recorded joint, and prints the results.
///
/// # Errors
/// [`CliError::Input`] where description, models or recordings are refused, or a joint was set aside.
pub fn run(description: &Path, args: &Args) -> Result<(), CliError> {
    let tree = read_urdf_tree(description).map_err(CliError::input)?;
    let gravity = gravity(&args.gravity)?;
    let read = |paths: &[PathBuf]| -> Result<Vec<Prepared>, CliError> {
        let all = paths
            .iter()
            .map(|path| Prepared::read(&tree, gravity, path));
        all.collect()
    };
    let (train, held_out) = (read(&args.recordings)?, read(&args.held_out)?);
    let joints = joints(&train);
    let names = joints.iter().flat_map(|joint| {
        let folder = PathBuf::from(folder(joint));
        super::FILES.map(|file| folder.join(file))
    });
    let names: Vec<PathBuf> = names.chain(FILES.map(PathBuf::from)).collect();
    let out = Out::open(&args.out, ("diagnose", args.force), &[description], names)?;
    let bar = Progress::new(
        (STEPS * joints.len() as f64) as u64,
        "{bar:30} {percent:>3} % {msg}",
    )?;
    let mut told = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let progress = |done: f64, what: &str| {
            let done = STEPS * (index as f64 + done.clamp(0.0, 1.0));
            bar.set(done as u64, &format!("{joint}: {what}"));
        };
        let outcome = match model(args, &train, joint)? {
            Err(why) => Err(why),
            Ok(model) => {
                let own = |all: &[Prepared]| -> Vec<Recording> {
                    let all = all.iter();
                    all.filter_map(|own| own.recording(joint, &model)).collect()
                };
                let (train, held_out) = (own(&train), own(&held_out));
                let work = || diagnose(&model, &train, &held_out, &args.options(), &progress);
                on_threads(args.jobs, work)?.map_err(|error| error.to_string())
            }
        };
        told.push(Told {
            joint: joint.clone(),
            folder: folder(joint),
            outcome,
        });
    }
    drop(bar);
    for told in &mut told {
        if let Ok(outcome) = &mut told.outcome {
            let remarks = train.iter().flat_map(|own| own.remarks_of(&told.joint));
            outcome.diagnosis.remarks.extend(remarks);
        }
    }
    shown((args, description), &out, &train, told)
}

/// The given gravity, or that of a robot that stands upright.
fn gravity(given: &[f64]) -> Result<Vector3<f64>, CliError> {
    match given {
        [] => Ok(Vector3::from(super::EARTH)),
        [x, y, z] => Ok(Vector3::new(*x, *y, *z)),
        other => Err(CliError::input(format!(
            "--gravity: it has three values, X,Y,Z, and not {}",
            other.len()
        ))),
    }
}

/// The joints of all recordings, in the description's order.
fn joints(all: &[Prepared]) -> Vec<String> {
    let mut joints: Vec<(usize, String)> = Vec::new();
    for joint in all.iter().flat_map(|own| &own.robot.joints) {
        if !joints.iter().any(|(index, _)| *index == joint.index) {
            joints.push((joint.index, joint.name.clone()));
        }
    }
    joints.sort();
    joints.into_iter().map(|(_, name)| name).collect()
}

/// The folder name for a joint.
fn folder(joint: &str) -> String {
    let legible = |c: char| c.is_alphanumeric() || "_-".contains(c);
    joint
        .chars()
        .map(|c| if legible(c) { c } else { '_' })
        .collect()
}

/// The nominal model of a joint: the user's, or a rigid axis from the description; if neither is possible, the
/// reason in words.
fn model(args: &Args, train: &[Prepared], joint: &str) -> Result<Result<Model, String>, CliError> {
    let given = args.model.as_ref().map(|path| match path.is_dir() {
        true => path.join(format!("{joint}.toml")),
        false => path.clone(),
    });
    let first = train.iter().find_map(|own| own.beside(joint));
    let Some(file) = given.filter(|file| file.is_file() || !in_folder(args)) else {
        return Ok(believed(train, joint));
    };
    let mut model = Model::from_path(&file).map_err(CliError::input)?;
    if let Some(beside) = first {
        at_inertia(&mut model, beside.inertia);
    }
    Ok(Ok(model))
}

/// The rigid axis that the first recording tells with a torque; otherwise why the last one does not.
fn believed(train: &[Prepared], joint: &str) -> Result<Model, String> {
    let mut why = "the recording does not have it".to_string();
    for own in train {
        match own.believed(joint) {
            Ok(model) => return Ok(model),
            Err(reason) => why = reason,
        }
    }
    Err(format!("{why}: give its model with --model DIR"))
}

fn in_folder(args: &Args) -> bool {
    args.model.as_ref().is_some_and(|path| path.is_dir())
}

/// A nominal frequency without a stated inertia is taken to hold at the mean inertia.
fn at_inertia(model: &mut Model, inertia: f64) {
    let key = model.kind.key("link_inertia");
    if let Some(key) = key.filter(|key| !model.given[*key] && model.kind.normalised) {
        model.values[key] = Value {
            fixed: true,
            ..Value::from(inertia)
        };
        model.given[key] = true;
    }
}

fn shown(
    (args, description): (&Args, &Path),
    out: &Out,
    train: &[Prepared],
    told: Vec<Told>,
) -> Result<(), CliError> {
    let stage = out.stage()?;
    for told in &told {
        if let Ok(outcome) = &told.outcome {
            write(args, &stage, told, outcome)?;
        }
    }
    let overview = overview::Overview::new(description, train, &told);
    stage.file(FILES[0], overview.page().render())?;
    let mut document =
        serde_json::to_string_pretty(&overview.document()).map_err(CliError::failure)?;
    document.push('\n');
    stage.file(FILES[1], document)?;
    stage.put()?;
    match args.json {
        true => output::json(&overview.document())?,
        false => {
            let overview = overview.text(&args.out.join(FILES[0]));
            output::text(&format!("{overview}{}", next_command(args, &told)))?;
        }
    }
    complete(&told)
}

/// The next command: to judge a joint's model by another recording.
fn next_command(args: &Args, told: &[Told]) -> String {
    let Some(one) = told.iter().find(|own| own.outcome.is_ok()) else {
        return String::new();
    };
    let model = args.out.join(&one.folder).join(super::FILES[2]);
    let recording = format!("ANOTHER_RECORDING#{}", one.joint);
    next::command(["score".as_ref(), model.as_os_str(), recording.as_ref()])
}

/// Report, diagnosis and model of a joint.
fn write(args: &Args, stage: &Stage, told: &Told, outcome: &Outcome) -> Result<(), CliError> {
    let folder = Path::new(&told.folder);
    output::folder(&stage.path().join(folder))?;
    let mut document =
        serde_json::to_string_pretty(&outcome.diagnosis).map_err(CliError::failure)?;
    document.push('\n');
    let recordings: Vec<String> = args
        .recordings
        .iter()
        .chain(&args.held_out)
        .map(|path| path.display().to_string())
        .collect();
    let page = page(
        &outcome.diagnosis,
        &outcome.traces,
        &told.joint,
        &recordings,
    );
    let contents = [page.render(), document, outcome.to_toml()];
    for (name, content) in super::FILES.iter().zip(contents) {
        stage.file(folder.join(name), content)?;
    }
    Ok(())
}

/// Whether every joint has its diagnosis, and at least one gives a statement on its model.
fn complete(told: &[Told]) -> Result<(), CliError> {
    let refused = told.iter().filter(|own| own.outcome.is_err()).count();
    if refused > 0 {
        let text = format!("no diagnosis of {refused} of {} joints", told.len());
        return Err(CliError::input(text));
    }
    let silent = |own: &Told| {
        let outcome = own.outcome.as_ref().ok();
        outcome.is_some_and(|one| one.diagnosis.verdict == Verdict::NotExcited)
    };
    match told.iter().all(silent) {
        true => Err(CliError::input("the recordings say nothing of any joint")),
        false => Ok(()),
    }
}
