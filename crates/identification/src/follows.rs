//! A tip that follows the motor side without a mode.

use nalgebra::{Matrix4, Vector4};
use quell_control::estimators::Sample;
use quell_recording::range;
use quell_signal::{CubicSpline, End, golden_section};

/// Steps of Gauss and Newton for the delay.
const STEPS: usize = 4;
/// Steps of the golden section for the time constant: its bracket shrinks to 1e-5 of itself.
const SECTIONS: usize = 24;

/// The least-squares fit of a tip that only follows the motor side,
///
/// ```text
/// u(t) + delta(t) = a + r u(t - tau)
/// ```
///
/// with the offset `a` of a sensor, the error of its scale in `r`, and that of its clock in `tau`. None of them
/// is a mode, although a mode can be fitted to what they leave in the deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follows {
    /// Sum of the squares that it leaves.
    pub residual: f64,
    /// Range of what it leaves.
    pub range: f64,
}

impl Follows {
    /// The fit to samples whose stamps increase.
    pub fn of(samples: &[Sample]) -> Self {
        let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
        let motor: Vec<f64> = samples.iter().map(|s| s.motor_position).collect();
        let spline = CubicSpline::new(&time, &motor, End::NotAKnot).ok();
        let mut best = Self {
            residual: f64::INFINITY,
            range: f64::INFINITY,
        };
        let mut tau = 0.0;
        for _ in 0..STEPS {
            let input = |t: f64| {
                let own = spline.as_ref()?;
                let (first, last) = own.span();
                let at = (t - tau).clamp(first, last);
                Some([own.value(at), own.derivative(at), 0.0])
            };
            let row = |s: &Sample| input(s.time).unwrap_or_default();
            let rows: Vec<[f64; 3]> = samples.iter().map(row).collect();
            let fit = line(samples, &rows);
            if fit.residual < best.residual {
                best = Self {
                    residual: fit.residual,
                    range: fit.range,
                };
            }
            let later = -fit.slopes[1] / fit.slopes[0];
            tau += if later.is_finite() { later } else { 0.0 };
        }
        best
    }
}

/// The least-squares fit of a tip that follows the motor side through a lag of first order,
///
/// ```text
/// u(t) + delta(t) = a + r x(t) + q u(t) + b e^(-t / T),    T x' + x = u
/// ```
///
/// as behind the filter of a sensor, or behind a damper without inertia. `q` is an error of a clock, as
/// `x(t - tau) = x(t) - tau (u - x) / T` of a short `tau`. It has no frequency, and does not ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lags {
    /// `T`, s: between the distance of two samples and the recording's length.
    pub time_constant: f64,
    /// Sum of the squares that it leaves.
    pub residual: f64,
}

impl Lags {
    /// The fit to samples whose stamps increase: the best of time constants that double, refined by golden sections.
    pub fn of(samples: &[Sample]) -> Self {
        let duration = samples[samples.len() - 1].time - samples[0].time;
        let least = duration / (samples.len() - 1) as f64;
        let left = |log: f64| line(samples, &lagged(samples, log.exp())).residual;
        let doublings = (0..).map(|k| least.ln() + f64::from(k) * core::f64::consts::LN_2);
        let tried = doublings.take_while(|log| *log <= duration.ln());
        let best = tried
            .map(|log| (log, left(log)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let (centre, _) = best.unwrap_or((least.ln(), 0.0));
        let (log, residual) = golden_section(left, [centre - 1.0, centre + 1.0], SECTIONS);
        Self {
            time_constant: log.exp(),
            residual,
        }
    }
}

/// The motor side behind a lag, which begins in rest, the decay of another beginning, and the motor side itself. Exact for a motor side that is
/// straight between two samples.
fn lagged(samples: &[Sample], time_constant: f64) -> Vec<[f64; 3]> {
    let first = &samples[0];
    let mut rows = vec![[first.motor_position, 1.0, first.motor_position]];
    let (mut behind, mut decay) = (first.motor_position, 1.0);
    for pair in samples.windows(2) {
        let step = pair[1].time - pair[0].time;
        let [from, until] = [&pair[0], &pair[1]].map(|s| s.motor_position);
        let kept = (-step / time_constant).exp();
        let slope = time_constant * (until - from) / step;
        behind = until - slope + (behind - from + slope) * kept;
        decay *= kept;
        rows.push([behind, decay, until]);
    }
    rows
}

/// A fit of the tip's position by three columns and a constant; the slopes of the first two.
struct Line {
    residual: f64,
    range: f64,
    slopes: [f64; 2],
}

fn line(samples: &[Sample], rows: &[[f64; 3]]) -> Line {
    let count = samples.len() as f64;
    let tip = |s: &Sample| s.motor_position + s.deformation;
    let mean = samples.iter().map(tip).sum::<f64>() / count;
    let centre = [0, 1, 2].map(|k| rows.iter().map(|row| row[k]).sum::<f64>() / count);
    // The offset's own column keeps its one, and is orthogonal to the others.
    let own = |row: &[f64; 3]| {
        Vector4::new(
            1.0,
            row[0] - centre[0],
            row[1] - centre[1],
            row[2] - centre[2],
        )
    };
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (row, s) in rows.iter().zip(samples) {
        normal += own(row) * own(row).transpose();
        right += own(row) * (tip(s) - mean);
    }
    // What does not vary has no column.
    for k in 0..4 {
        if normal[(k, k)] <= 0.0 {
            normal[(k, k)] = 1.0;
        }
    }
    let found = normal.cholesky().map(|factor| factor.solve(&right));
    let found = found.unwrap_or_default();
    let left = rows.iter().zip(samples);
    let left: Vec<f64> = left
        .map(|(row, s)| tip(s) - mean - own(row).dot(&found))
        .collect();
    Line {
        residual: left.iter().map(|e| e * e).sum(),
        range: range(&left),
        slopes: [found[1], found[2]],
    }
}
