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
/// use quell::estimators::offline::log_decrement;
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

/// Successive extrema of a free decay of about this frequency (rad/s), one a half period, about a
/// given offset; ends where one sinks below `floor`.
///
/// Each is the vertex of the parabola that fits the samples within an eighth of a period, which
/// averages the noise; its bias on a cosine is below 0.3 % of the height.
pub fn extrema(samples: &[Sample], frequency: f64, offset: f64, floor: f64) -> Vec<Extremum> {
    let half_period = PI / frequency;
    let mut found: Vec<Extremum> = Vec::new();
    let Some(first) = samples.first() else {
        return found;
    };
    // The largest of the first whole period begins; each next one is looked for half a period on.
    let mut from = first.time;
    let mut until = first.time + 2.0 * half_period;
    let mut sign = 0.0;
    loop {
        let peak = samples
            .iter()
            .enumerate()
            .filter(|(_, s)| s.time >= from && s.time < until)
            .map(|(index, s)| (index, s.deformation - offset))
            .map(|(index, x)| (index, if sign == 0.0 { x.abs() } else { sign * x }))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((index, height)) = peak else { break };
        if until > samples[samples.len() - 1].time || height < floor {
            break;
        }
        let Some(extremum) = vertex(samples, samples[index].time, half_period / 4.0, offset) else {
            break;
        };
        if extremum.height.abs() < floor {
            break;
        }
        sign = -extremum.height.signum();
        found.push(extremum);
        from = extremum.time + 0.5 * half_period;
        until = extremum.time + 1.5 * half_period;
    }
    found
}

/// Vertex of the least-squares parabola through the samples within `reach` of `centre`.
fn vertex(samples: &[Sample], centre: f64, reach: f64, offset: f64) -> Option<Extremum> {
    let mut normal = nalgebra::Matrix3::zeros();
    let mut rhs = nalgebra::Vector3::zeros();
    let mut highest = 0.0_f64;
    for sample in samples.iter().filter(|s| (s.time - centre).abs() <= reach) {
        let t = (sample.time - centre) / reach;
        let x = sample.deformation - offset;
        let row = nalgebra::Vector3::new(1.0, t, t * t);
        normal += row * row.transpose();
        rhs += row * x;
        highest = if x.abs() > highest.abs() { x } else { highest };
    }
    let solution = normal.cholesky().map(|c| c.solve(&rhs));
    match solution {
        // A vertex outside of its samples is an end, not an extremum.
        Some(c) if c[2] * highest < 0.0 && (c[1] / (2.0 * c[2])).abs() <= 1.0 => Some(Extremum {
            time: centre - reach * c[1] / (2.0 * c[2]),
            height: c[0] - c[1] * c[1] / (4.0 * c[2]),
        }),
        // Too few samples for a parabola: the highest one.
        _ if highest != 0.0 => Some(Extremum {
            time: centre,
            height: highest,
        }),
        _ => None,
    }
}

/// Mode from extrema half a period apart: a line through `ln |height|` over the count.
///
/// The decrement a half period is `pi xi / sqrt(1 - xi^2)`; `omega_d = pi / spacing`. `None` with
/// fewer than two extrema or where the heights do not fall.
pub fn mode_of_extrema(extrema: &[Extremum]) -> Option<Mode> {
    let count = extrema.len();
    if count < 2 {
        return None;
    }
    let spacing = (extrema[count - 1].time - extrema[0].time) / (count - 1) as f64;
    let centre = (count - 1) as f64 / 2.0;
    let square: f64 = (0..count).map(|k| (k as f64 - centre).powi(2)).sum();
    let slope: f64 = extrema
        .iter()
        .enumerate()
        .map(|(k, extremum)| (k as f64 - centre) * extremum.height.abs().ln())
        .sum::<f64>()
        / square;
    let xi = log_decrement(1.0, (2.0 * slope).exp());
    Mode::new(
        PI / spacing / (1.0 - xi * xi).max(f64::MIN_POSITIVE).sqrt(),
        xi,
    )
    .ok()
}
