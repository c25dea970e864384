//! A recorded command: the channel of a recording, or a column of a CSV file.

use std::path::Path;

use super::Args;
use super::motion::{Knot, Leg, Motion, rounding};
use super::setup::Setup;
use super::slopes::slopes;
use crate::cli::{CliError, effort::affordable, time_column::time_column};
use crate::recording::health::quantum;
use crate::recording::{Dimension, Recording, Role, Table, Unit};

/// Stamps, s, and positions, rad.
type Series = (Vec<f64>, Vec<f64>);

/// The largest position of a joint, rad: above it a floating-point number resolves less than a
/// ten-thousandth of an encoder step.
const LARGEST: f64 = 1e6;

/// Reads and checks the command; after its end its last position is held until the rest at its end
/// is as long as the dwell.
///
/// # Errors
/// [`CliError::Input`] where it cannot be read, has too few samples, or does not start at rest.
pub fn read(file: &Path, args: &Args, setup: &Setup) -> Result<Motion, CliError> {
    let (time, position) = series(file, args)?;
    let refuse = |reason: String| CliError::input(format!("{}: {reason}", file.display()));
    if time.len() < 2 {
        return Err(refuse("a command has two samples or more".into()));
    }
    if let Some(far) = position.iter().find(|position| position.abs() > LARGEST) {
        return Err(refuse(format!(
            "{far} rad is no position of a joint: at most {LARGEST} rad"
        )));
    }
    let duration = time[time.len() - 1] - time[0];
    affordable(duration + setup.dwell(args), &setup.robot, &setup.modes)?;
    let mut knots = knots(&time, &position);
    let resolution = quantum(&position).unwrap_or(0.0).max(rounding(&knots));
    let limit = setup.robot.joints[setup.joint].limits.acceleration;
    if let Some(velocity) = jump(knots[0], knots[1], limit, resolution) {
        let velocity = velocity.to_degrees();
        let text = format!("the command starts in motion, at {velocity:.4} deg/s, not at rest");
        return Err(refuse(text).with_help("let it begin while the joint still stands"));
    }
    let last = knots.len() - 1;
    let at_end = jump(knots[last - 1], knots[last], limit, resolution);
    let legs = legs(&knots, setup.half_period(), resolution);
    let moved = legs.last().map_or(0.0, |leg| leg.until);
    let missing = setup.dwell(args) - (knots[last].time - moved);
    hold(&mut knots, missing, setup.robot.control_rate);
    let remarks = [at_end.map(ends_in_motion), sparse(&time, setup)];
    Ok(Motion {
        knots,
        legs,
        resolution,
        added_delay: 0.0,
        stamp: time[0],
        remarks: remarks.into_iter().flatten().collect(),
    })
}

/// A remark if the samples are further apart than a period of the joint's slowest mode: such a command cannot
/// excite it as a controller's would, and most often its time is not in seconds.
fn sparse(time: &[f64], setup: &Setup) -> Option<String> {
    let interval = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    let period = 2.0 * setup.half_period();
    (interval > period).then(|| {
        format!(
            "the command's samples are {interval:.3} s apart, longer than a period of the joint \
             ({period:.3} s); its time may not be in seconds"
        )
    })
}

fn ends_in_motion(velocity: f64) -> String {
    format!(
        "the command ends in motion, at {:.4} deg/s: its last position is held from there on",
        velocity.to_degrees()
    )
}

/// The named column, or else the channel of a recording.
fn series(file: &Path, args: &Args) -> Result<Series, CliError> {
    if let Some(column) = &args.column {
        return from_csv(file, column, args);
    }
    let is_csv = |extension: &std::ffi::OsStr| extension == "csv" || extension == "gz";
    if file.extension().is_some_and(is_csv) {
        let text = format!("{}: which column is the command?", file.display());
        return Err(CliError::input(text).with_help("name it: --column joint_1_rad"));
    }
    from_recording(file)
}

fn knots(time: &[f64], position: &[f64]) -> Vec<Knot> {
    let slopes = slopes(time, position);
    let samples = time.iter().zip(position).zip(slopes);
    let knot = |((stamp, &position), velocity)| Knot {
        time: stamp - time[0],
        position,
        velocity,
    };
    samples.map(knot).collect()
}

fn from_csv(file: &Path, column: &str, args: &Args) -> Result<Series, CliError> {
    let unit = Unit::from_name(&args.unit)
        .filter(|unit| unit.dimension == Dimension::Angle)
        .ok_or_else(|| {
            CliError::input(format!("--unit {}: it is not a unit of angle", args.unit))
                .with_help("units of angle: rad, mrad, urad, deg, arcmin, arcsec, rev")
        })?;
    let table = Table::open(file)?;
    let time = time_column(&table, args.time.as_deref(), args.column.as_slice())?;
    let mut values = table.numbers(&[column])?.swap_remove(0);
    values
        .iter_mut()
        .for_each(|value| *value = unit.to_si(*value));
    let stamps = match (time, args.rate) {
        (Some(name), Some(rate)) => table.stamps_at_rate(name, rate)?,
        (Some(name), None) => table.stamps(name)?,
        (None, Some(rate)) => (0..values.len()).map(|row| row as f64 / rate).collect(),
        (None, None) => {
            let text = format!("{}: no column with seconds", file.display());
            return Err(
                CliError::input(text).with_help("name it, --time NAME, or give the --rate in Hz")
            );
        }
    };
    Ok((stamps, values))
}

fn from_recording(file: &Path) -> Result<Series, CliError> {
    let recording = Recording::from_path(file)?;
    let refuse = |reason: String| Err(CliError::input(format!("{}: {reason}", file.display())));
    let mut channels = recording.channels;
    channels.retain(|channel| channel.role == Role::CommandPosition);
    let count = channels.len();
    match channels.pop() {
        None => refuse("it has no command_position".into()),
        Some(_) if count > 1 => refuse(format!(
            "it has {count} channels command_position; give the CSV file and its --column"
        )),
        Some(channel) if channel.unit != "rad" => refuse(format!(
            "its command_position is in {}, but the joint turns",
            channel.unit
        )),
        Some(mut channel) => Ok((channel.time, channel.columns.swap_remove(0))),
    }
}

/// The mean velocity over an interval at an end of the command, where the joint could not reach it
/// from rest, or come to rest from it, within that interval at its limit of acceleration.
fn jump(before: Knot, after: Knot, acceleration: f64, resolution: f64) -> Option<f64> {
    let interval = after.time - before.time;
    let step = after.position - before.position;
    let reached = acceleration * interval * interval + resolution;
    (step.abs() > reached).then(|| step / interval)
}

/// The moves: the parts between rests of at least `rest` (s).
fn legs(knots: &[Knot], rest: f64, resolution: f64) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::new();
    for pair in knots.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        if (after.position - before.position).abs() <= 0.5 * resolution {
            continue;
        }
        match legs.last_mut() {
            Some(leg) if before.time - leg.until < rest => {
                leg.until = after.time;
                leg.target = after.position;
            }
            _ => legs.push(Leg {
                from: before.time,
                until: after.time,
                start: before.position,
                target: after.position,
            }),
        }
    }
    legs
}

/// Appends `duration` (s) of rest; nothing if it is negative.
fn hold(knots: &mut Vec<Knot>, duration: f64, rate: f64) {
    let last = knots[knots.len() - 1];
    let ticks = (duration * rate).ceil() as usize;
    knots.extend((1..=ticks).map(|tick| Knot {
        time: last.time + tick as f64 / rate,
        position: last.position,
        velocity: 0.0,
    }));
}
