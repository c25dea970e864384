//! The health of a channel: its clock, its resolution, and values that cannot be motion.
//!
//! A pure function from a channel to figures; [`remarks`] puts them into words.

mod clipped;
mod clock;
mod remarks;
mod resolution;
mod rounded;
mod stretches;

pub use clipped::{Clipped, clipped, clipped_axes};
pub use clock::{Clock, Gap, clock};
pub use remarks::{JITTER, at_limit, mixed_rates, remarks};
pub use resolution::{is_rounding, noise_std, quantum, shows_noise};
pub use rounded::Rounded;
pub use stretches::{Flat, FlatKind, flats, spikes, wraps};

use super::Channel;

/// The health of a channel, from its values alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Its clock.
    pub clock: Clock,
    /// Its columns, in order.
    pub columns: Vec<ColumnHealth>,
}

/// The health of one column; values in the channel's SI unit, times in s.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnHealth {
    /// Least value.
    pub minimum: f64,
    /// Greatest value.
    pub maximum: f64,
    /// Standard deviation of white noise, see [`noise_std`].
    pub noise_std: Option<f64>,
    /// Quantisation step, see [`quantum`].
    pub quantum: Option<f64>,
    /// Long runs of one value, see [`flats`].
    pub flats: Vec<Flat>,
    /// Times of the samples after a jump by a turn, see [`wraps`].
    pub wraps: Vec<f64>,
    /// Times of single samples far from both neighbours, see [`spikes`].
    pub spikes: Vec<f64>,
}

/// The figures of a channel. Cost: O(n log n) for n samples.
pub fn health(channel: &Channel) -> Health {
    let clock = clock(&channel.time);
    let columns = channel.columns.iter().map(|column| {
        let noise_std = noise_std(column);
        let quantum = quantum(column);
        let times = |samples: Vec<usize>| samples.into_iter().map(|i| channel.time[i]).collect();
        let is_angle = channel.unit == "rad";
        ColumnHealth {
            minimum: column.iter().copied().fold(f64::INFINITY, f64::min),
            maximum: column.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            flats: flats(&channel.time, column, quantum.unwrap_or(0.0)),
            wraps: if is_angle {
                times(wraps(column))
            } else {
                Vec::new()
            },
            spikes: times(spikes(
                column,
                noise_std.unwrap_or(0.0),
                quantum.unwrap_or(0.0),
            )),
            noise_std,
            quantum,
        }
    });
    Health {
        columns: columns.collect(),
        clock,
    }
}

/// The middle value (the upper one of an even number), 0 where there is none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
