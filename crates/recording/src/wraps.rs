//! Readings of a counter that begins again at the end of its range: what it counts to, and the motion without the jumps.

use std::f64::consts::TAU;

/// Bits of counters, from those of a coarse absolute encoder to those of a register.
const BITS: std::ops::RangeInclusive<i32> = 8..=32;
/// A turn in degrees, and in tenths and hundredths of one.
const DEGREES: [f64; 3] = [360.0, 3_600.0, 36_000.0];
/// Samples on either side of a jump whose bends it is compared with.
const AROUND: usize = 6;
/// How many times the greatest bend about it a jump may bend the motion. A motion with five samples a period or more bends by
/// less than twice from one sample to the next one but one.
const BENDS: f64 = 2.0;
/// What the rounding of whole numbers bends: each of three readings is off by half, with the weights 1, 2, 1.
const ROUNDING: f64 = 2.0;

/// A counter that begins again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrap {
    /// The period, in the unit of the readings.
    pub period: f64,
    /// How many times it begins again, in either direction.
    pub jumps: usize,
    /// The first sample after a jump.
    pub first: usize,
}

impl Wrap {
    /// The counter that these readings can only be of; `None` where there is none, or its period is not certain.
    ///
    /// A period of 2^8 to 2^32 counts, or a turn in degrees, is taken where the readings span less than it, some neighbours
    /// are further apart than half of it, and all that jumps goes on smoothly without it: the second difference at a jump is
    /// no more than twice the greatest within six samples, and the rounding. Readings that are no whole numbers may have
    /// a turn in degrees or radians alone. A sensor that drops out, or a step, bends the motion by more.
    ///
    /// # Example
    /// ```
    /// use quell_recording::Wrap;
    /// let counts: Vec<f64> = (0..400).map(|k| f64::from((900 + 10 * k) % 4096)).collect();
    /// assert_eq!(Wrap::of(&counts).map(|own| (own.period, own.first)), Some((4096.0, 320)));
    /// assert_eq!(Wrap::of(&counts[..300]), None);
    /// ```
    pub fn of(readings: &[f64]) -> Option<Self> {
        let is_whole = readings.iter().all(|value| value.fract() == 0.0);
        let span = crate::range(readings);
        let counts = BITS.filter(|_| is_whole).map(|bits| 2_f64.powi(bits));
        let turns = DEGREES.into_iter().filter(|_| is_whole);
        let angles = [TAU, DEGREES[0]].into_iter().filter(|_| !is_whole);
        let able = counts.chain(turns).chain(angles);
        // A jump is further than half the period, so that the span is, too.
        let mut able = able.filter(|period| span < *period && span > 0.5 * period);
        able.find_map(|period| Self::at(readings, period, is_whole))
    }

    fn at(readings: &[f64], period: f64, is_whole: bool) -> Option<Self> {
        let is_jump = |pair: &[f64]| (pair[1] - pair[0]).abs() > 0.5 * period;
        let pairs = readings.windows(2).enumerate();
        let jumps: Vec<usize> = pairs
            .filter(|(_, pair)| is_jump(pair))
            .map(|(k, _)| k + 1)
            .collect();
        let first = *jumps.first()?;
        let mut smooth = readings.to_vec();
        unwrap(&mut smooth, period);
        let bend = |k: usize| (smooth[k + 1] - 2.0 * smooth[k] + smooth[k - 1]).abs();
        // A jump bends the motion at the sample before it and at the one after it.
        let beside = |k: usize| jumps.iter().any(|jump| k + 1 == *jump || k == *jump);
        let last = smooth.len().checked_sub(2)?;
        let goes_on = |jump: &usize| {
            let near = (jump.saturating_sub(AROUND).max(1)..=(jump + AROUND).min(last))
                .collect::<Vec<_>>();
            let (own, others): (Vec<usize>, Vec<usize>) =
                near.into_iter().partition(|k| beside(*k));
            let greatest = |some: Vec<usize>| some.into_iter().map(bend).fold(0.0, f64::max);
            let rounding = if is_whole { ROUNDING } else { 0.0 };
            !others.is_empty() && greatest(own) <= BENDS * greatest(others) + rounding
        };
        jumps.iter().all(goes_on).then_some(Self {
            period,
            jumps: jumps.len(),
            first,
        })
    }
}

/// Takes out the jumps of a counter that begins again: after it, no two neighbours are further apart than half a period.
pub(super) fn unwrap(readings: &mut [f64], period: f64) {
    let (mut turns, mut last) = (0.0, readings.first().copied().unwrap_or(0.0));
    for value in readings {
        turns -= ((*value - last) / period).round();
        last = *value;
        *value += turns * period;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A move there and back with a vibration, rounded or not, in a counter of this period.
    fn read(period: f64, whole: bool) -> Vec<f64> {
        let motion = |k: i32| {
            let t = f64::from(k) / 500.0;
            0.8 * period * (1.0 - (TAU * 0.3 * t).cos()) + 0.02 * period * (TAU * 6.0 * t).sin()
        };
        let rounded = |value: f64| if whole { value.round() } else { value };
        (0..2000)
            .map(|k| rounded(motion(k)).rem_euclid(period))
            .collect()
    }

    #[test]
    fn a_counter_is_found_by_its_jumps_and_read_without_them() {
        for bits in [12, 16, 20, 32] {
            let period = 2_f64.powi(bits);
            let mut readings = read(period, true);
            assert_eq!(Wrap::of(&readings).unwrap().period, period);
            // Signed, too.
            let signed = |own: &f64| own - if *own >= 0.5 * period { period } else { 0.0 };
            let signed: Vec<f64> = readings.iter().map(signed).collect();
            assert_eq!(Wrap::of(&signed).unwrap().period, period);
            unwrap(&mut readings, period);
            let far = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            assert!(far.fold(0.0, f64::max) < 0.02 * period);
        }
        for period in [TAU, 360.0] {
            assert_eq!(Wrap::of(&read(period, false)).unwrap().period, period);
        }
    }

    #[test]
    fn what_jumps_otherwise_is_no_counter() {
        let steps: Vec<f64> = (0..400)
            .map(|k| if k % 100 < 50 { 0.0 } else { 40_000.0 })
            .collect();
        let mut drops: Vec<f64> = (0..400).map(|k| 60_000.0 + f64::from(k)).collect();
        (drops[150], drops[151]) = (0.0, 0.0);
        // A counter that begins again at a number which is none of these.
        let other = read(5000.0, true);
        for readings in [steps, drops, other, vec![0.0, 300.0], vec![], vec![5.0; 40]] {
            assert_eq!(Wrap::of(&readings), None);
        }
    }
}
