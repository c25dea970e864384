//! `quell inspect`: the content of a recording, and suspicious parts of it.

mod document;
mod joints;
mod propose;
mod topics;

use super::out::Force;
use super::{CliError, identify, next, output};
use crate::page::{columns, digits, fixed, number};
use crate::recording::health::{ColumnHealth, Health, health, is_rounding, remarks};
use crate::recording::{
    Channel, MANIFEST, McapFile, Recording, axis_name, is_csv, mcap_and_joint, plain as short,
};
use crate::signal::{Contradiction, Hangs};
use document::document;
use joints::Joints;
pub use propose::told as propose;
use serde_json::Value;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Tells what a recording holds, and what looks wrong with it; proposes the manifest of a CSV or Parquet file.
///
/// Channels, rates, gaps, clock jitter, noise, quantisation, flat stretches, jumps and spikes. Of a CSV or Parquet file, or a
/// folder of them without a recording.toml, it writes recording.toml beside them, with what it guesses marked.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell inspect arm7/recording.toml
  quell inspect arm7 --json        (the folder of a recording.toml)
  quell inspect decay.csv          (writes recording.toml beside it)
  quell inspect run.mcap           (its topics, too; run.mcap#joint_2 takes one of several joints)

Columns of the tables: noise is the standard deviation of white noise, step the quantisation step; \
noise is called rounding where it is below that of the step, step / sqrt(12); \
jitter the root mean square of interval minus period. Values are in SI, jitter in microseconds. \
Of a manifest with several joints each is told; arm7#joint_2 takes one.")]
pub struct Args {
    /// The manifest (recording.toml), its folder, an MCAP file, or a CSV or Parquet file.
    pub recording: PathBuf,
    #[command(flatten)]
    force: Force,
    /// Prints JSON instead of tables.
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the recording is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    let (path, joint) = mcap_and_joint(&args.recording);
    if McapFile::is_named(&path) {
        return mcap(
            (&path, &McapFile::open(&path)?),
            joint.as_deref(),
            args.json,
        );
    }
    if is_csv(&path) || (path.is_dir() && !path.join(MANIFEST).exists()) {
        let as_it_is = |text: &str| Ok(text.into());
        return propose(&path, ("inspect", args.force), args.json, as_it_is);
    }
    let read = Joints::read(&args.recording)?;
    match args.json {
        true => output::json(&read.document()),
        false => output::text(&format!(
            "{}\n{}",
            read.text(),
            next::command(read.follows())
        )),
    }
}

/// The next command for a recording of this path: to identify its mode if the recording allows it; otherwise to
/// diagnose a model with it. The model is the one in the recording's folder, where there is one.
fn follows(recording: &Recording, path: &Path) -> Vec<OsString> {
    let folder = if path.is_dir() {
        Some(path)
    } else {
        path.parent()
    };
    let beside = folder.map(|folder| folder.join(identify::MODEL));
    let beside = beside.filter(|model| model.is_file());
    let model = beside.unwrap_or_else(|| "MODEL.toml".into());
    let (path, model) = (path.as_os_str(), model.as_os_str());
    let [identify, diagnose, option] = ["identify", "diagnose", "--model"].map(OsStr::new);
    let words = match (identify::can(recording), identify::needs_model(recording)) {
        (true, false) => vec![identify, path],
        (true, true) => vec![identify, path, option, model],
        (false, _) => vec![diagnose, option, model, path],
    };
    words.into_iter().map(OsStr::to_owned).collect()
}

/// The topics of an MCAP file, and the recording of the named joint, or of the only one.
fn mcap((path, file): (&Path, &McapFile), joint: Option<&str>, json: bool) -> Result<(), CliError> {
    let mut text = topics::page(file);
    let mut all = topics::document(file);
    let joints = file.joints();
    let mut one = path.as_os_str().to_os_string();
    if let Some(name) = joint.or(joints.first().map(String::as_str)) {
        one.push(format!("#{name}"));
    }
    let mut words = vec!["identify".into(), one.clone()];
    // Where the topics that say what they are do not suffice, and others are there.
    let mut lacks = false;
    if let Some(name) = joint.or(joints.first().map(String::as_str)) {
        let recording = file.recording(Some(name))?;
        words = follows(&recording, Path::new(&one));
        let tells = identify::can(&recording) && identify::sole_drive(&recording).is_none();
        lacks = !tells && !topics::unread(file).is_empty();
        if lacks {
            let described = format!("{MANIFEST}#{name}");
            words = vec!["identify".into(), described.into()];
        }
    }
    if joint.is_some() || joints.len() == 1 {
        let recording = file.recording(joint)?;
        let figures: Vec<Health> = recording.channels.iter().map(health).collect();
        text.push_str(&page(&recording, &figures));
        if let Value::Object(keys) = document(&recording, &figures) {
            all.extend(keys);
        }
    }
    let next = match lacks {
        true => format!(
            "Next: describe the channels in a {MANIFEST} beside the file\n{}",
            next::then(words)
        ),
        false => next::command(words),
    };
    match json {
        true => output::json(&all),
        false => output::text(&format!("{text}\n{next}")),
    }
}

fn page(recording: &Recording, figures: &[Health]) -> String {
    let channels = || recording.channels.iter().zip(figures);
    let clocks = columns(
        [
            "channel",
            "samples",
            "rate_hz",
            "start_s",
            "duration_s",
            "missing",
            "jitter_us",
        ],
        channels().map(|(channel, health)| clock_row(channel, health)),
    );
    let values = columns(
        ["values", "unit", "least", "greatest", "noise", "step"],
        channels().flat_map(|(channel, health)| value_rows(channel, health)),
    );
    let mut words = String::new();
    for (channel, health) in channels() {
        for remark in remarks(channel, health) {
            words.push_str(&format!("- {}: {remark}\n", channel.role));
        }
    }
    for remark in together(recording) {
        words.push_str(&format!("- {remark}\n"));
    }
    if words.is_empty() {
        words.push_str("- nothing\n");
    }
    format!(
        "{}\n\n{clocks}\n{values}\nWhat looks wrong:\n{words}",
        recording.name
    )
}

/// Decimals of a time in seconds.
const MILLISECONDS: usize = 3;

fn clock_row(channel: &Channel, health: &Health) -> [String; 7] {
    let clock = &health.clock;
    // No more digits than the first of the deviation.
    let known = clock.rate_std().filter(|std| *std > 0.0);
    let digits = known.map_or(2, |std| (-std.log10().floor()).clamp(0.0, 2.0) as usize);
    [
        channel.role.to_string(),
        clock.samples.to_string(),
        clock.rate().map_or("-".into(), |rate| fixed(rate, digits)),
        fixed(clock.start, MILLISECONDS),
        fixed(clock.duration, MILLISECONDS),
        clock.missing.to_string(),
        // Microseconds to the nanosecond, in which the finest stamps are: below that is rounding.
        number((1e9 * clock.jitter).round() / 1e3),
    ]
}

fn value_rows<'a>(channel: &'a Channel, health: &'a Health) -> impl Iterator<Item = [String; 6]> {
    let names = column_names(channel);
    let figure = |value: Option<f64>| number(value.map_or(f64::NAN, |value| digits(value, 3)));
    names
        .into_iter()
        .zip(&health.columns)
        .map(move |(name, column)| {
            [
                name,
                channel.unit.clone(),
                number(column.minimum),
                number(column.maximum),
                match is_rounded(column) {
                    true => "rounding".into(),
                    false => figure(column.noise_std),
                },
                figure(column.quantum),
            ]
        })
}

/// Whether the noise is below what the quantisation step makes, and cannot be told.
fn is_rounded(column: &ColumnHealth) -> bool {
    let both = column.noise_std.zip(column.quantum);
    both.is_some_and(|(noise, step)| is_rounding(noise, step))
}

fn column_names(channel: &Channel) -> Vec<String> {
    match channel.columns.len() {
        1 => vec![channel.role.to_string()],
        count => (0..count)
            .filter_map(|index| axis_name(count, index))
            .map(|axis| format!("{} {axis}", channel.role))
            .collect(),
    }
}

/// Remarks on what the channels contradict each other in.
fn together(recording: &Recording) -> Vec<String> {
    let all = overlap(recording).into_iter();
    // What a sensor shows that hangs contradicts nothing.
    let hangs = Hangs::of(recording);
    let told = hangs.as_ref().map(Hangs::contradiction);
    let moving = hangs.map(|hangs| recording.within(hangs.intact(recording)));
    let recording = moving.as_ref().unwrap_or(recording);
    let mistake = Contradiction::of(recording).map(|own| own.words);
    all.chain(told).chain(mistake).collect()
}

/// A remark if the channels have no time in common.
fn overlap(recording: &Recording) -> Option<String> {
    let starts = recording
        .channels
        .iter()
        .filter_map(|channel| channel.time.first());
    let ends = recording
        .channels
        .iter()
        .filter_map(|channel| channel.time.last());
    let start = starts.copied().fold(f64::NEG_INFINITY, f64::max);
    let end = ends.copied().fold(f64::INFINITY, f64::min);
    (end < start).then(|| {
        format!(
            "the channels have no time in common: one begins at {} s, one ends at {} s",
            short(start),
            short(end)
        )
    })
}
