//! The logarithmic decrement: damping from the heights of successive extrema.

use core::f64::consts::{PI, TAU};

use quell_shapers::Mode;

use crate::estimators::Sample;

/// Damping ratio from two successive maxima of a free decay, one period apart.
///
/// `xi = L / sqrt((2 pi)^2 + L^2)`, `L = ln(first / second)`.
///
/// # Example
/// ```
/// use quell_control::estimators::offline::log_decrement;
/// assert!((log_decrement(0.74, 0.43) - 0.08608).abs() < 5e-6);
/// ```
/// Source: eq. (25).
pub fn log_decrement(first: f64, second: f64) -> f64 {
    let l = (first / second).ln();
    l / (TAU * TAU + l * l).sqrt()
}

/// A local extremum of the deformation about its zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// When, s.
    pub time: f64,
    /// Deformation minus the offset, with its sign.
    pub height: f64,
}

/// Successive extrema of a free decay of about this frequency (rad/s) about a given offset, until one is below
/// `floor`.
///
/// An extremum is the greatest (least) sample of half a period around it, and on its own side of the
/// offset. Each is refined by the vertex of the parabola that fits the samples within an eighth of a
/// period, which averages the noise; its bias on a cosine is below 0.3 % of the height.
pub fn extrema(samples: &[Sample], frequency: f64, offset: f64, floor: f64) -> Vec<Extremum> {
    let quarter_period = 0.5 * PI / frequency;
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let inside =
        |s: &Sample| s.time - first.time >= quarter_period && last.time - s.time >= quarter_period;
    let greatest = |index: usize, sign: f64| {
        let centre = samples[index];
        let height = sign * (centre.deformation - offset);
        let earlier = samples[..index].iter().rev();
        let later = samples[index + 1..].iter();
        let near = |s: &&Sample| (s.time - centre.time).abs() <= quarter_period;
        // Of equal samples the first counts.
        height > 0.0
            && earlier
                .take_while(near)
                .all(|s| sign * (s.deformation - offset) < height)
            && later
                .take_while(near)
                .all(|s| sign * (s.deformation - offset) <= height)
    };
    (0..samples.len())
        .filter(|&k| inside(&samples[k]) && (greatest(k, 1.0) || greatest(k, -1.0)))
        .map(|k| vertex(samples, samples[k], 0.5 * quarter_period, offset))
        .take_while(|extremum| extremum.height.abs() >= floor)
        .collect()
}

/// Vertex of the least-squares parabola through the samples within `reach` of a highest one; the
/// sample itself where they are too few or bend the other way.
fn vertex(samples: &[Sample], centre: Sample, reach: f64, offset: f64) -> Extremum {
    let mut normal = nalgebra::Matrix3::zeros();
    let mut rhs = nalgebra::Vector3::zeros();
    let first = samples.partition_point(|s| s.time < centre.time - reach);
    for sample in samples[first..]
        .iter()
        .take_while(|s| s.time <= centre.time + reach)
    {
        let t = (sample.time - centre.time) / reach;
        let row = nalgebra::Vector3::new(1.0, t, t * t);
        normal += row * row.transpose();
        rhs += row * (sample.deformation - offset);
    }
    let height = centre.deformation - offset;
    match normal.cholesky().map(|c| c.solve(&rhs)) {
        Some(c) if c[2] * height < 0.0 && (c[1] / (2.0 * c[2])).abs() <= 1.0 => Extremum {
            time: centre.time - reach * c[1] / (2.0 * c[2]),
            height: c[0] - c[1] * c[1] / (4.0 * c[2]),
        },
        _ => Extremum {
            time: centre.time,
            height,
        },
    }
}

/// Mode from extrema half a period apart: a line through the logarithm of the amplitudes over their
/// count.
///
/// An amplitude is half of the distance between neighbours, so no offset enters. The decrement a half
/// period is `pi xi / sqrt(1 - xi^2)`; `omega_d = pi / spacing`. `None` with fewer than three extrema or
/// where the amplitudes do not fall.
pub fn mode_of_extrema(extrema: &[Extremum]) -> Option<Mode> {
    let count = extrema.len();
    if count < 3 {
        return None;
    }
    let spacing = (extrema[count - 1].time - extrema[0].time) / (count - 1) as f64;
    let centre = (count - 2) as f64 / 2.0;
    let square: f64 = (0..count - 1).map(|k| (k as f64 - centre).powi(2)).sum();
    let slope: f64 = extrema
        .windows(2)
        .enumerate()
        .map(|(k, pair)| {
            let amplitude = 0.5 * (pair[1].height - pair[0].height).abs();
            (k as f64 - centre) * amplitude.ln()
        })
        .sum::<f64>()
        / square;
    let xi = log_decrement(1.0, (2.0 * slope).exp());
    Mode::new(
        PI / spacing / (1.0 - xi * xi).max(f64::MIN_POSITIVE).sqrt(),
        xi,
    )
    .ok()
}
