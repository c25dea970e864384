//! Where the motor side rests, and from where on the deformation is a free decay.

use core::f64::consts::PI;

use crate::estimators::offline::{Extremum, batch_fit, extrema};
use crate::estimators::{Sample, Settings};
use crate::signal::{Motion, RestRule, noise_floor, phases};

/// A part of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// First instant, s.
    pub from: f64,
    /// Last instant, s.
    pub until: f64,
}

impl Stretch {
    /// The samples within.
    pub fn of<'a>(&self, samples: &'a [Sample]) -> &'a [Sample] {
        let first = samples.partition_point(|s| s.time < self.from);
        let last = samples.partition_point(|s| s.time <= self.until);
        &samples[first..last.max(first)]
    }
}

/// A free decay within a rest.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeDecay {
    /// Where it is.
    pub stretch: Stretch,
    /// Its extrema, half a period apart.
    pub extrema: Vec<Extremum>,
}

/// Rests of the motor side that follow a motion and could hold two periods of the slowest mode
/// that is looked for, or are a tenth of the record.
pub fn rests(samples: &[Sample], settings: &Settings) -> Vec<Stretch> {
    let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
    let position: Vec<f64> = samples.iter().map(|s| s.motor_position).collect();
    let floor = noise_floor(&position);
    let rule = RestRule::new(floor.standard_deviation, floor.quantisation.unwrap_or(0.0));
    let (first, last) = (time[0], time[time.len() - 1]);
    let slowest = 4.0 * PI / settings.frequency_range.0;
    let shortest = slowest.min(0.1 * (last - first));
    phases(&time, &position, rule)
        .unwrap_or_default()
        .into_iter()
        .filter(|phase| phase.motion == Motion::Rest && phase.start > first)
        .filter(|phase| phase.end - phase.start >= shortest)
        .map(|phase| Stretch {
            from: phase.start,
            until: phase.end,
        })
        .collect()
}

/// Samples of rests that are looked at: hundreds of decays. What is quoted is the strongest of them, and
/// what a further one adds to the frequency is little against what motion and decays together say.
const ENOUGH: usize = 100_000;

/// Every `n`th of the rests, so that they hold [`ENOUGH`] samples or less, and `n`; all where they are one.
pub fn thinned(samples: &[Sample], rests: Vec<Stretch>) -> (Vec<Stretch>, usize) {
    let held: usize = rests.iter().map(|rest| rest.of(samples).len()).sum();
    let every = held.div_ceil(ENOUGH).clamp(1, rests.len().max(1));
    (rests.into_iter().step_by(every).collect(), every)
}

/// First motion of the motor side, s; the record's start where it always rests.
pub fn motion_from(samples: &[Sample]) -> f64 {
    let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
    let position: Vec<f64> = samples.iter().map(|s| s.motor_position).collect();
    phases(&time, &position, RestRule::from_values(&position))
        .unwrap_or_default()
        .into_iter()
        .find(|phase| phase.motion == Motion::Moving)
        .map_or(time[0], |phase| phase.start)
}

/// The free decay within a rest: the longest run of extrema that follow each other at half a
/// period.
///
/// What a sensor's own filter, or a motor side that still settles, adds after the motion's end dies
/// out sooner than a lightly damped mode; while it lasts the extrema are unevenly spaced. Spacing
/// counts as even within 15 % of half a period: noise of a tenth of the amplitude shifts an
/// extremum by 3 %, and twice that on both ends of an interval is 13 %. Where all are even
/// the decay begins with the rest. `None` where fewer than three extrema (a period) rise out of the
/// noise.
pub fn free_decay(samples: &[Sample], rest: Stretch, settings: &Settings) -> Option<FreeDecay> {
    let within = rest.of(samples);
    // The frequency from the rest's last two thirds, where only the mode is left.
    let late = Stretch {
        from: rest.from + (rest.until - rest.from) / 3.0,
        ..rest
    };
    let fit = batch_fit(late.of(samples), settings, false)
        .or_else(|| batch_fit(within, settings, false))?;
    let values: Vec<f64> = within.iter().map(|s| s.deformation).collect();
    let noise = noise_floor(&values).standard_deviation;
    let found = extrema(within, fit.mode.damped_frequency(), fit.offset, 3.0 * noise);
    let half_period = 0.5 * fit.mode.damped_period();
    let even = |pair: &[Extremum]| ((pair[1].time - pair[0].time) / half_period - 1.0).abs() < 0.15;
    let regular = steady(longest_run(&found, even));
    let [begin, _, .., last] = regular else {
        return None;
    };
    let early = begin.time - rest.from < 1.2 * half_period;
    let from = if begin.time == found[0].time && early {
        let amplitude = 0.5 * (regular[1].height - regular[0].height).abs();
        standstill(within, rest.from + half_period, STANDSTILL * amplitude)
    } else {
        begin.time
    };
    // One more period after the last extremum that is seen: beyond there is only noise.
    let until = rest.until.min(last.time + 2.0 * half_period);
    Some(FreeDecay {
        stretch: Stretch { from, until },
        extrema: regular.to_vec(),
    })
}

/// The motor side stands still once what is left of its motion is this part of the vibration: a step
/// by `e` adds a vibration of amplitude `e`, which turns its phase by 0.01 rad at most.
const STANDSTILL: f64 = 0.01;

/// From when on, before `latest`, the motor side stays within `tolerance` (rad) of where it is then.
fn standstill(within: &[Sample], latest: f64, tolerance: f64) -> f64 {
    let last = within.partition_point(|s| s.time <= latest).max(1);
    let end = within[last - 1].motor_position;
    let away = |s: &Sample| (s.motor_position - end).abs() > tolerance;
    let still = within[..last].iter().rposition(away);
    within[still.map_or(0, |moving| (moving + 1).min(last - 1))].time
}

/// Leaves out first cycles whose logarithmic decrement stands out from the others': more than the mode
/// decays in them.
///
/// Out of line is what lies more than three standard deviations (of a normal distribution with the same
/// median absolute deviation) off the median, among five cycles or more.
fn steady(mut extrema: &[Extremum]) -> &[Extremum] {
    loop {
        let amplitude: Vec<f64> = extrema
            .windows(2)
            .map(|pair| (pair[1].height - pair[0].height).abs())
            .collect();
        let decrement: Vec<f64> = amplitude
            .windows(3)
            .map(|three| (three[0] / three[2]).ln())
            .collect();
        let Some(first) = decrement.first().filter(|_| decrement.len() >= 5) else {
            return extrema;
        };
        let centre = median(&decrement);
        let off: Vec<f64> = decrement.iter().map(|d| (d - centre).abs()).collect();
        if (first - centre).abs() <= 3.0 * 1.4826 * median(&off) {
            return extrema;
        }
        extrema = &extrema[1..];
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// The longest run of extrema of which all neighbours are even.
fn longest_run(found: &[Extremum], even: impl Fn(&[Extremum]) -> bool) -> &[Extremum] {
    let mut best = 0..0;
    let mut begin = 0;
    for k in 0..found.len() {
        if k > begin && !even(&found[k - 1..=k]) {
            begin = k;
        }
        if k + 1 - begin > best.len() {
            best = begin..k + 1;
        }
    }
    &found[best]
}
