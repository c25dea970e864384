//! Readings at the limits of a sensor's range.

use crate::Channel;

/// Standard deviations of a count beyond which it is not chance: 0.1 % on one side.
const BEYOND: f64 = 3.0;

/// Readings that stay at a limit of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Clipped {
    /// The limit; of two, the one with more readings.
    pub limit: f64,
    /// The samples there, at both limits.
    pub samples: Vec<usize>,
}

/// Readings at the limits of a sensor's range; `None` where none stays there.
///
/// The top of a vibration is round: the time that it is within a step of its top grows as the root of that step, so
/// that the next step has `sqrt(2) - 1` of the first one's samples, or more. A limit has more than that beyond its
/// next value, by three standard deviations of the counts. The value of most samples is not a limit: it is rest.
///
/// # Example
/// ```
/// use quell_recording::health::clipped;
/// let wave = |k: usize| (0.07 * k as f64).sin();
/// let round: Vec<f64> = (0..1000).map(|k| (50.0 * wave(k)).round()).collect();
/// assert_eq!(clipped(&round), None);
/// let cut: Vec<f64> = (0..1000).map(|k| wave(k).clamp(-1.0, 0.8)).collect();
/// assert_eq!(clipped(&cut).unwrap().limit, 0.8);
/// ```
pub fn clipped(values: &[f64]) -> Option<Clipped> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = *sorted.get(sorted.len() / 2)?;
    let ends = [limit(sorted.iter()), limit(sorted.iter().rev())];
    let limits = ends.into_iter().flatten();
    let limits: Vec<(f64, usize)> = limits.filter(|(limit, _)| *limit != middle).collect();
    let is_there = |sample: &usize| limits.iter().any(|(limit, _)| *limit == values[*sample]);
    let (limit, _) = *limits.iter().max_by_key(|(_, count)| count)?;
    Some(Clipped {
        limit,
        samples: (0..values.len()).filter(is_there).collect(),
    })
}

/// The same for each axis of an accelerometer that has any; other channels stop at values of their own, as a joint
/// at an end of its travel.
pub fn clipped_axes(channel: &Channel) -> Vec<Clipped> {
    match channel.role.is_acceleration() {
        true => channel
            .columns
            .iter()
            .filter_map(|axis| clipped(axis))
            .collect(),
        false => Vec::new(),
    }
}

/// The first of sorted values and its count, if that is too large beside the count of the next value.
fn limit<'a>(mut sorted: impl Iterator<Item = &'a f64> + Clone) -> Option<(f64, usize)> {
    let first = *sorted.clone().next()?;
    let count = sorted.clone().take_while(|value| **value == first).count();
    let next = *sorted.nth(count)?;
    let beside = 1 + sorted.take_while(|value| **value == next).count();
    let ratio = 1.0 / (std::f64::consts::SQRT_2 - 1.0);
    let (own, beside) = (count as f64, beside as f64);
    let chance = (own + ratio * ratio * beside).sqrt();
    (own - ratio * beside > BEYOND * chance).then_some((first, count))
}
