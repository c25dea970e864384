//! Events in a vibration: free decays, and frequency sweeps.

use super::Vibration;
use super::density::{Taken, density};
use quell_recording::Role;
use quell_signal::Window;

/// Number of parts in which the energy is computed.
const PARTS: usize = 256;
/// Fewest samples of a part.
const FEWEST: usize = 16;
/// Relative width of a band in which a line is searched, and the number of bands on either side that it must
/// exceed: half an octave.
const BAND: f64 = 0.05;
const AROUND: usize = 7;
/// Least factor by which the energy of a decay falls: its amplitude to a third.
const FALLS: f64 = 9.0;
/// Factor of energy that marks a new event.
const RISES: f64 = 4.0;
/// Factor of energy beyond that of the decay that marks a sudden end. The energy of the fewest samples of noise has
/// a relative deviation of `sqrt(2 / 16)`: a factor of 9 is six of these in its logarithm.
const SUDDEN: f64 = 9.0;
/// Most decays that are fitted, the strongest first.
const MOST: usize = 12;

/// Most parts of a sweep, the fewest samples of one, and the rank correlation of frequency and time that defines one: with
/// so many parts chance gives 0.7 once in 1e12.
const FRAMES: usize = 96;
const SHORTEST: usize = 64;
const RANK: f64 = 0.7;
/// The same in its standard deviations by chance, `1 / sqrt(n - 1)` of `n` parts: once in 1e3, beside what else a sweep must
/// show.
const BY_CHANCE: f64 = 3.1;
/// Least range of a sweep: an octave.
const OCTAVE: f64 = 2.0;
/// Ratio of a part's strongest line to its median one above which the part counts. In a thousand lines of noise
/// the strongest has 14 times the median in one part of ten.
const STANDS_OUT: f64 = 30.0;

/// Lengths, in samples, of the parts in which decays are looked for. What shows positions shows the moves between
/// its decays, too, whose slow lines may stand out most: it is looked at in ever shorter parts.
pub fn lengths(vibration: &Vibration) -> Vec<usize> {
    let samples = vibration.axes[0].len();
    let shortest = (samples / PARTS).max(FEWEST);
    let [first, strong] = cycles(vibration).map(|length| shortest.max(length).min(samples / 4));
    let moves = [Role::LinkPosition, Role::TipPosition, Role::LinkVelocity];
    if !moves.contains(&vibration.role) {
        return match strong == first {
            true => vec![first],
            false => vec![first, strong],
        };
    }
    std::iter::successors(Some(first), |length| Some(length / 2))
        .take_while(|length| *length >= shortest.min(first))
        .collect()
}

/// Stretches of free decay, in samples from and before, the strongest first; in parts of so many samples.
pub fn decays(vibration: &Vibration, length: usize) -> Vec<[usize; 2]> {
    let samples = vibration.axes[0].len();
    let energies: Vec<f64> = (0..samples / length)
        .map(|part| energy(vibration, part * length, length))
        .collect();
    let mut found = Vec::new();
    let mut part = 0;
    while part < energies.len() {
        // Up to the top.
        while part + 1 < energies.len() && energies[part + 1] > energies[part] {
            part += 1;
        }
        let top = part;
        let (mut low, mut end) = (energies[top], top);
        while part + 1 < energies.len() && energies[part + 1] < RISES * low {
            part += 1;
            if energies[part] < low {
                low = energies[part];
                end = part;
            }
        }
        let end = stopped(&energies[top..=end]).map_or(end, |parts| top + parts);
        if energies[top] > FALLS * low && end - top >= 3 {
            let from = onset(vibration, [top * length, (top + 1) * length]);
            found.push((energies[top], [from, (end + 1) * length]));
        }
        part += 1;
    }
    strongest_first(found)
}

/// All from the first strong sample on, in samples from and before: a single decay, if it is one.
pub fn to_the_end(vibration: &Vibration) -> [usize; 2] {
    let samples = vibration.axes[0].len();
    [onset(vibration, [0, samples]), samples]
}

/// Stretches of spans of rest, s, in samples from and before, the strongest first.
pub fn within(vibration: &Vibration, rests: &[[f64; 2]]) -> Vec<[usize; 2]> {
    let stretches = rests.iter().map(|rest| samples_of(vibration, rest));
    let long = stretches.filter(|[from, until]| *until >= from + 2 * FEWEST);
    let with_energy = |[from, until]: [usize; 2]| {
        let quarter = (until - from) / 4;
        (energy(vibration, from, quarter), [from, until])
    };
    strongest_first(long.map(with_energy).collect())
}

/// The parts of stretches that lie in spans of rest, s: what is known to move drives the vibration elsewhere. All of them where
/// no rest is known.
pub fn at_rest(
    vibration: &Vibration,
    stretches: Vec<[usize; 2]>,
    rests: &[[f64; 2]],
) -> Vec<[usize; 2]> {
    if rests.is_empty() {
        return stretches;
    }
    let rests: Vec<[usize; 2]> = rests
        .iter()
        .map(|rest| samples_of(vibration, rest))
        .collect();
    let parts = stretches.iter().flat_map(|[from, until]| {
        let common = rests
            .iter()
            .map(|rest| [*from.max(&rest[0]), *until.min(&rest[1])]);
        common.filter(|part| part[0] < part[1])
    });
    parts.collect()
}

/// A span, s, in samples from and before.
fn samples_of(vibration: &Vibration, span: &[f64; 2]) -> [usize; 2] {
    let sample = |time: f64| ((time - vibration.start) * vibration.rate).ceil().max(0.0) as usize;
    [
        sample(span[0]),
        sample(span[1]).min(vibration.axes[0].len()),
    ]
}

/// The stretches of enough energy, the strongest first.
fn strongest_first(mut found: Vec<(f64, [usize; 2])>) -> Vec<[usize; 2]> {
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let strongest = found.first().map_or(0.0, |first| first.0);
    // A hundredth of the energy, a tenth of the amplitude, adds little information.
    let strong = found.into_iter().filter(|one| one.0 > 0.01 * strongest);
    strong.take(MOST).map(|one| one.1).collect()
}

/// Number of parts after the top before something stops a decay, as a hand that is laid on it: the energy falls to
/// the floor within two parts, far faster than before. `None` where nothing does.
fn stopped(energies: &[f64]) -> Option<usize> {
    let floor = energies.iter().copied().fold(f64::INFINITY, f64::min);
    (3..energies.len().saturating_sub(2)).find(|&k| {
        let (now, then) = (energies[k], energies[k + 2]);
        let usual = (energies[0] / now).powf(2.0 / k as f64).max(1.0);
        now > SUDDEN * usual * then && then < RISES * floor
    })
}

/// The first sample with half of the greatest energy of some: what comes before it excites the vibration.
fn onset(vibration: &Vibration, [from, until]: [usize; 2]) -> usize {
    let mean = |axis: &Vec<f64>| axis[from..until].iter().sum::<f64>() / (until - from) as f64;
    let means: Vec<f64> = vibration.axes.iter().map(mean).collect();
    let square = |k: usize| -> f64 {
        let axes = vibration.axes.iter().zip(&means);
        axes.map(|(axis, mean)| (axis[k] - mean).powi(2)).sum()
    };
    let greatest = (from..until).map(square).fold(0.0, f64::max);
    let is_strong = |k: &usize| square(*k) >= 0.5 * greatest;
    (from..until).find(is_strong).unwrap_or(from)
}

/// Number of samples of one and a half periods of the most prominent line, and of the one with the most energy. A
/// shorter part would have an energy that depends on its phase. Taps at even intervals make prominent lines of their
/// own, far below the mode's.
fn cycles(vibration: &Vibration) -> [usize; 2] {
    let samples = vibration.axes[0].len();
    let seconds = samples as f64 / vibration.rate;
    let band = [2.0 / seconds, 0.45 * vibration.rate];
    let density = density(vibration, band, BAND, Taken::Untapered);
    let count = density.power.len();
    let prominence = |k: usize| {
        let mut around =
            density.power[k.saturating_sub(AROUND)..(k + AROUND + 1).min(count)].to_vec();
        let middle = around.len() / 2;
        let median = *around.select_nth_unstable_by(middle, f64::total_cmp).1;
        density.power[k] / median.max(f64::MIN_POSITIVE)
    };
    let energy = |k: usize| density.power[k] * density.frequency[k];
    let most = |of: &dyn Fn(usize) -> f64| {
        let most = (0..count).max_by(|a, b| of(*a).total_cmp(&of(*b)));
        let frequency = most.map_or(vibration.rate, |k| density.frequency[k]);
        (1.5 * vibration.rate / frequency) as usize
    };
    [most(&prominence), most(&energy)]
}

/// Mean energy of some samples about their linear trend, summed over the axes.
fn energy(vibration: &Vibration, first: usize, count: usize) -> f64 {
    let of = |axis: &Vec<f64>| {
        let values = &axis[first..first + count];
        let mean = values.iter().sum::<f64>() / count as f64;
        let middle = (count - 1) as f64 / 2.0;
        let (mut across, mut along, mut all) = (0.0, 0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let x = k as f64 - middle;
            across += x * (value - mean);
            along += x * x;
            all += (value - mean).powi(2);
        }
        (all - across * across / along) / count as f64
    };
    vibration.axes.iter().map(of).sum()
}

/// The frequencies, Hz, between which a frequency sweeps in time; `None` without a sweep.
pub fn sweep(vibration: &Vibration) -> Option<[f64; 2]> {
    let samples = vibration.axes[0].len();
    let count = FRAMES.min(samples / SHORTEST);
    let length = samples.checked_div(count)?;
    let mut frames: Vec<(f64, f64)> = Vec::new();
    for frame in 0..count {
        let [line, energy] = strongest(vibration, frame * length, length);
        frames.push((line * vibration.rate / length as f64, energy));
    }
    let stands_out = frames.iter().filter(|frame| frame.1 > STANDS_OUT);
    let loud: Vec<f64> = stands_out.map(|frame| frame.0).collect();
    let needed = RANK.max(BY_CHANCE / (loud.len() as f64 - 1.0).max(1.0).sqrt());
    if loud.len() < count / 3 || needed >= 1.0 {
        return None;
    }
    let rank = rank_correlation(&loud);
    let mut sorted = loud.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
    let [low, high] = [at(0.03), at(0.97)];
    let line = vibration.rate / length as f64;
    let is_sweep = rank.abs() > needed && high > OCTAVE * low && passes(&loud, [low, high], line);
    is_sweep.then_some([low, high])
}

/// Whether frequencies pass most of a range. Jumping ones, as of one mode after another, do not. The range has eight parts,
/// or as many as it has lines.
fn passes(frequencies: &[f64], [low, high]: [f64; 2], line: f64) -> bool {
    let parts = (((high - low) / line).round() as usize).min(8);
    let part = |f: &f64| ((f - low) / (high - low) * parts as f64 + 1e-9) as usize;
    let passed =
        (0..parts).filter(|own| frequencies.iter().any(|f| part(f).min(parts - 1) == *own));
    parts >= 4 && passed.count() + 1 >= parts
}

/// The strongest line of some samples, over all axes, and its energy over the median one.
fn strongest(vibration: &Vibration, first: usize, count: usize) -> [f64; 2] {
    let mut energy = vec![0.0; count / 2 + 1];
    for axis in &vibration.axes {
        let values = &axis[first..first + count];
        let mean = values.iter().sum::<f64>() / count as f64;
        let window = |k: usize| Window::Hann.weight(k, count);
        let windowed = values
            .iter()
            .enumerate()
            .map(|(k, v)| window(k) * (v - mean));
        let lines = quell_signal::fourier(windowed.collect());
        for (sum, line) in energy.iter_mut().zip(lines) {
            *sum += line.norm_sqr();
        }
    }
    let mut sorted = energy.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let lines = energy.iter().enumerate().skip(1);
    let (line, most) = lines.max_by(|a, b| a.1.total_cmp(b.1)).unwrap_or((0, &0.0));
    [line as f64, most / median.max(f64::MIN_POSITIVE)]
}

/// Spearman's rank correlation of values with their places.
fn rank_correlation(values: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let n = values.len() as f64;
    let square = |(rank, place): (usize, &usize)| (rank as f64 - *place as f64).powi(2);
    1.0 - 6.0 * order.iter().enumerate().map(square).sum::<f64>() / (n * (n * n - 1.0))
}
