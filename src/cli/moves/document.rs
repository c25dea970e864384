//! The comparison as JSON and as a table.

use serde_json::{Value, json};

use crate::cli::shaping;
use crate::closed_loop::{Comparison, MoveKind, MoveTrace, Scenario};
use crate::estimators::Estimate;
use crate::learning::{Hold, Prescription};
use crate::page::{columns, decimals_beside, number};
use crate::tolerance::Bounds;

/// Distance from the target within which the tip counts as settled, m.
pub const SETTLED: f64 = 0.05e-3;

/// The mode that the adaptive move learned, and when.
pub struct Learned {
    /// The estimate at the end of the move.
    pub estimate: Estimate,
    /// From the start of the move until the estimate had settled, s.
    pub converged_at: Option<f64>,
}

impl Learned {
    /// From the adaptive first move; `None` if it yielded no estimate.
    pub fn from(comparison: &Comparison) -> Option<Self> {
        let first = comparison.adaptive_first();
        Some(Self {
            estimate: first.last_estimate()?,
            converged_at: first.converged().map(|(time, _)| time),
        })
    }

    /// Periods of the estimated mode until the estimate had settled.
    pub fn periods(&self) -> Option<f64> {
        self.converged_at
            .map(|time| time * self.estimate.mode.hertz())
    }

    /// One standard deviation of the frequency, Hz.
    pub fn frequency_std(&self) -> f64 {
        self.estimate.natural_frequency_std / core::f64::consts::TAU
    }
}

/// The comparison as JSON.
pub fn document(comparison: &Comparison) -> Value {
    let moves: Vec<Value> = comparison
        .moves()
        .map(|(kind, trace)| {
            json!({
                "name": kind.name(),
                "residual_mm": trace.residual() * 1e3,
                "percent_of_unshaped": comparison.ratio(kind) * 100.0,
                "whole_move_mm": trace.vibration() * 1e3,
                "whole_move_percent_of_unshaped": comparison.whole_ratio(kind) * 100.0,
                "settling_s": trace.settling_time(SETTLED),
                "command_s": trace.command_end,
                "added_delay_s": comparison.added_delay(kind),
                "final_error_rad": trace.final_error(),
            })
        })
        .collect();
    let estimate = Learned::from(comparison).map(|learned| {
        json!({
            "frequency_hz": learned.estimate.mode.hertz(),
            "frequency_std_hz": learned.frequency_std(),
            "damping_ratio": learned.estimate.mode.damping_ratio(),
            "damping_std": learned.estimate.damping_ratio_std,
            "converged_at_s": learned.converged_at,
            "periods_to_converge": learned.periods(),
        })
    });
    let next = comparison.adaptive_next();
    json!({
        "moves": moves,
        "estimate": estimate,
        "modes": next.prescribed.as_ref().map(modes),
        "bounds": comparison.bounds().map(bounds),
        "truth": {
            "frequency_hz": comparison.truth.hertz(),
            "damping_ratio": comparison.truth.damping_ratio(),
        },
    })
}

/// Upper bounds of a move within a tolerance, as JSON.
pub fn bounds(bounds: Bounds) -> Value {
    json!({
        "residual_percent": 100.0 * bounds.residual,
        "vibration_mm": 1e3 * bounds.vibration,
        "path_deviation_mm": 1e3 * bounds.departure,
    })
}

/// The same in words.
pub fn at_most(bounds: Option<Bounds>) -> String {
    let Some(bounds) = bounds else {
        return String::new();
    };
    let path = match bounds.departure {
        0.0 => String::new(),
        departure => format!(" and {:.3} mm from its path", 1e3 * departure),
    };
    format!(
        "The fastest move within the tolerance leaves at most {:.2} % of the unshaped vibration, {:.4} mm at the tip{path}. \
         This holds for all modes within two standard deviations of the learned ones.\n",
        100.0 * bounds.residual,
        1e3 * bounds.vibration,
    )
}

/// The modes learned in the first move for the next.
fn modes(prescribed: &Prescription) -> Value {
    let each = prescribed.modes.iter().map(|mode| {
        json!({
            "frequency_hz": mode.known.mode.hertz(),
            "frequency_std_hz": mode.known.natural_frequency_std / core::f64::consts::TAU,
            "frequency_along_way_hz": mode.modes.map(|mode| mode.hertz()),
            "damping_ratio": mode.known.mode.damping_ratio(),
            "damping_std": mode.known.damping_ratio_std,
            "part_of_unshaped": mode.contribution,
            "shaped": mode.shaped,
        })
    });
    json!({
        "known": each.collect::<Vec<_>>(),
        "held": prescribed.hold.map(Hold::name),
        "expected_percent_of_unshaped": prescribed.expected.map(|share| 100.0 * share),
    })
}

/// The same in words, unless it is one mode that stays constant.
fn taught(prescribed: &Prescription) -> String {
    let Some(hold) = prescribed.hold else {
        return String::new();
    };
    let each = prescribed.modes.iter().map(|mode| {
        let hertz = mode.modes.map(|mode| mode.hertz());
        let least = hertz.iter().copied().fold(f64::INFINITY, f64::min);
        let most = hertz.iter().copied().fold(0.0, f64::max);
        let along = match most > 1.01 * least {
            true => format!("{least:.2} to {most:.2} Hz"),
            false => format!("{:.2} Hz", mode.known.mode.hertz()),
        };
        let part = 100.0 * mode.contribution;
        let unshaped = if mode.shaped { "" } else { ", not shaped for" };
        format!("{along} ({part:.0} % of what the move excites{unshaped})")
    });
    let each: Vec<String> = each.collect();
    format!(
        "The next move is shaped for {}: {}.\n",
        hold.reason(),
        each.join(", ")
    )
}

/// The comparison as text for a terminal.
pub fn text(scenario: &Scenario, comparison: &Comparison) -> String {
    let table = columns(
        [
            "move",
            "residual_mm",
            "of_unshaped",
            "whole_move_mm",
            "whole_of_unshaped",
            "settling_s",
            "delay_s",
            "final_error_rad",
        ],
        comparison
            .moves()
            .map(|(kind, trace)| row(comparison, kind, trace)),
    );
    format!(
        "{}\n\n{table}\n{}{}",
        headline(scenario),
        learned(comparison),
        apart(remarks(scenario, comparison))
    )
}

/// A paragraph of its own; nothing where there are no lines.
fn apart(lines: String) -> String {
    match lines.is_empty() {
        true => lines,
        false => format!("\n{lines}"),
    }
}

/// A headline: the moved joint, and its believed mode.
pub fn headline(scenario: &Scenario) -> String {
    format!(
        "{}, joint {}, {} deg, {} shaper, {} estimator; believed {:.3} Hz, damping {:.3}.",
        scenario.robot.name,
        scenario.joint + 1,
        number(scenario.displacement.to_degrees()),
        scenario.shaper.name(),
        scenario.estimator.name,
        scenario.belief.hertz(),
        scenario.belief.damping_ratio(),
    )
}

/// Nothing where the unshaped move leaves nothing.
pub fn percent(ratio: f64) -> String {
    match ratio.is_finite() {
        true => format!("{:.2} %", ratio * 100.0),
        false => "-".to_string(),
    }
}

fn row(comparison: &Comparison, kind: MoveKind, trace: &MoveTrace) -> [String; 8] {
    let settling = trace.settling_time(SETTLED);
    [
        kind.name().to_string(),
        format!("{:.4}", trace.residual() * 1e3),
        percent(comparison.ratio(kind)),
        format!("{:.4}", trace.vibration() * 1e3),
        percent(comparison.whole_ratio(kind)),
        settling.map_or("-".to_string(), |time| format!("{time:.3}")),
        format!("{:.3}", comparison.added_delay(kind)),
        match trace.final_error() {
            0.0 => "0".to_string(),
            error => format!("{error:.1e}"),
        },
    ]
}

/// The learned mode beside the truth, in two lines.
pub fn learned(comparison: &Comparison) -> String {
    let truth = format!(
        "The arm has {:.3} Hz, damping {:.4}.",
        comparison.truth.hertz(),
        comparison.truth.damping_ratio()
    );
    let Some(learned) = Learned::from(comparison) else {
        return format!("No estimate came out of the move. {truth}\n");
    };
    let when = match (learned.converged_at, learned.periods()) {
        (Some(time), Some(periods)) => {
            format!(
                "converged {:.0} ms ({periods:.2} periods) after the move began",
                time * 1e3
            )
        }
        _ => "not converged".to_string(),
    };
    let next = comparison.adaptive_next().prescribed.as_ref();
    let (std, damping_std) = (learned.frequency_std(), learned.estimate.damping_ratio_std);
    let [hertz, damping] = [decimals_beside(std, 3), decimals_beside(damping_std, 4)];
    format!(
        "Estimated {:.hertz$} ± {std:.hertz$} Hz (one standard deviation), damping ratio {:.damping$} ± {damping_std:.damping$}; {when}.\n{truth}\n{}",
        learned.estimate.mode.hertz(),
        learned.estimate.mode.damping_ratio(),
        next.map(taught).unwrap_or_default(),
    )
}

/// Slowed moves and refused corrections, and the effect of a tolerance on the last move.
pub fn remarks(scenario: &Scenario, comparison: &Comparison) -> String {
    let moves = comparison.moves();
    let words: String = moves
        .map(|(kind, trace)| remark(kind.name(), scenario.shaper.name(), trace))
        .collect();
    words + &at_most(comparison.bounds())
}

/// The lines on a move of this name, if it was slowed or its corrections were refused.
pub fn remark(name: &str, shaper: &str, trace: &MoveTrace) -> String {
    let mut words = String::new();
    if let Some(speed) = trace.slowed_to {
        words.push_str(&format!("{name}: {}.\n", shaping::slowed(shaper, speed)));
    }
    if trace.refused > 0 {
        words.push_str(&format!(
            "{name}: {} corrections refused, they would have exceeded the limits.\n",
            trace.refused
        ));
    }
    words
}
