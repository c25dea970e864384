//! The comparison of moves on a path as JSON and as a table.

use serde_json::{Value, json};

use super::super::document::{SETTLED, at_most, bounds, percent, remark};
use crate::closed_loop::{MoveTrace, PathComparison, PathKind, PathScenario, PathTrace};
use crate::page::{columns, number};

/// The comparison as JSON.
pub fn document(scenario: &PathScenario, comparison: &PathComparison) -> Value {
    let joint = |(index, trace): (usize, &MoveTrace), kind: PathKind| {
        json!({
            "joint": scenario.joints[index].joint + 1,
            "displacement_deg": scenario.joints[index].displacement.to_degrees(),
            "residual_mm": trace.residual() * 1e3,
            "percent_of_unshaped": comparison.ratio(kind, index) * 100.0,
            "whole_move_mm": trace.vibration() * 1e3,
            "settling_s": trace.settling_time(SETTLED),
            "final_error_rad": trace.final_error(),
        })
    };
    let one = |(kind, trace): &(PathKind, PathTrace)| {
        let joints = trace.joints.iter().enumerate();
        let joints: Vec<_> = joints.map(|entry| joint(entry, *kind)).collect();
        json!({
            "name": kind.name(),
            "path_deviation_deg": trace.command_departure().to_degrees(),
            "link_path_deviation_deg": trace.link_departure().to_degrees(),
            "command_s": trace.command_end(),
            "added_delay_s": comparison.added_delay(*kind),
            "joints": joints,
        })
    };
    json!({
        "moves": comparison.moves.iter().map(one).collect::<Vec<_>>(),
        "bounds": comparison.bounds.map(bounds),
    })
}

/// The comparison as text for a terminal.
pub fn text(scenario: &PathScenario, comparison: &PathComparison) -> String {
    let head = [
        "move",
        "path_deviation_deg",
        "of_links_deg",
        "delay_s",
        "joint",
        "residual_mm",
        "of_unshaped",
        "settling_s",
    ];
    let moves = comparison.moves.iter();
    let rows = moves.flat_map(|(kind, trace)| rows(scenario, comparison, *kind, trace));
    let table = columns(head, rows);
    let remarks = remarks(scenario, comparison);
    format!(
        "{}\n\n{table}\n{}\n{remarks}",
        headline(scenario),
        sentence(comparison)
    )
}

/// A row for each joint; the values common to all are in the first.
fn rows(
    scenario: &PathScenario,
    comparison: &PathComparison,
    kind: PathKind,
    trace: &PathTrace,
) -> Vec<[String; 8]> {
    let row = |(index, joint): (usize, &MoveTrace)| {
        let first = |text: String| if index == 0 { text } else { String::new() };
        let settling = joint.settling_time(SETTLED);
        [
            first(kind.name().to_string()),
            first(format!("{:.4}", trace.command_departure().to_degrees())),
            first(format!("{:.4}", trace.link_departure().to_degrees())),
            first(format!("{:.3}", comparison.added_delay(kind))),
            (scenario.joints[index].joint + 1).to_string(),
            format!("{:.4}", joint.residual() * 1e3),
            percent(comparison.ratio(kind, index)),
            settling.map_or("-".to_string(), |time| format!("{time:.3}")),
        ]
    };
    trace.joints.iter().enumerate().map(row).collect()
}

/// The joints with their displacements and their believed modes.
pub fn headline(scenario: &PathScenario) -> String {
    let joints = scenario.joints.iter().map(|joint| {
        let belief = match joint.belief {
            Some(mode) => format!("believed {:.3} Hz", mode.hertz()),
            None => "stiff".into(),
        };
        let degrees = number(joint.displacement.to_degrees());
        format!("joint {} by {degrees} deg ({belief})", joint.joint + 1)
    });
    format!(
        "{}, {}; {} shaper, {} estimator.",
        scenario.robot.name,
        joints.collect::<Vec<_>>().join(", "),
        scenario.shaper.name(),
        scenario.estimator.name,
    )
}

/// Angle below which a distance is rounding, rad: far below the resolution of an encoder.
const ROUNDING: f64 = 1e-9;

/// Largest distance of a command from the path, deg; 0 where it is rounding alone.
pub fn off_the_path(trace: &PathTrace) -> f64 {
    match trace.command_departure() {
        rounding if rounding < ROUNDING => 0.0,
        departure => departure.to_degrees(),
    }
}

/// The effect of the common train, once the modes are known.
pub fn sentence(comparison: &PathComparison) -> String {
    let [own, common] =
        [PathKind::OwnTrainsNext, PathKind::CommonTrainNext].map(|kind| comparison.trace(kind));
    format!(
        "With a train for each joint the command leaves the straight line by {:.3} deg; with a common train, by \
         {:.3} deg. The common train adds {:.0} ms to the move; a train for each joint adds {:.0} ms.",
        off_the_path(own),
        off_the_path(common),
        common.added_delay() * 1e3,
        own.added_delay() * 1e3,
    )
}

/// Slowed moves and refused corrections, joint by joint, and the effect of a tolerance on the last move.
pub fn remarks(scenario: &PathScenario, comparison: &PathComparison) -> String {
    let mut words = String::new();
    for (kind, trace) in &comparison.moves {
        for (joint, one) in scenario.joints.iter().zip(&trace.joints) {
            let name = format!("{}, joint {}", kind.name(), joint.joint + 1);
            words.push_str(&remark(&name, scenario.shaper.name(), one));
        }
    }
    words + &at_most(comparison.bounds)
}
