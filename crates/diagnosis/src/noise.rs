//! The noise floor of an output: level and colour.

use super::autocorrelation::correlation;
use super::detrended::detrended;
use super::noise_colour::colour;
use super::steady_lines::without_lines;
use super::whitening::Whitening;
use nalgebra::DVector;
use quell_model::{Experiment, Output};
use quell_recording::Role;
use quell_signal::{Motion, RestRule, noise_floor, phases};

/// Fewest samples at rest that determine the colour of the noise.
const FEWEST: usize = 150;

/// Ratio of two estimates of a standard deviation, each from a hundred samples or more, beyond chance.
pub const LOUDER: f64 = 1.2;

/// Relative error within which the level of the noise is to be known, at three standard deviations.
const TENTH: f64 = 0.1;

/// Greatest ratio between the noise of one coordinate of a sensor and that of the others.
const WITNESS: f64 = 3.0;

/// Standard deviation of noise with one pole at 0.95, relative to what its third differences show. Slower noise
/// is drift. With a pole `r` the variance of third differences is `20 - 30 r + 12 r^2 - 2 r^3` times the
/// noise's, against 20 for white noise.
pub const REDDEST: f64 = 5.7;

/// Shortest stretch, in samples, whose variance is worth comparing.
const SHORTEST: usize = 40;

/// Noise of an output from the residual of a refitted model, its offset taken out.
///
/// It is estimated at rest: from stretches where the motor side rests and the vibration, which decays at
/// `decay` (1/s), has died away; their mean is taken out. Without such rest it is estimated from frequencies
/// far above the vibration's `frequency` (rad/s), or from third differences, which do not see smooth signals.
/// It is never below the rounding.
pub fn noise(
    experiment: &Experiment,
    output: &Output,
    residual: &[f64],
    rates: (f64, f64),
) -> Whitening {
    let found = shown(experiment, output, residual, rates);
    // The noise is no larger than the whole residual.
    let left = residual.iter().map(|r| r * r).sum::<f64>() / residual.len() as f64;
    let times = left.sqrt() / found.deviation;
    // If a sensor shows only a few values, its steps are all that is known.
    let coarse = least_increment(&output.values).is_some();
    match times < 1.0 && left > 0.0 && !coarse {
        true => found.louder(times),
        false => found,
    }
}

fn shown(
    experiment: &Experiment,
    output: &Output,
    residual: &[f64],
    (frequency, decay): (f64, f64),
) -> Whitening {
    let white = noise_floor(residual).standard_deviation;
    let least = rounding(output).max(f64::MIN_POSITIVE);
    let quiet = quiet(experiment, output, decay);
    let stretches = at_rest(output, residual, &quiet);
    let count: usize = stretches.iter().map(Vec::len).sum();
    let views: Vec<&[f64]> = stretches.iter().map(Vec::as_slice).collect();
    let found = match count >= FEWEST {
        true => Whitening::fit(&views),
        false => restless(experiment, output, residual, frequency)
            .unwrap_or_else(|| Whitening::white(white)),
    };
    // A signal much larger than its roughness is no noise: it is a vibration or a drift at rest.
    if found.deviation > REDDEST * white && white > 0.0 {
        return Whitening::white(white.max(least));
    }
    // The noise at rest is not used if the sensor rounds: then it is quieter at rest than in motion. That shows
    // if it is below the rounding, or much below the third differences in motion.
    let moving = noise_floor(&busy(residual, &quiet)).standard_deviation;
    if moving > LOUDER * found.deviation {
        return Whitening::white(moving.max(least));
    }
    // Other coordinates of a sensor are about as noisy as this one.
    let witness = output.noise_witness.unwrap_or(f64::INFINITY);
    if found.deviation > WITNESS * witness {
        return Whitening::white(witness.max(white).max(least));
    }
    if found.deviation < least || found.innovation < 0.7 * white {
        return Whitening::white(white.max(least));
    }
    match count < FEWEST || 3.0 * scatter(&stretches) < TENTH {
        true => found,
        false => with_motion(restless(experiment, output, residual, frequency), found),
    }
}

/// The signal in stretches of rest, without its trend. At rest the recorded signal is noise, too. The model's motion there is not,
/// for example if its start compensates for missing physics.
fn at_rest(output: &Output, residual: &[f64], quiet: &[std::ops::Range<usize>]) -> Vec<Vec<f64>> {
    let quieter = |range: &std::ops::Range<usize>| {
        let [left, all] = [residual, &output.values].map(|values| still(&values[range.clone()]));
        if power(&all.concat()) < power(&left.concat()) {
            all
        } else {
            left
        }
    };
    quietest(quiet.iter().flat_map(quieter).collect())
}

/// A rest without its trend, what rings for a while, and steady vibrations.
fn still(rest: &[f64]) -> Vec<Vec<f64>> {
    let steady = steady(detrended(rest)).into_iter();
    steady.map(without_lines).collect()
}

/// A rest, or those thirds of it that are as quiet as the quietest one, where the others are louder by more than chance: what
/// hit the machine there makes it ring.
fn steady(rest: Vec<f64>) -> Vec<Vec<f64>> {
    if rest.len() < 3 * SHORTEST {
        return vec![rest];
    }
    let thirds: Vec<&[f64]> = rest.chunks(rest.len().div_ceil(3)).collect();
    let quietest = thirds.iter().min_by(|a, b| power(a).total_cmp(&power(b)));
    let most = quietest.map_or(0.0, |own| {
        let independent = own.len() as f64 / correlation(&DVector::from_column_slice(own));
        power(own) * beyond_chance(independent)
    });
    match thirds.iter().all(|own| power(own) <= most) {
        true => vec![rest],
        false => {
            let quiet = thirds.into_iter().filter(|own| power(own) <= most);
            quiet.map(detrended).collect()
        }
    }
}

/// Largest variance of the noise that its scatter at rest allows; `None` where no rest is as long as `shortest` (s).
pub fn most_at_rest(
    experiment: &Experiment,
    output: &Output,
    residual: &[f64],
    (decay, shortest): (f64, f64),
) -> Option<f64> {
    let quiet = quiet(experiment, output, decay);
    let rest = at_rest(output, residual, &quiet).concat();
    let last = output.time.len().checked_sub(1)?;
    let period = (output.time[last] - output.time[0]) / last as f64;
    let is_long = rest.len() >= FEWEST && rest.len() as f64 * period >= shortest;
    let independent = || rest.len() as f64 / correlation(&DVector::from_column_slice(&rest));
    is_long.then(|| power(&rest) * beyond_chance(independent()))
}

/// Relative standard deviation of the level of the noise in these stretches.
fn scatter(stretches: &[Vec<f64>]) -> f64 {
    let rest = DVector::from_vec(stretches.concat());
    (correlation(&rest) / (2 * rest.len()) as f64).sqrt()
}

/// The noise at a short rest, or that above the vibration, which all samples show, if both are the same one.
fn with_motion(all: Option<Whitening>, rest: Whitening) -> Whitening {
    let is_same = |all: &Whitening| {
        let ratio = all.deviation / rest.deviation;
        ratio < LOUDER && ratio > LOUDER.recip()
    };
    all.filter(is_same).unwrap_or(rest)
}

/// Noise of a sensor by rounding: `q / sqrt 12`, 0 without rounding.
pub fn rounding(output: &Output) -> f64 {
    step(output).map_or(0.0, |step| step / 12f64.sqrt())
}

/// The step `q` to which a sensor rounds: that of its changes or, if it shows a few values only, the least distance between
/// these.
pub fn step(output: &Output) -> Option<f64> {
    let step = output
        .coordinate_step
        .or_else(|| noise_floor(&output.values).quantisation);
    step.or_else(|| least_increment(&output.values))
}

/// Most distinct values whose distances are taken for steps: eight values are on such a grid by chance once in
/// 1e5.
const FEW: usize = 7;

fn least_increment(values: &[f64]) -> Option<f64> {
    let mut distinct: Vec<f64> = Vec::new();
    for value in values {
        if !distinct.contains(value) {
            distinct.push(*value);
        }
        if distinct.len() > FEW {
            return None;
        }
    }
    distinct.sort_by(f64::total_cmp);
    let increments = distinct.windows(2).map(|pair| pair[1] - pair[0]);
    increments.min_by(f64::total_cmp)
}

/// Noise where the motor side, whose motion is known, hardly rests.
fn restless(
    experiment: &Experiment,
    output: &Output,
    residual: &[f64],
    frequency: f64,
) -> Option<Whitening> {
    let last = output.time.len().checked_sub(1)?;
    let period = (output.time[last] - output.time[0]) / last as f64;
    if !moved(experiment) {
        return None;
    }
    colour(residual, period, frequency)
}

/// Whether the input is a motion, whose spectrum falls with frequency.
fn moved(experiment: &Experiment) -> bool {
    matches!(
        experiment.input,
        Role::MotorPosition | Role::CommandPosition
    )
}

/// Stretches as quiet as the quietest one, within the chance scatter for stretches of at least [`SHORTEST`]
/// samples. A louder one still rings and is no noise.
fn quietest(stretches: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let long = stretches.iter().filter(|s| s.len() >= SHORTEST);
    let least = long.map(|s| power(s)).fold(f64::INFINITY, f64::min);
    let most = least * beyond_chance(SHORTEST as f64);
    let quiet = |s: &Vec<f64>| s.len() >= SHORTEST && power(s) <= most;
    stretches.into_iter().filter(quiet).collect()
}

/// Ratio of two variances of so many independent samples each that chance does not exceed: four standard deviations, both ways.
fn beyond_chance(samples: f64) -> f64 {
    1.0 + 8.0 * (2.0 / samples).sqrt()
}

fn power(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64
}

/// Stretches of rest after the vibration has decayed.
fn quiet(experiment: &Experiment, output: &Output, decay: f64) -> Vec<std::ops::Range<usize>> {
    if !moved(experiment) {
        return Vec::new();
    }
    let (time, values) = (&experiment.input_time, &experiment.input_values);
    let found = phases(time, values, RestRule::from_values(values)).unwrap_or_default();
    // After five time constants 0.7 % of the vibration is left.
    let settled = 5.0 / decay;
    let at = |t: f64| output.time.partition_point(|s| *s < t);
    let mut ranges = Vec::new();
    for (index, phase) in found.iter().enumerate() {
        if phase.motion == Motion::Rest {
            let start = phase.start + if index == 0 { 0.0 } else { settled };
            let range = at(start + 0.01)..at(phase.end - 0.01);
            if range.len() >= 20 {
                ranges.push(range);
            }
        }
    }
    ranges
}

/// The values outside of the ranges, which are in order.
fn busy(values: &[f64], ranges: &[std::ops::Range<usize>]) -> Vec<f64> {
    let ends = ranges.iter().map(|range| range.end);
    let begins = ranges.iter().map(|range| range.start);
    let between = std::iter::once(0)
        .chain(ends)
        .zip(begins.chain([values.len()]));
    between
        .flat_map(|(from, to)| &values[from..to.max(from)])
        .copied()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// White and slow noise are taken whole; of a rest in whose last third something rings, the other two are left.
    #[test]
    fn of_a_rest_the_third_that_rings_is_left_out() {
        let slow = Whitening::one_pole(0.9, 0.19_f64.sqrt());
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let white = Whitening::white(1.0).draw(600, &mut random);
        for whole in [white.clone(), slow.draw(600, &mut random)] {
            assert_eq!(steady(whole.clone()), [whole]);
        }
        let mut hit = white;
        for (k, value) in hit[400..].iter_mut().enumerate() {
            *value += 6.0 * (0.1 * k as f64).sin();
        }
        let lengths: Vec<usize> = steady(hit).iter().map(Vec::len).collect();
        assert_eq!(lengths, [200, 200]);
    }
}
