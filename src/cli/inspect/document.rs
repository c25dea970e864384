//! What `quell inspect --json` tells of a recording.

use super::together;
use crate::recording::Recording;
use crate::recording::health::{ColumnHealth, Flat, FlatKind, Health, remarks};
use serde_json::{Value, json};

/// The channels of a recording with their figures.
pub fn document(recording: &Recording, figures: &[Health]) -> Value {
    let channels = recording
        .channels
        .iter()
        .zip(figures)
        .map(|(channel, health)| {
            let clock = &health.clock;
            let gaps = clock.gaps.iter().map(
                |gap| json!({"from_s": gap.from, "until_s": gap.until, "missing": gap.missing}),
            );
            json!({
                "role": channel.role.name(),
                "unit": channel.unit,
                "samples": clock.samples,
                "start_s": clock.start,
                "duration_s": clock.duration,
                "rate_hz": clock.rate(),
                "rate_std_hz": clock.rate_std(),
                "jitter_s": clock.jitter,
                "worst_jitter_s": clock.worst_jitter,
                "missing_samples": clock.missing,
                "gaps": gaps.collect::<Vec<_>>(),
                "columns": health.columns.iter().map(column_document).collect::<Vec<_>>(),
                "remarks": remarks(channel, health),
            })
        });
    json!({
        "name": recording.name,
        "channels": channels.collect::<Vec<_>>(),
        "remarks": together(recording),
    })
}

fn column_document(column: &ColumnHealth) -> Value {
    json!({
        "minimum": column.minimum,
        "maximum": column.maximum,
        "noise_std": column.noise_std,
        "quantisation_step": column.quantum,
        "flat_stretches": column.flats.iter().map(flat_document).collect::<Vec<_>>(),
        "wraps_s": column.wraps,
        "spikes_s": column.spikes,
    })
}

fn flat_document(flat: &Flat) -> Value {
    let kind = match flat.kind {
        FlatKind::Rest => "rest",
        FlatKind::Stuck => "stuck",
        FlatKind::Saturated => "saturated",
    };
    json!({
        "kind": kind,
        "from_s": flat.from,
        "until_s": flat.until,
        "samples": flat.samples,
        "value": flat.value,
    })
}
