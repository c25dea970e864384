//! The shaper of a printer's axis: a type and a frequency, as printers' firmware takes them.
//!
//! A firmware has one shaper for each axis, whatever the number of modes. The choice over all types and
//! frequencies is the shaper of least smoothing with an acceptable residual vibration; if there is none, that
//! of least residual.

use super::output_only::FoundMode;
use quell_shapers::{
    Ei, Impulse, ImpulseTrain, Mode, Mzv, Shaper, ShaperError, ThreeHumpEi, TwoHumpEi, Zv, Zvd,
    residual_vibration,
};

/// Shapers that printers' firmware has.
pub static PRINTER_SHAPERS: [&dyn Shaper; 6] = [&Zv, &Mzv, &Zvd, &Ei, &TwoHumpEi, &ThreeHumpEi];

/// Acceleration, mm/s^2, and velocity at a corner, mm/s, for which smoothing is reported: those of Klipper.
pub const ACCELERATION: f64 = 5000.0;
/// See [`ACCELERATION`].
pub const CORNER_VELOCITY: f64 = 5.0;
/// Smoothing, mm, for which the greatest acceleration is reported; that of Klipper.
const SMOOTH: f64 = 0.12;
/// Relative distance of the tried frequencies, a tenth of a ZV shaper's tolerance (6 %); and their range, in
/// times the lowest and the highest mode.
const STEP: f64 = 0.005;
const RANGE: [f64; 2] = [0.6, 2.0];
/// Residuals that are nearer than this count as equal: a tenth of the acceptable one.
const ALIKE: f64 = 0.005;
/// Relative standard deviation of a frequency beyond that of a recording, which is of one place of the axis and
/// one load. One percent is the accuracy with which a ZV shaper leaves 3 %.
const SPREAD: f64 = 0.01;
/// Standard deviations at which a residual is computed.
const SIDES: [f64; 3] = [-2.0, 0.0, 2.0];

/// A shaper of an axis, and its effect.
#[derive(Clone)]
pub struct Setting {
    /// The type.
    pub shaper: &'static dyn Shaper,
    /// The mode that it is designed for: its frequency and damping ratio go into the firmware.
    pub mode: Mode,
    /// Its impulses.
    pub train: ImpulseTrain,
    /// Residual vibration as a share of the unshaped one, in the worst recording, within two standard
    /// deviations.
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

/// The share of an axis' vibration that a train leaves: for each recording the sum over its modes, weighted by
/// amplitude; of that the worst over recordings and over two standard deviations.
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

/// The worst residual of a mode within two standard deviations, and within its shift with amplitude.
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

/// The best frequency of each type for one axis: of those with least residual the one with least smoothing.
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

/// The recommended one of some settings: that of least smoothing among those with an acceptable residual, else
/// that of least residual.
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

/// The setting of least residual among those that smooth at most so many mm.
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
            // Rounded as in the firmware's configuration.
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

/// The acceleration at which a train smooths by 0.12 mm, mm/s^2; 0 where the corner velocity alone causes as
/// much.
fn acceleration(train: &ImpulseTrain) -> f64 {
    let at = |a: f64| smoothing(train, a, CORNER_VELOCITY);
    // Each of the two terms is linear in the acceleration.
    let [still, slope] = [at(0.0), (at(1e9) - at(0.0)) / 1e9];
    match slope > 0.0 {
        true => ((SMOOTH - still) / slope).max(0.0),
        false => f64::INFINITY,
    }
}
