//! A comparison as text and as JSON.

use super::candidate::Candidate;
use super::{Comparison, ERRORS, NO_CHOICE, errors};
use crate::page::{columns, number};
use quell_shapers::Mode;
use serde_json::{Value, json};

/// The text for a terminal.
pub fn text(comparison: &Comparison) -> String {
    let modes: Vec<String> = comparison
        .modes
        .iter()
        .map(|known| describe(&known.mode))
        .collect();
    let [e1, e2, e3, e4, e5] = ERRORS.map(percent_label);
    let first = format!("V at {e1}");
    let header = [
        "shaper",
        "delay_s",
        "insensitivity",
        &first,
        &e2,
        &e3,
        &e4,
        &e5,
        "V 95 %",
        "gain",
    ];
    let unshaped = ["unshaped", "0", "-", "1", "1", "1", "1", "1", "1", "1"].map(str::to_owned);
    let rows = comparison.candidates.iter().map(|one| row(comparison, one));
    let table = columns(header, std::iter::once(unshaped).chain(rows));
    let mut refused = String::new();
    for candidate in &comparison.candidates {
        if let Err(reason) = &candidate.design {
            refused.push_str(&format!("{}: {reason}\n", candidate.shaper.name()));
        }
    }
    let simulated = simulated(comparison).unwrap_or_default();
    let remarks = comparison.remarks.iter();
    let remarks: String = remarks.map(|remark| format!("Note: {remark}.\n")).collect();
    let advice = comparison
        .choice()
        .map_or(NO_CHOICE, |choice| &choice.reason);
    let (machine, rate) = (&comparison.machine, comparison.rate);
    let modes = modes.join(" and ");
    format!(
        "{machine}: {modes}, {rate} Hz\n\n{table}{refused}{simulated}{remarks}\nRecommended: {advice}\n"
    )
}

/// The table of the simulated moves, if the robot was simulated.
fn simulated(comparison: &Comparison) -> Option<String> {
    let [e1, e2, e3, e4, e5] = ERRORS.map(percent_label);
    let unshaped = comparison.unshaped.as_ref()?;
    let rows = comparison
        .designs()
        .filter_map(|(shaper, design)| Some((shaper.name(), design.simulated.as_ref()?)));
    let rows = std::iter::once(("unshaped", unshaped))
        .chain(rows)
        .map(|(name, simulated)| {
            let mut cells = std::array::from_fn(|_| name.to_owned());
            cells[1..]
                .iter_mut()
                .zip(&simulated.residual_mm)
                .for_each(|(cell, mm)| *cell = figure(*mm));
            cells
        });
    let first = format!("mm at {e1}");
    Some(format!(
        "\n{}",
        columns(["shaper", &first, &e2, &e3, &e4, &e5], rows)
    ))
}

fn figure(mm: f64) -> String {
    match mm.is_finite() {
        true => format!("{mm:.4}"),
        false => "-".to_owned(),
    }
}

/// `-25 %`, `0 %`, `+10 %`.
pub fn percent_label(error: f64) -> String {
    let percent = (100.0 * error).round();
    if percent > 0.0 {
        format!("+{percent} %")
    } else {
        format!("{percent} %")
    }
}

/// A mode in words.
pub fn describe(mode: &Mode) -> String {
    format!(
        "{} Hz with a damping ratio of {}",
        number(mode.hertz()),
        number(mode.damping_ratio())
    )
}

/// A row of the table.
fn row(comparison: &Comparison, candidate: &Candidate) -> [String; 10] {
    let mut cells = std::array::from_fn(|_| "-".to_owned());
    cells[0] = candidate.shaper.name().into();
    if let Ok(design) = &candidate.design {
        cells[1] = format!("{:.4}", design.train.duration());
        cells[2] = design
            .insensitivity
            .map_or("-".into(), |width| format!("{width:.3}"));
        for (cell, error) in cells[3..].iter_mut().zip(ERRORS) {
            *cell = format!("{:.4}", design.residual(error));
        }
        if let Some((worst, _)) = comparison.uncertain(candidate.shaper) {
            cells[8] = format!("{worst:.4}");
        }
        cells[9] = format!("{:.2}", design.train.gain());
    }
    cells
}

/// The JSON document of `--json`.
pub fn document(comparison: &Comparison) -> Value {
    let shapers = comparison.candidates.iter();
    let shapers = shapers.map(|candidate| shaper(comparison, candidate));
    let modes = comparison.modes.iter().map(|known| {
        json!({
            "frequency_hz": known.mode.hertz(),
            "damping_ratio": known.mode.damping_ratio(),
            "frequency_std_hz": known.natural_frequency_std / std::f64::consts::TAU,
            "damping_std": known.damping_ratio_std,
        })
    });
    let wish = comparison.wish;
    json!({
        "machine": comparison.machine,
        "rate_hz": comparison.rate,
        "modes": modes.collect::<Vec<_>>(),
        "acceptable_v": wish.acceptable,
        "max_delay_s": Some(wish.max_delay).filter(|delay| delay.is_finite()),
        "unshaped_simulated_mm": comparison.unshaped.as_ref().map(|moved| &moved.residual_mm),
        "shapers": shapers.collect::<Vec<_>>(),
        "remarks": comparison.remarks,
        "recommended": comparison.choice().map(|choice| json!({
            "shaper": choice.figures.shaper.name(),
            "reason": choice.reason,
            "delay_s": choice.delay,
            "worst_v": choice.figures.worst_95,
            "expected_v": choice.figures.expected,
        })),
    })
}

/// A shaper's figures, or the reason why it was refused.
fn shaper(comparison: &Comparison, candidate: &Candidate) -> Value {
    let design = match &candidate.design {
        Ok(design) => design,
        Err(reason) => return json!({"shaper": candidate.shaper.name(), "refused": reason}),
    };
    let at = |error: f64| json!({"frequency_error": error, "v": design.residual(error)});
    let uncertain = comparison.uncertain(candidate.shaper);
    let curve = || errors(comparison.spread);
    json!({
        "shaper": candidate.shaper.name(),
        "duration_s": design.train.duration(),
        "insensitivity": design.insensitivity,
        "gain": design.train.gain(),
        "residual_vibration": ERRORS.map(at),
        "worst_v": uncertain.map(|(worst, _)| worst),
        "expected_v": uncertain.map(|(_, mean)| mean),
        "simulated_mm": design.simulated.as_ref().map(|moved| &moved.residual_mm),
        "simulated_speed": design.simulated.as_ref().map(|moved| moved.speed),
        "curve": {
            "frequency_error": curve().collect::<Vec<_>>(),
            "v": curve().map(|error| design.residual(error)).collect::<Vec<_>>(),
        },
    })
}
