//! The shaper of a printer's axis: a type and a frequency, as printers' firmware takes them.
//!
//! A firmware has one shaper an axis, whatever the number of modes. Of all types and frequencies the one is taken that
//! smooths a corner least and leaves an acceptable vibration; where none does, the one that leaves least.

use super::output_only::FoundMode;
use quell_shapers::{
    Ei, Impulse, ImpulseTrain, Mode, Mzv, Shaper, ShaperError, ThreeHumpEi, TwoHumpEi, Zv, Zvd,
    residual_vibration,
};

/// Shapers that printers' firmware has.
pub static PRINTER_SHAPERS: [&dyn Shaper; 6] = [&Zv, &Mzv, &Zvd, &Ei, &TwoHumpEi, &ThreeHumpEi];

/// Acceleration, mm/s^2, and velocity at a corner, mm/s, at which smoothing is told: those at which Klipper tells it.
pub const ACCELERATION: f64 = 5000.0;
/// See [`ACCELERATION`].
pub const CORNER_VELOCITY: f64 = 5.0;
/// Smoothing, mm, at which the greatest acceleration is told; Klipper's, too.
const SMOOTH: f64 = 0.12;
/// Frequencies that are tried are this share apart, a tenth of what a ZV shaper tolerates (6 %), from this share of the
/// lowest mode to that of the highest.
const STEP: f64 = 0.005;
const RANGE: [f64; 2] = [0.6, 2.0];
/// Residuals that are nearer than this are told as alike: a tenth of what is acceptable.
const ALIKE: f64 = 0.005;
/// Standard deviation of a frequency, as a share of it, beside what a recording tells: the recording is of one place of
/// the axis and of one load. One percent is what a frequency must be known to for a ZV shaper to leave 3 %.
const SPREAD: f64 = 0.01;
/// Standard deviations on either side for which a residual is told.
const SIDES: [f64; 3] = [-2.0, 0.0, 2.0];

/// A shaper of an axis, and what it does.
#[derive(Clone)]
pub struct Setting {
    /// The type.
    pub shaper: &'static dyn Shaper,
    /// The mode that it is designed for: its frequency and damping ratio go into the firmware.
    pub mode: Mode,
    /// Its impulses.
    pub train: ImpulseTrain,
    /// Vibration that it leaves, as a share of the unshaped one, in the worst recording, within two standard deviations.
    pub residual: f64,
    /// Smoothing of a corner, mm.
    pub smoothing: f64,
    /// Acceleration at which the smoothing is 0.12 mm, mm/s^2.
    pub acceleration: f64,
}

/// Deviation of a shaped path from its corner, mm: the greater of a turn by 90 and one by 180 degrees.
///
/// With the mean instant `m = sum A_i t_i` of the train: `sqrt 2 sum_(t_i > m) A_i (v + a (t_i - m) / 2) (t_i - m)` and
/// `sum A_i a (t_i - m)^2 / 2`, at an acceleration `a` (mm/s^2) and a velocity `v` at corners (mm/s).
pub fn smoothing(train: &ImpulseTrain, a: f64, v: f64) -> f64 {
    let impulses = train.impulses();
    let mean: f64 = impulses.iter().map(|i| i.amplitude * i.time).sum();
    let (mut quarter, mut half) = (0.0, 0.0);
    for Impulse { time, amplitude } in impulses {
        let late = time - mean;
        if late > 0.0 {
            quarter += amplitude * (v + 0.5 * a * late) * late;
        }
        half += amplitude * 0.5 * a * late * late;
    }
    f64::max(quarter * std::f64::consts::SQRT_2, half)
}

/// The share of an axis' vibration that a train leaves: of each recording the sum over its modes, each by its amplitude,
/// and of that the worst over recordings and over two standard deviations.
pub fn residual(train: &ImpulseTrain, recordings: &[Vec<FoundMode>]) -> f64 {
    let of = |modes: &Vec<FoundMode>| {
        let all: f64 = modes.iter().map(|mode| mode.share).sum();
        modes
            .iter()
            .map(|mode| mode.share * worst(train, mode))
            .sum::<f64>()
            / all
    };
    recordings.iter().map(of).fold(0.0, f64::max)
}

/// The worst residual of a mode within two standard deviations, and within what its amplitude does to it.
fn worst(train: &ImpulseTrain, mode: &FoundMode) -> f64 {
    let known = mode.known;
    let [frequency, ratio] = [known.mode.natural_frequency(), known.mode.damping_ratio()];
    let finite = |std: f64| if std.is_finite() { std } else { 0.0 };
    let (by, beside) = (
        finite(known.natural_frequency_std).hypot(SPREAD * frequency),
        finite(known.damping_ratio_std),
    );
    let mut worst = 0.0_f64;
    for at in [frequency, frequency * (1.0 + mode.frequency_shift)] {
        for side in SIDES {
            for other in SIDES {
                let damping = (ratio + other * beside).clamp(0.0, 0.99);
                worst = worst.max(residual_vibration(train, at + side * by, damping));
            }
        }
    }
    worst
}

/// The best frequency of each type, for one axis: it leaves least, and of those that leave as little it smooths least.
///
/// # Errors
/// [`ShaperError::Empty`] without a mode.
pub fn settings(recordings: &[Vec<FoundMode>]) -> Result<Vec<Setting>, ShaperError> {
    let all = all(recordings)?;
    let of_type = |shaper: &&'static dyn Shaper| {
        let own = all.iter().filter(|one| one.shaper.name() == shaper.name());
        let least = own
            .clone()
            .map(|one| one.residual)
            .fold(f64::INFINITY, f64::min);
        best(own, least + ALIKE).cloned()
    };
    Ok(PRINTER_SHAPERS.iter().filter_map(of_type).collect())
}

/// The one to take of some settings: the least smoothing of those that leave no more than is acceptable, else the least
/// residual.
pub fn best<'a>(
    settings: impl Iterator<Item = &'a Setting>,
    acceptable: f64,
) -> Option<&'a Setting> {
    let settings: Vec<&Setting> = settings.collect();
    let good = settings.iter().filter(|one| one.residual <= acceptable);
    let least = good.min_by(|a, b| a.smoothing.total_cmp(&b.smoothing));
    let least = least.or_else(|| {
        settings
            .iter()
            .min_by(|a, b| a.residual.total_cmp(&b.residual))
    });
    least.copied()
}

/// The setting that leaves least of those that smooth no more than so many mm.
///
/// # Errors
/// As [`settings`].
pub fn within(
    recordings: &[Vec<FoundMode>],
    smoothing: f64,
) -> Result<Option<Setting>, ShaperError> {
    let all = all(recordings)?
        .into_iter()
        .filter(|one| one.smoothing <= smoothing);
    Ok(all.min_by(|a, b| a.residual.total_cmp(&b.residual)))
}

/// Every type at every frequency.
fn all(recordings: &[Vec<FoundMode>]) -> Result<Vec<Setting>, ShaperError> {
    let modes = || recordings.iter().flatten();
    let strongest = modes()
        .max_by(|a, b| a.share.total_cmp(&b.share))
        .ok_or(ShaperError::Empty)?;
    let ratio = strongest.known.mode.damping_ratio();
    let hertz = |mode: &FoundMode| mode.known.mode.hertz();
    let lowest = RANGE[0] * modes().map(hertz).fold(f64::INFINITY, f64::min);
    let highest = RANGE[1] * modes().map(hertz).fold(0.0, f64::max);
    let steps = ((highest / lowest).ln() / STEP) as usize;
    let mut all = Vec::new();
    for shaper in PRINTER_SHAPERS {
        // A train of 1 Hz, whose instants are then divided by the frequency.
        let Ok(unit) = Mode::from_hertz(1.0, ratio).map(|mode| shaper.design(mode)) else {
            continue;
        };
        let Ok(unit) = unit else {
            continue;
        };
        for step in 0..=steps {
            // As it is written into the firmware.
            let frequency = (10.0 * lowest * (STEP * step as f64).exp()).round() / 10.0;
            let scaled = |impulse: &Impulse| Impulse {
                time: impulse.time / frequency,
                ..*impulse
            };
            let impulses: Vec<Impulse> = unit.impulses().iter().map(scaled).collect();
            let train = ImpulseTrain::new(&impulses)?;
            let Ok(mode) = Mode::from_hertz(frequency, ratio) else {
                continue;
            };
            all.push(Setting {
                shaper,
                mode,
                residual: residual(&train, recordings),
                smoothing: smoothing(&train, ACCELERATION, CORNER_VELOCITY),
                acceleration: acceleration(&train),
                train,
            });
        }
    }
    Ok(all)
}

/// The acceleration at which a train smooths by 0.12 mm, mm/s^2; 0 where its corner velocity alone does.
fn acceleration(train: &ImpulseTrain) -> f64 {
    let at = |a: f64| smoothing(train, a, CORNER_VELOCITY);
    // Each of the two terms is linear in the acceleration.
    let [still, slope] = [at(0.0), (at(1e9) - at(0.0)) / 1e9];
    match slope > 0.0 {
        true => ((SMOOTH - still) / slope).max(0.0),
        false => f64::INFINITY,
    }
}
