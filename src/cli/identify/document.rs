//! The findings as JSON.

use super::{Findings, registrations, words};
use crate::estimators::ESTIMATORS;
use crate::identification::{OnLine, Run};
use quell_shapers::UncertainMode;
use serde_json::{Value, json};

const TAU: f64 = core::f64::consts::TAU;

/// The JSON document of `--json`.
pub fn document(findings: &Findings) -> Value {
    let found = &findings.found;
    let estimates = ESTIMATORS.iter().enumerate().map(|(index, line)| {
        let run = found.quoted(index);
        let result = run.and_then(|run| run.estimator(line.name));
        let mut told = estimate(line.name, run, result);
        if let Some(one) = result.and_then(|result| result.estimate) {
            let [frequency, damping] = found.deviations(&one, line.states_error);
            told["frequency_std_hz"] = json!(frequency / TAU);
            told["damping_std"] = json!(damping);
        }
        told
    });
    let mode = |known: UncertainMode| {
        json!({
            "frequency_hz": known.mode.hertz(),
            "frequency_std_hz": known.natural_frequency_std / TAU,
            "damping_ratio": known.mode.damping_ratio(),
            "damping_std": known.damping_ratio_std,
        })
    };
    let best = found.recommended();
    let dependence = found.amplitude_dependence.as_ref().map(|dependence| {
        let cycles = dependence.cycles.iter().map(|cycle| {
            json!({
                "time_s": cycle.time,
                "amplitude": cycle.amplitude,
                "damping_ratio": cycle.damping_ratio,
                "damping_std": cycle.damping_ratio_std,
            })
        });
        json!({
            "falls_with_amplitude": dependence.falls_with_amplitude(),
            "cycles": cycles.collect::<Vec<_>>(),
        })
    });
    json!({
        "name": findings.recording,
        "mode": best.map(|best| mode(best.mode)),
        "recommended": best.map(|best| json!({
            "method": best.method,
            "modes": best.modes().map(mode).collect::<Vec<_>>(),
            "between_stretches": {"frequency_hz": best.between[0] / TAU, "damping_ratio": best.between[1]},
            "includes_servo": findings.series.includes_servo(),
            "reason": words::recommended(findings, &best),
        })),
        "estimates": estimates.collect::<Vec<_>>(),
        "offline": off_line(found.reference()),
        "free_decay_from_s": found.free_decays.iter().map(|run| run.stretch.from).collect::<Vec<_>>(),
        "known_input_holds": found.known_input_holds,
        "explained_by_known_input": found.explained,
        "searched_hz": [found.searched.from / TAU, found.searched.to / TAU],
        "nyquist_hz": found.nyquist() / TAU,
        "damping_by_amplitude": dependence,
        "registrations": registrations::document(&findings.registered),
        "runs": found.free_decays.iter().chain([&found.whole]).map(run_document).collect::<Vec<_>>(),
        "remarks": words::remarks(findings),
    })
}

fn estimate(name: &str, run: Option<&Run>, result: Option<&OnLine>) -> Value {
    let estimate = result.and_then(|result| result.estimate);
    let further = result.and_then(|result| result.further).map(|e| {
        json!({
            "frequency_hz": e.mode.hertz(),
            "frequency_std_hz": e.natural_frequency_std / TAU,
            "damping_ratio": e.mode.damping_ratio(),
            "damping_std": e.damping_ratio_std,
        })
    });
    json!({
        "estimator": name,
        "further_mode": further,
        "frequency_hz": estimate.map(|e| e.mode.hertz()),
        "frequency_std_hz": estimate.map(|e| e.natural_frequency_std / TAU),
        "damping_ratio": estimate.map(|e| e.mode.damping_ratio()),
        "damping_std": estimate.map(|e| e.damping_ratio_std),
        "gain": estimate.map(|e| e.gain),
        "converged_at_s": result.and_then(|r| r.converged_at),
        "periods_to_converge": result.and_then(|r| r.periods),
        "from_s": run.map(|run| run.shown.from),
        "until_s": run.map(|run| run.shown.until),
    })
}

fn off_line(run: &Run) -> Vec<Value> {
    run.off_line
        .iter()
        .map(|line| {
            json!({
                "method": line.method,
                "frequency_hz": line.mode.hertz(),
                "frequency_std_hz": line.natural_frequency_std.map(|std| std / TAU),
                "damping_ratio": line.mode.damping_ratio(),
                "damping_std": line.damping_ratio_std,
                "from_s": run.fitted.from,
                "until_s": run.fitted.until,
            })
        })
        .collect()
}

fn run_document(run: &Run) -> Value {
    let estimates = run
        .on_line
        .iter()
        .map(|result| estimate(result.name, Some(run), Some(result)));
    json!({
        "free_decay": run.is_free_decay,
        "from_s": run.stretch.from,
        "until_s": run.stretch.until,
        "estimates": estimates.collect::<Vec<_>>(),
        "offline": off_line(run),
    })
}
