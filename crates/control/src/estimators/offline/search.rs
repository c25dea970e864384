//! The start of a batch fit: the best of many descents, from a grid of frequencies, in a part of the record.

use core::f64::consts::TAU;

use levenberg_marquardt::LevenbergMarquardt;

use super::output_error::Problem;
use super::point::{Point, point_of, pole};
use crate::estimators::{Sample, Settings};

/// Samples of the part in which every start descends, and of the longer part that separates their ends.
///
/// The end of the record may be a hundred times as far away as the end of the longer part, and that ten times
/// as far as the end of the shorter one. With noise of a tenth of the amplitude, `N` samples determine the
/// phase of an undamped mode there to `0.1 sqrt(24 / N)` rad times that ratio, 0.15 and 0.05 rad. So the
/// minimum for the part lies in the basin of that for the whole.
///
/// Source: variance of a frequency, D. C. Rife, R. R. Boorstyn, IEEE Trans. Inf. Theory 20 (1974) 591-598.
const PARTS: [usize; 2] = [10_000, 100_000];

/// Relative change of the cost, and of the unknowns, at which a descent in a part ends. For `N` samples the
/// cost is then within `1e-6 N` variances of the noise: a tenth of a standard deviation of the unknowns in the
/// shorter part, a third in the longer. The next descent continues from there.
const SEARCH: f64 = 1e-6;

/// Ratio of neighbouring starts.
const RATIO: f64 = 1.25;
/// Least damping ratio of a start. Its response lasts `1 / (xi w)`. In that time a start that is off by half a
/// [`RATIO`] in frequency turns by `ln(1.25) / 2 / 0.05 = 2.2` rad relative to the right one, less than half a
/// turn, so that the descent does not end a whole turn away.
const DAMPING: f64 = 0.05;

/// Evaluations of a descent, divided by the number of unknowns plus one. From half a [`RATIO`] to [`SEARCH`]
/// the error halves 17 times; 20 allow eight trials for each halving.
const PATIENCE: usize = 20;

/// The part of a long record in which a mode is searched: the part of sufficient length whose deformation
/// varies most. All samples of a shorter record.
pub fn telling(samples: &[Sample]) -> &[Sample] {
    highest_energy(samples, PARTS[1])
}

/// The part of `count` samples whose deformation varies most, of all parts that begin at a multiple of `count`
/// and of the last `count` samples. All samples where they are fewer.
fn highest_energy(samples: &[Sample], count: usize) -> &[Sample] {
    let Some(last) = samples.len().checked_sub(count) else {
        return samples;
    };
    let variance = |part: &[Sample]| {
        let n = part.len() as f64;
        let mean = part.iter().map(|s| s.deformation).sum::<f64>() / n;
        part.iter()
            .map(|s| (s.deformation - mean).powi(2))
            .sum::<f64>()
            / n
    };
    let parts = (0..last).step_by(count).chain([last]);
    parts
        .map(|first| &samples[first..first + count])
        .max_by(|a, b| variance(a).total_cmp(&variance(b)))
        .unwrap_or(samples)
}

/// The best end of all starts over the range of frequencies.
pub fn best_start(samples: &[Sample], settings: &Settings) -> Option<Point> {
    let long = telling(samples);
    let short = highest_energy(long, PARTS[0]);
    let mut starts = grid(settings);
    if short.len() < long.len() {
        starts = places(short, settings, &starts);
    }
    let method = LevenbergMarquardt::new().with_tol(SEARCH);
    starts
        .into_iter()
        .filter_map(|start| descend(&method, long, settings, start))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(end, _)| end.point)
}

/// Starts over the range of frequencies.
fn grid(settings: &Settings) -> Vec<Point> {
    let (low, high) = settings.frequency_range;
    let intervals = ((high / low).ln() / RATIO.ln()).ceil().max(1.0);
    let damping = settings.belief.map_or(DAMPING, |mode| mode.damping_ratio());
    (0..=intervals as usize)
        .map(|k| low * (high / low).powf(k as f64 / intervals))
        .map(|w| point_of(w, damping.max(DAMPING)))
        .collect()
}

/// The different ends of the starts in a part. A start whose descent fails is kept itself, and so is each with
/// less than two periods in the part, which cannot separate it from a drift or from another such start.
fn places(part: &[Sample], settings: &Settings, starts: &[Point]) -> Vec<Point> {
    let method = LevenbergMarquardt::new().with_tol(SEARCH);
    let duration = part[part.len() - 1].time - part[0].time;
    let is_slow = |start: &&Point| 2.0 * TAU > duration * start[0].exp();
    let slow: Vec<Point> = starts.iter().filter(is_slow).copied().collect();
    let mut places: Vec<Point> = Vec::new();
    for start in starts.iter().filter(|start| !is_slow(start)) {
        let end = descend(&method, part, settings, *start);
        let place = end.map_or(*start, |(end, _)| end.point);
        // Poles that are nearer have the same response within the part.
        let is_near = |other: &Point| (pole(other) - pole(&place)).norm() * duration < 1.0;
        if !places.iter().any(is_near) {
            places.push(place);
        }
    }
    places.extend(slow);
    places
}

/// A descent from a start: its end and the cost there. `None` if the end is farther outside the range of
/// frequencies than one step of the grid, or not finite.
pub fn descend<'a>(
    method: &LevenbergMarquardt<f64>,
    samples: &'a [Sample],
    settings: &'a Settings,
    start: Point,
) -> Option<(Problem<'a>, f64)> {
    let problem = Problem::new(samples, settings, start);
    let (end, report) = method.with_patience(PATIENCE).minimize(problem);
    let (low, high) = settings.frequency_range;
    let w = end.point[0].exp();
    let inside = w >= low / RATIO && w <= high * RATIO;
    let cost = report.objective_function;
    (inside && cost.is_finite()).then_some((end, cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(time: f64, deformation: f64) -> Sample {
        Sample {
            time,
            motor_position: 0.0,
            deformation,
        }
    }

    /// Samples of which those of a range ring.
    fn ringing(count: usize, range: core::ops::Range<usize>) -> Vec<Sample> {
        let value = |k: usize| {
            if range.contains(&k) {
                (k as f64).sin()
            } else {
                0.0
            }
        };
        (0..count).map(|k| sample(k as f64, value(k))).collect()
    }

    #[test]
    fn the_highest_energy_part_may_be_the_first_one_between_and_the_last() {
        for (range, first) in [
            (0..5_000, 0),
            (10_000..15_000, 10_000),
            (24_000..29_000, 19_000),
        ] {
            let samples = ringing(29_000, range);
            let part = highest_energy(&samples, 10_000);
            assert_eq!(part, &samples[first..first + 10_000]);
        }
        // Less than two parts: all that rings is in what is left of the first.
        let samples = ringing(19_000, 13_000..19_000);
        assert_eq!(highest_energy(&samples, 10_000), &samples[9_000..]);
        let short = &samples[..10_000];
        assert_eq!(highest_energy(short, 10_000), short);
        assert_eq!(highest_energy(&short[1..], 10_000), &short[1..]);
    }
}
