//! Rests of the motor side, and the free decays within them.

use core::f64::consts::PI;

use quell_control::estimators::offline::{Extremum, batch_fit, extrema};
use quell_control::estimators::{Sample, Settings};
use quell_signal::{Motion, RestRule, noise_floor, phases};

/// A part of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// First instant, s.
    pub from: f64,
    /// Last instant, s.
    pub until: f64,
}

impl Stretch {
    /// From the first of some samples to the last.
    pub(super) fn all(samples: &[Sample]) -> Self {
        Self {
            from: samples[0].time,
            until: samples[samples.len() - 1].time,
        }
    }

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

/// Rests of the motor side that follow a motion. They can hold two periods of the slowest mode in range, or are
/// a tenth of the record.
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

/// Most samples of rests that are searched: hundreds of decays. The strongest of them is quoted, and a further
/// one adds little information on the frequency to that of motion and decays together.
const LOOKED_AT: usize = 100_000;

/// The rests that are searched. All, or if these hold more than [`LOOKED_AT`] samples, a share of them that
/// holds about as many; each is cut to at most as many samples from its start.
///
/// Rest `k` is included if the fractional part of `k` over the golden ratio is less than the share. So they are
/// spread evenly (the distance from one to the next takes three values), and each move of a repeating programme
/// is included in turn: no multiple of an irrational number is an integer.
/// Source: H. Weyl, Math. Ann. 77 (1916) 313-352; three distances: V. T. Sos, Ann. Univ. Sci. Budapest 1 (1958)
/// 127-134.
pub fn evenly(samples: &[Sample], rests: &[Stretch]) -> Vec<Stretch> {
    let cut = |rest: &Stretch| {
        let within = rest.of(samples);
        let last = within.get(LOOKED_AT - 1);
        Stretch {
            until: last.map_or(rest.until, |sample| sample.time),
            ..*rest
        }
    };
    let rests: Vec<Stretch> = rests.iter().map(cut).collect();
    let held: usize = rests.iter().map(|rest| rest.of(samples).len()).sum();
    let share = LOOKED_AT as f64 / held as f64;
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let numbered = rests.into_iter().enumerate();
    let looked_at = numbered.filter(|(k, _)| (*k as f64 * golden).fract() < share);
    looked_at.map(|(_, rest)| rest).collect()
}

/// Share of the range below which a displacement is no motion: it excites that share of the vibration by the moves,
/// far less than a sensor sees. Traces of arithmetic in a position without noise would be motion.
const UNSEEN: f64 = 1e-6;

/// First motion of the motor side, s; the record's start where it always rests.
pub fn motion_from(samples: &[Sample]) -> f64 {
    let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
    let position: Vec<f64> = samples.iter().map(|s| s.motor_position).collect();
    let rule = RestRule::from_values(&position).above(UNSEEN, &position);
    phases(&time, &position, rule)
        .unwrap_or_default()
        .into_iter()
        .find(|phase| phase.motion == Motion::Moving)
        .map_or(time[0], |phase| phase.start)
}

/// The free decay within a rest: the longest run of extrema at distances of half a period.
///
/// After the end of a motion, the response of a sensor's own filter, or of a motor side that still settles,
/// dies out sooner than a lightly damped mode. While it lasts, the extrema are unevenly spaced. Spacing counts
/// as even within 15 % of half a period: noise of a tenth of the amplitude shifts an extremum by 3 %, and twice
/// that on both ends of an interval is 13 %. Where all are even, the decay begins with the rest. `None` where
/// fewer than three extrema (a period) exceed the noise.
pub fn free_decay(samples: &[Sample], rest: Stretch, settings: &Settings) -> Option<FreeDecay> {
    let within = rest.of(samples);
    // The frequency is taken from the rest's last two thirds, where only the mode is left.
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
    // One more period after the last visible extremum; beyond it there is only noise.
    let until = rest.until.min(last.time + 2.0 * half_period);
    Some(FreeDecay {
        stretch: Stretch { from, until },
        extrema: regular.to_vec(),
    })
}

/// Largest remaining motion of the motor side, relative to the vibration, that counts as standstill. A step by
/// `e` adds a vibration of amplitude `e`, which turns its phase by 0.01 rad at most.
const STANDSTILL: f64 = 0.01;

/// The instant, before `latest`, from which the motor side stays within `tolerance` (rad) of its position at
/// `latest`.
fn standstill(within: &[Sample], latest: f64, tolerance: f64) -> f64 {
    let last = within.partition_point(|s| s.time <= latest).max(1);
    let end = within[last - 1].motor_position;
    let away = |s: &Sample| (s.motor_position - end).abs() > tolerance;
    let still = within[..last].iter().rposition(away);
    within[still.map_or(0, |moving| (moving + 1).min(last - 1))].time
}

/// Leaves out first cycles whose logarithmic decrement is an outlier: something other than the mode decays in
/// them.
///
/// An outlier is more than three standard deviations (of a normal distribution with the same median absolute
/// deviation) off the median, among five cycles or more.
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

/// The longest run of extrema with evenly spaced neighbours.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Rests of so many samples, a second apart in number of samples, and the samples of all.
    fn rests(count: usize, length: usize) -> (Vec<Sample>, Vec<Stretch>) {
        let sample = |k: usize| Sample {
            time: k as f64,
            motor_position: 0.0,
            deformation: 0.0,
        };
        let samples = (0..count * (length + 1)).map(sample).collect();
        let stretch = |k: usize| Stretch {
            from: (k * (length + 1)) as f64,
            until: (k * (length + 1) + length - 1) as f64,
        };
        (samples, (0..count).map(stretch).collect())
    }

    #[test]
    fn what_is_looked_at_is_even_and_sees_every_move_of_a_programme() {
        let (samples, all) = rests(4000, 100);
        let looked_at = evenly(&samples, &all);
        let number = |rest: &Stretch| all.iter().position(|one| one == rest).unwrap();
        let numbers: Vec<usize> = looked_at.iter().map(number).collect();
        // A quarter, but for what an even spread of 4000 is off by: the logarithm of their number.
        assert!(numbers.len().abs_diff(1000) < 10, "{}", numbers.len());
        let mut apart: Vec<usize> = numbers.windows(2).map(|two| two[1] - two[0]).collect();
        apart.sort_unstable();
        apart.dedup();
        assert!(apart.len() <= 3, "{apart:?}");
        // Programmes that repeat themselves after two moves (there and back), four, which every fourth rest
        // would never leave, and numbers that the golden ratio knows.
        for moves in [2, 3, 4, 5, 8, 13] {
            for place in 0..moves {
                let seen = numbers.iter().filter(|&&k| k % moves == place).count();
                let expected = numbers.len() / moves;
                assert!(
                    seen.abs_diff(expected) < 10,
                    "{place} of {moves}: {seen} of {expected}"
                );
            }
        }
    }

    #[test]
    fn few_rests_are_all_looked_at_and_a_long_one_from_its_start_on() {
        let (samples, all) = rests(100, 1000);
        assert_eq!(evenly(&samples, &all), all);
        assert!(evenly(&samples, &[]).is_empty());
        let (samples, all) = rests(1, 3 * LOOKED_AT);
        let looked_at = evenly(&samples, &all);
        assert_eq!(looked_at.len(), 1);
        assert_eq!(looked_at[0].of(&samples).len(), LOOKED_AT);
        assert_eq!(looked_at[0].from, all[0].from);
    }
}
