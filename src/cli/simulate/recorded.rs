//! A command that was recorded: the channel of a recording, or a column of a CSV file.

use std::path::Path;

use super::limits::resolution;
use super::motion::{Knot, Leg, Motion, affordable};
use super::slopes::slopes;
use super::{Args, Setup};
use crate::cli::CliError;
use crate::recording::{Dimension, Recording, Role, Table, Unit};

/// Names of a column with seconds that are recognised without being told.
const TIME_NAMES: [&str; 4] = ["time_s", "t_s", "time", "t"];

/// Stamps, s, and positions, rad.
type Series = (Vec<f64>, Vec<f64>);

/// Reads and checks the command; its last position is held until the rest at its end
/// is as long as the dwell.
///
/// # Errors
/// [`CliError::Input`] where it cannot be read, has too few samples, or does not start at rest.
pub fn read(file: &Path, args: &Args, setup: &Setup) -> Result<Motion, CliError> {
    let is_csv = file
        .extension()
        .is_some_and(|extension| extension == "csv" || extension == "gz");
    let (time, position) = match &args.column {
        Some(column) => from_csv(file, column, args)?,
        None if is_csv => {
            let text = format!("{}: which column is the command?", file.display());
            return Err(CliError::input(text).with_help("name it: --column joint_1_rad"));
        }
        None => from_recording(file)?,
    };
    let refuse = |reason: String| CliError::input(format!("{}: {reason}", file.display()));
    if time.len() < 2 {
        return Err(refuse("a command has two samples or more".into()));
    }
    let stamp = time[0];
    let duration = time[time.len() - 1] - stamp;
    affordable(duration + setup.dwell(args), &setup.robot)?;
    let slopes = slopes(&time, &position);
    let mut knots: Vec<Knot> = time
        .iter()
        .zip(position.iter().zip(slopes))
        .map(|(time, (&position, velocity))| Knot {
            time: time - stamp,
            position,
            velocity,
        })
        .collect();
    let limit = setup.robot.joints[setup.joint].limits.acceleration;
    let rounding = resolution(&knots);
    if let Some(velocity) = jump(knots[0], knots[1], limit, rounding) {
        return Err(refuse(format!(
            "the command does not start at rest: {:.4} deg/s from its first sample on",
            velocity.to_degrees()
        ))
        .with_help("let it begin while the joint still stands"));
    }
    let last = knots.len() - 1;
    let mut remarks = Vec::new();
    if let Some(velocity) = jump(knots[last - 1], knots[last], limit, rounding) {
        remarks.push(format!(
            "the command ends in motion, at {:.4} deg/s: its last position is held from there on",
            velocity.to_degrees()
        ));
    }
    let legs = legs(&knots, setup.half_period(), rounding);
    let moved = legs.last().map_or(0.0, |leg| leg.until);
    let missing = setup.dwell(args) - (knots[last].time - moved);
    hold(&mut knots, missing, setup.robot.control_rate);
    Ok(Motion {
        knots,
        legs,
        added_delay: 0.0,
        stamp,
        remarks,
    })
}

fn from_csv(file: &Path, column: &str, args: &Args) -> Result<Series, CliError> {
    let unit = Unit::from_name(&args.unit)
        .filter(|unit| unit.dimension == Dimension::Angle)
        .ok_or_else(|| {
            CliError::input(format!("--unit {}: it is not a unit of angle", args.unit))
                .with_help("units of angle: rad, mrad, urad, deg, arcmin, arcsec, rev")
        })?;
    let table = Table::open(file)?;
    let known = |name: &&str| table.header().iter().any(|held| held == name);
    let time = args
        .time
        .as_deref()
        .or_else(|| TIME_NAMES.into_iter().find(known));
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
fn jump(before: Knot, after: Knot, acceleration: f64, rounding: f64) -> Option<f64> {
    let interval = after.time - before.time;
    let step = after.position - before.position;
    let reached = acceleration * interval * interval + rounding;
    (step.abs() > reached).then(|| step / interval)
}

/// The moves: what lies between rests of at least `rest` (s).
fn legs(knots: &[Knot], rest: f64, rounding: f64) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::new();
    for pair in knots.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        if (after.position - before.position).abs() <= 0.5 * rounding {
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

/// Appends `duration` (s) of rest, none where it is negative.
fn hold(knots: &mut Vec<Knot>, duration: f64, rate: f64) {
    let last = knots[knots.len() - 1];
    let ticks = (duration * rate).ceil() as usize;
    knots.extend((1..=ticks).map(|tick| Knot {
        time: last.time + tick as f64 / rate,
        position: last.position,
        velocity: 0.0,
    }));
}
