//! Modes of free decays: their number, their dependence on amplitude, and their uncertainty.

use super::criterion::{best, unknowns};
use super::damped::{Bend, Damped, Fit, Law, Segment, amplitudes, fit, residual};
use super::free::{Seen, is_free};
use super::told::told;
use super::{Excitation, FEWEST, OutputOnly, Vibration};
use crate::stop::Stop;
use nalgebra::{DMatrix, DVector};
use quell_signal::STRONG;
use std::f64::consts::TAU;

/// Most steps; each adds a mode or a dependence on amplitude.
const STEPS: usize = 7;
/// Damping ratios from which a mode's fit starts.
const STARTS: [f64; 5] = [0.003, 0.01, 0.03, 0.08, 0.2];
/// Laws that a mode may follow.
const LAWS: [Law; 3] = [Law::Power(1.0), Law::Power(2.0), Law::Friction];
/// Number of samples of the longest decay above which neighbours are averaged, in all decays alike; the poles do not
/// change.
const MOST: usize = 30_000;
/// Most samples of all decays together, the strongest first; it is as many as one may have.
const MOST_OF_ALL: usize = 2 * MOST;
/// Number of samples above which neighbours are averaged for the test whether a stretch is a decay.
const LOOKED_AT: usize = 3000;
/// Parts of a stretch at whose borders its free decay may begin or end, and the numbers of these borders: it begins within
/// the first half, and ends within the last tenth.
const PARTS: usize = 20;
const BEGINS: usize = 11;
const ENDS: usize = 3;

/// The modes of some stretches; `None` where these are no free decays.
pub fn modes(
    vibration: &Vibration,
    (stretches, seen): (&[[usize; 2]], Seen),
    stop: Stop,
) -> Option<OutputOnly> {
    let (stretches, segments) = free(vibration, stretches, (seen, stop))?;
    let total: f64 = residual(&segments, &[])?.norm_squared();
    let models = grow(&segments, stop)?;
    let count: usize = segments.iter().map(|segment| segment.values.len()).sum();
    let axes: usize = segments.iter().map(|segment| segment.values.ncols()).sum();
    let (best, independent) = best(&models, axes)?;
    let best = &models[best];
    let explained = 1.0 - best.minimum.cost / total;
    let found = independent * (total / best.minimum.cost).ln();
    let needed = unknowns(best, axes) * independent.ln() + STRONG;
    let scale = best.minimum.cost / (count as f64 - unknowns(best, axes)).max(1.0) * count as f64
        / independent;
    let (modes, left_out) = told(best, &segments, scale)?;
    let strongest = modes.first()?.known.mode.damped_frequency();
    let duration = vibration.axes[0].len() as f64 / vibration.rate;
    let is_free = is_free((best, &segments), seen, [strongest, independent, duration]);
    if explained < seen.least() || found < needed || !is_free {
        return None;
    }
    let seconds = |[from, until]: [usize; 2]| [vibration.time(from), vibration.time(until)];
    Some(OutputOnly {
        excitation: Excitation::Decay,
        modes,
        left_out,
        stretches: stretches.into_iter().map(seconds).collect(),
        explained,
        evidence: [found, needed],
    })
}

/// The free parts of stretches, the strongest first, and their samples.
fn free(
    vibration: &Vibration,
    stretches: &[[usize; 2]],
    (seen, stop): (Seen, Stop),
) -> Option<(Vec<[usize; 2]>, Vec<Segment>)> {
    let free = stretches.iter().map(|s| vibration.unclipped(*s));
    let long = free.filter(|[from, until]| *until >= from + FEWEST);
    let begun = long.filter_map(|s| begun(vibration, (s, seen.least()), stop));
    let mut stretches: Vec<[usize; 2]> = begun.collect();
    let average = averaged(stretches.iter().map(samples).max()?, MOST);
    stretches.retain(|stretch| samples(stretch) >= FEWEST * average);
    let mut all = 0;
    stretches.retain(|stretch| {
        all += samples(stretch) / average;
        all <= MOST_OF_ALL
    });
    let segments = stretches.iter().map(|s| segment(vibration, *s, average));
    let segments = segments.collect();
    Some((stretches, segments))
}

/// Models, each with one more feature than the one before: a mode, or a dependence on amplitude. The feature
/// with the larger fall of the cost per unknown is taken. It ends where two in a row have not raised the evidence.
fn grow(segments: &[Segment], stop: Stop) -> Option<Vec<Fit>> {
    let axes: usize = segments.iter().map(|segment| segment.values.ncols()).sum();
    let mut models: Vec<Fit> = Vec::new();
    for _ in 0..STEPS {
        let modes = models.last().map_or(&[][..], |model| &model.modes);
        let left = residual(segments, modes)?;
        let worth = |fit: &Fit, unknowns: usize| {
            (left.norm_squared() / fit.minimum.cost).ln() / unknowns as f64
        };
        let further =
            further(segments, modes, &left, stop).map(|fit| (worth(&fit, 2 + 2 * axes), fit));
        let bent = bent(segments, modes, stop).map(|fit| (worth(&fit, 2), fit));
        let better = further
            .into_iter()
            .chain(bent)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match better {
            Some((worth, fit)) if worth > 0.0 => models.push(fit),
            _ => break,
        }
        // Only rounding is left.
        if models.last()?.minimum.cost < 1e-20 * left.norm_squared() {
            break;
        }
        if models.len() >= best(&models, axes)?.0 + 3 {
            break;
        }
    }
    (!models.is_empty()).then_some(models)
}

/// Adds a mode at the strongest line of the residual.
fn further(segments: &[Segment], modes: &[Damped], left: &DVector<f64>, stop: Stop) -> Option<Fit> {
    let frequency = strongest(segments, left)?;
    let with = |ratio: f64| {
        let mode = Damped {
            frequency,
            rate: ratio * frequency,
            bend: None,
        };
        [modes, &[mode]].concat()
    };
    let cost =
        |modes: &Vec<Damped>| residual(segments, modes).map_or(f64::INFINITY, |r| r.norm_squared());
    let start = STARTS
        .iter()
        .map(|ratio| with(*ratio))
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    fit(segments, &start, stop)
}

/// Adds a dependence on amplitude to the strongest mode that is still linear.
fn bent(segments: &[Segment], modes: &[Damped], stop: Stop) -> Option<Fit> {
    let shares = amplitudes(segments, modes)?;
    let linear = (0..modes.len()).filter(|k| modes[*k].bend.is_none());
    let which = linear.max_by(|a, b| shares[*a].total_cmp(&shares[*b]))?;
    let with = |law: Law| {
        let mut modes = modes.to_vec();
        modes[which].bend = Some(Bend {
            frequency: 0.0,
            rate: 0.0,
            law,
        });
        fit(segments, &modes, stop)
    };
    // A frequency of zero or less at the greatest amplitude is none.
    let vibrates = |fit: &Fit| {
        let bends = fit.modes.iter().filter_map(|mode| mode.bend.as_ref());
        bends.into_iter().all(|bend| bend.frequency > -1.0)
    };
    let fits = LAWS.into_iter().filter_map(with).filter(vibrates);
    fits.min_by(|a, b| a.minimum.cost.total_cmp(&b.minimum.cost))
}

/// The angular frequency of the strongest line of a residual, over all axes and decays; rad/s.
fn strongest(segments: &[Segment], left: &DVector<f64>) -> Option<f64> {
    let longest = segments
        .iter()
        .map(|segment| segment.values.nrows())
        .max()?;
    let length = (2 * longest).next_power_of_two();
    let mut energy = vec![0.0; length / 2 + 1];
    let mut from = 0;
    for segment in segments {
        for _ in 0..segment.values.ncols() {
            let rows = segment.values.nrows();
            let mut values = left.rows(from, rows).iter().copied().collect::<Vec<_>>();
            values.resize(length, 0.0);
            from += rows;
            for (sum, line) in energy.iter_mut().zip(quell_signal::fourier(values)) {
                *sum += line.norm_sqr();
            }
        }
    }
    let period = segments.first()?.period;
    // A line at the lowest frequencies is drift, not vibration.
    let lowest = (length as f64 / longest as f64).ceil() as usize;
    let lines = energy
        .iter()
        .enumerate()
        .skip(lowest.max(1))
        .take(length * 9 / 20);
    let (line, _) = lines.max_by(|a, b| a.1.total_cmp(b.1))?;
    Some(TAU * line as f64 / (length as f64 * period))
}

/// The part of a stretch in which its decay is free; `None` where two modes explain less than the `least` share of it.
///
/// Begin and end are the change-points of most likelihood. The samples between them are two modes with noise of the
/// variance `s^2` that these leave; the others, forced by what excites or stops the vibration, have the variance `v^2` of the
/// stretch. So of `n` samples, of which `m` are free, the least `m ln s^2 + (n - m) ln v^2` is sought. A share that is left would not
/// do: it falls with all that is taken in, as what excites is larger than what rings.
///
/// Source: D. V. Hinkley, Inference about the change-point in a sequence of random variables, Biometrika 57 (1970).
fn begun(
    vibration: &Vibration,
    ([from, until], least): ([usize; 2], f64),
    stop: Stop,
) -> Option<[usize; 2]> {
    let step = ((until - from) / PARTS).max(1);
    let average = averaged(until - from, LOOKED_AT);
    let variance = mean_square(&segment(vibration, [from, until], average));
    // Its score, the share that is left of it, and the part itself.
    let scored = |free: [usize; 2]| {
        let stretch = segment(vibration, free, average);
        let left = left(&stretch, stop);
        let inside = (free[1] - free[0]) as f64;
        let outside = (until - from) as f64 - inside;
        let score = inside * left.ln() + outside * variance.ln();
        (score, left / mean_square(&stretch), free)
    };
    // The first of equals, which is the longest.
    let by_score = |a: &(f64, f64, _), b: &(f64, f64, _)| a.0.total_cmp(&b.0);
    let latest = from + (BEGINS - 1) * step;
    let ends = (0..ENDS).map(|k| scored([latest, until - k * step]));
    let last = ends.min_by(by_score)?;
    let begins = (0..BEGINS - 1).map(|k| scored([from + k * step, last.2[1]]));
    let (_, share, free) = begins.chain([last]).min_by(by_score)?;
    (share < 1.0 - least).then_some(free)
}

/// Mean square of what two modes leave of a stretch; of all of it where none can be fitted.
fn left(stretch: &Segment, stop: Stop) -> f64 {
    let all = mean_square(stretch);
    let stretch = std::slice::from_ref(stretch);
    let count = stretch[0].values.len() as f64;
    let add = |modes: &[Damped]| further(stretch, modes, &residual(stretch, modes)?, stop);
    let one = add(&[]);
    let two = one.as_ref().and_then(|fit| add(&fit.modes));
    let left = two.or(one).map_or(all, |fit| fit.minimum.cost / count);
    // What is below the rounding of numbers tells nothing.
    left.max(f64::EPSILON.powi(2) * all)
}

/// Mean square of a stretch about its mean, over all axes.
fn mean_square(stretch: &Segment) -> f64 {
    let square = stretch.values.norm_squared() / stretch.values.len() as f64;
    square.max(f64::MIN_POSITIVE)
}

fn samples([from, until]: &[usize; 2]) -> usize {
    until - from
}

/// Number of neighbours that are averaged, of so many samples.
fn averaged(samples: usize, most: usize) -> usize {
    (samples / most).max(1)
}

/// The samples of a stretch, about their mean, each the average of so many.
fn segment(vibration: &Vibration, [from, until]: [usize; 2], average: usize) -> Segment {
    let until = until.min(vibration.axes[0].len());
    let rows = (until - from) / average;
    let mut values = DMatrix::zeros(rows, vibration.axes.len());
    for (column, axis) in vibration.axes.iter().enumerate() {
        for row in 0..rows {
            let some = &axis[from + row * average..from + (row + 1) * average];
            values[(row, column)] = some.iter().sum::<f64>() / average as f64;
        }
        let mean = values.column(column).mean();
        values.column_mut(column).add_scalar_mut(-mean);
    }
    Segment {
        period: average as f64 / vibration.rate,
        values,
    }
}
