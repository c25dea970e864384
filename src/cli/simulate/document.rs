//! The results of a simulation, as JSON and as text.

use crate::cli::next;
use crate::page::columns;
use std::path::PathBuf;

use quell_shapers::Mode;
use serde_json::{Value, json};

use super::Args;
use super::motion::Motion;
use super::setup::Setup;
use super::trace::Trace;
use crate::plant::ArmSimulation;

/// All data of the report.
pub struct Run<'a> {
    /// The request.
    pub args: &'a Args,
    /// The joint.
    pub setup: &'a Setup,
    /// The arm at the end.
    pub arm: &'a ArmSimulation,
    /// The command.
    pub motion: &'a Motion,
    /// The result.
    pub trace: &'a Trace,
    /// The written file.
    pub files: &'a [PathBuf],
}

/// The simulation as JSON.
pub fn document(run: &Run) -> Value {
    let modes = run.arm.true_modes().map(|mode| mode_document(&mode));
    let moves = run.motion.legs.iter().zip(&run.trace.settled);
    let moves = moves.map(|(leg, settled)| {
        json!({
            "start_deg": leg.start.to_degrees(),
            "target_deg": leg.target.to_degrees(),
            "from_s": leg.from,
            "until_s": leg.until,
            "motor_end_s": settled.map(|settled| settled.motor_end),
            "residual_mm": settled.map(|settled| settled.residual * 1e3),
        })
    });
    json!({
        "robot": run.setup.robot.name,
        "joint": run.setup.joint + 1,
        "modes": modes.collect::<Vec<_>>(),
        "belief": run.setup.belief.iter().map(mode_document).collect::<Vec<_>>(),
        "shaper": run.args.shaper.map(|shaper| shaper.name()),
        "added_delay_s": run.motion.added_delay,
        "command": run.args.command,
        "command_starts_at_s": run.motion.stamp,
        "duration_s": run.arm.time(),
        "moves": moves.collect::<Vec<_>>(),
        "peak_deformation_mm": run.trace.peak * 1e3,
        "remarks": run.motion.remarks,
        "files": run.files,
    })
}

fn mode_document(mode: &Mode) -> Value {
    json!({"frequency_hz": mode.hertz(), "damping_ratio": mode.damping_ratio()})
}

/// The simulation as text for a terminal.
pub fn text(run: &Run) -> String {
    let modes: Vec<String> = run.arm.true_modes().map(describe).collect();
    let modes = match modes.as_slice() {
        [] => "stiff".to_owned(),
        modes => modes.join(" and "),
    };
    let command = match (&run.args.command, &run.args.shaper) {
        (Some(file), _) => format!("command of {}", file.display()),
        (None, Some(shaper)) => format!("{} shaper", shaper.name()),
        (None, None) => "unshaped".to_owned(),
    };
    let (robot, joint) = (&run.setup.robot.name, run.setup.joint + 1);
    let remarks = run.motion.remarks.iter();
    let remarks: String = remarks.map(|remark| format!("Note: {remark}.\n")).collect();
    let files = run.files.iter().map(|file| file.display().to_string());
    format!(
        "{robot}, joint {joint}: {modes}; {command}, {:.3} s.\n\n{}\n{remarks}Wrote {}\n{}",
        run.arm.time(),
        table(run),
        files.collect::<Vec<_>>().join(" and "),
        next_command(run),
    )
}

/// The next command: to identify the written recording with the nominal model, or for a stiff joint to inspect
/// it.
fn next_command(run: &Run) -> String {
    match run.files {
        [manifest, model, ..] => next::command([
            "identify".as_ref(),
            manifest.as_path(),
            "--model".as_ref(),
            model.as_path(),
            "--out".as_ref(),
            run.args.out.as_path(),
        ]),
        [manifest] => next::command(["inspect".as_ref(), manifest.as_path()]),
        [] => String::new(),
    }
}

fn describe(mode: Mode) -> String {
    format!(
        "{:.3} Hz with a damping ratio of {:.4}",
        mode.hertz(),
        mode.damping_ratio()
    )
}

fn table(run: &Run) -> String {
    let header = [
        "move",
        "from_deg",
        "to_deg",
        "start_s",
        "command_s",
        "motor_rest_s",
        "residual_mm",
    ];
    let moves = run.motion.legs.iter().zip(&run.trace.settled).enumerate();
    columns(
        header,
        moves.map(|(index, (leg, settled))| {
            [
                (index + 1).to_string(),
                format!("{:.4}", leg.start.to_degrees()),
                format!("{:.4}", leg.target.to_degrees()),
                format!("{:.3}", leg.from),
                format!("{:.3}", leg.until - leg.from),
                settled.map_or("-".into(), |s| format!("{:.3}", s.motor_end)),
                settled.map_or("-".into(), |s| format!("{:.4}", s.residual * 1e3)),
            ]
        }),
    )
}
