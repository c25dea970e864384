//! Noise floor and quantisation of a channel, from its values.

/// Standard deviation over median absolute deviation of a normal distribution.
const NORMAL_MAD: f64 = 1.482_602_218_505_602;

/// Noise of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseFloor {
    /// Standard deviation of one sample, in the channel's unit.
    pub standard_deviation: f64,
    /// Step between the values that the channel takes, if it is quantised.
    pub quantisation: Option<f64>,
}

/// Noise floor of evenly sampled values.
///
/// Third differences remove smooth signals and amplify the variance of white noise by 20 (1 + 9 + 9 + 1). Their
/// median absolute deviation is used, so that short stretches of fast motion do not count. A quantised channel
/// has at least `q / sqrt 12`. Signal content above a tenth of the sampling rate is taken for noise. With fewer
/// than 8 samples the result is 0.
///
/// # Example
/// ```
/// let steps: Vec<f64> = (0..200).map(|k| (0.3 * k as f64).round() * 0.5).collect();
/// let noise = quell_signal::noise_floor(&steps);
/// assert_eq!(noise.quantisation, Some(0.5));
/// assert!(noise.standard_deviation >= 0.5 / 12f64.sqrt());
/// ```
pub fn noise_floor(values: &[f64]) -> NoiseFloor {
    let quantisation = quantisation_step(values);
    let mut differences: Vec<f64> = values
        .windows(4)
        .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
        .filter(|d| d.is_finite())
        .collect();
    if differences.len() < 5 {
        return NoiseFloor {
            standard_deviation: 0.0,
            quantisation,
        };
    }
    let deviation = median(&mut differences) * NORMAL_MAD / 20f64.sqrt();
    let rounding = quantisation.map_or(0.0, |q| q / 12f64.sqrt());
    NoiseFloor {
        standard_deviation: deviation.max(rounding),
        quantisation,
    }
}

/// Step of a quantised channel: the smallest change between neighbours, if the other small changes are
/// multiples of it.
///
/// `None` where fewer than 5 changes are seen or less than 95 % of the changes below 10 steps lie
/// within a tenth of a step of a multiple. An unquantised channel passes by chance with a share of
/// 20 % only.
pub fn quantisation_step(values: &[f64]) -> Option<f64> {
    let largest = values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    // Below this a change is the rounding of a number written with ten digits.
    let rounding = 1e-10 * largest;
    let mut changes: Vec<f64> = values
        .windows(2)
        .map(|w| (w[1] - w[0]).abs())
        .filter(|d| d.is_finite() && *d > rounding)
        .collect();
    if changes.len() < 5 {
        return None;
    }
    changes.sort_unstable_by(f64::total_cmp);
    let mut step = changes[0];
    // Refined twice: the mean of all changes of one step.
    for _ in 0..2 {
        let single: Vec<f64> = changes
            .iter()
            .copied()
            .filter(|d| *d < 1.5 * step)
            .collect();
        step = single.iter().sum::<f64>() / single.len() as f64;
    }
    let small: Vec<f64> = changes
        .iter()
        .map(|d| d / step)
        .filter(|d| *d < 10.0)
        .collect();
    let multiples = small
        .iter()
        .filter(|d| (*d - d.round()).abs() < 0.1)
        .count();
    let single = small.iter().filter(|d| **d < 1.5).count();
    (single >= 2 && multiples as f64 >= 0.95 * small.len() as f64).then_some(step)
}

/// Median; the slice is reordered. 0 for an empty slice.
pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
