//! The response of a mode whose frequency changes along the way.
//!
//! ```text
//! q'' + 2 xi w q' + w^2 q = w^2 u + 2 xi w u' + i (d ln w / du) q'^2    damper across the joint,    w = w(u(t))
//! g'' + 2 xi w g' + w^2 g = w^2 u                                       damper to ground
//! ```
//! Within a sample interval `w` is that of its middle and `u` a parabola. The step is then exact: the
//! differences from the particular solutions, `q - q_p`, `q_p = u - u'' / w^2`, and `g - g_p`, `g_p = u - (2 xi
//! / w) u' + ((4 xi^2 - 1) / w^2) u''`, decay freely. `i` is 1 where the inertia changes, else 0 ([`super::cause`]); `q'` in the push is
//! that of the middle of the interval, for which it is constant.

use super::cause::Cause;
use crate::estimators::Sample;

/// Columns of a mode at the samples: the driven response, and the free decay of the initial state.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// `q - u`; `g - q`; `q' / w_0`; free decays from a deflection of 1, and from a velocity of `w_0`.
    pub of: [Vec<f64>; COLUMNS],
}

/// Columns of a mode.
pub const COLUMNS: usize = 5;
/// Half the way over which the slope of `ln w` is taken, rad.
const NEAR: f64 = 1e-4;

/// State of a mode: position and velocity.
type State = [f64; 2];

/// `exp(A h)` of a free mode of frequency `w` and damping ratio `xi`.
pub fn free_step(w: f64, xi: f64, h: f64) -> [[f64; 2]; 2] {
    let root = (1.0 - xi * xi).sqrt();
    let (sin, cos) = (w * root * h).sin_cos();
    let decay = (-xi * w * h).exp();
    let s = xi / root * sin;
    [
        [decay * (cos + s), decay * sin / (w * root)],
        [-decay * w * sin / root, decay * (cos - s)],
    ]
}

fn times(step: &[[f64; 2]; 2], x: State) -> State {
    [
        step[0][0] * x[0] + step[0][1] * x[1],
        step[1][0] * x[0] + step[1][1] * x[1],
    ]
}

/// Slope and half the second derivative of the input around each sample's interval.
fn bend(samples: &[Sample], k: usize) -> (f64, f64) {
    let [a, b] = [samples[k - 1], samples[k]];
    let step = b.time - a.time;
    let chord = (b.motor_position - a.motor_position) / step;
    if k < 2 {
        return (chord, 0.0);
    }
    let before = samples[k - 2];
    let step_before = a.time - before.time;
    // A parabola over intervals of different length would extrapolate noise.
    if !(0.25..=4.0).contains(&(step_before / step)) {
        return (chord, 0.0);
    }
    let chord_before = (a.motor_position - before.motor_position) / step_before;
    (chord, (chord - chord_before) / (step + step_before))
}

/// The columns of a mode along samples, `ln w` a function of the motor side's position.
pub fn columns(samples: &[Sample], log_w: impl Fn(f64) -> f64, xi: f64, cause: Cause) -> Columns {
    let mut columns = Columns::default();
    columns.of.iter_mut().for_each(|c| c.reserve(samples.len()));
    let Some(first) = samples.first() else {
        return columns;
    };
    let start = log_w(first.motor_position).exp();
    let origin = first.motor_position;
    let mut driven: [State; 2] = [[0.0; 2]; 2];
    let mut free: [State; 2] = [[1.0, 0.0], [0.0, start]];
    for (k, sample) in samples.iter().enumerate() {
        if k > 0 {
            let last = samples[k - 1];
            let h = sample.time - last.time;
            let middle = 0.5 * (last.motor_position + sample.motor_position);
            let w = log_w(middle).exp();
            let step = free_step(w, xi, h);
            let (chord, curve) = bend(samples, k);
            let second = 2.0 * curve;
            let across = |u: f64, rate: f64| [u - second / (w * w), rate];
            let ground = |u: f64, rate: f64| {
                let bent = (4.0 * xi * xi - 1.0) / (w * w) * second;
                [u - 2.0 * xi / w * rate + bent, rate - 2.0 * xi / w * second]
            };
            let ends = [
                (last.motor_position - origin, chord - curve * h),
                (sample.motor_position - origin, chord + curve * h),
            ];
            let [from, to] = ends.map(|(u, rate)| [across(u, rate), ground(u, rate)]);
            let before = driven[0][1];
            driven = core::array::from_fn(|k| {
                let state = driven[k];
                let loose = times(&step, [state[0] - from[k][0], state[1] - from[k][1]]);
                [loose[0] + to[k][0], loose[1] + to[k][1]]
            });
            if cause == Cause::Inertia {
                let slope = (log_w(middle + NEAR) - log_w(middle - NEAR)) / (2.0 * NEAR);
                let rate = 0.5 * (before + driven[0][1]);
                let pushed = slope * rate * rate / (w * w);
                let loose = times(&step, [pushed, 0.0]);
                driven[0][0] += pushed - loose[0];
                driven[0][1] -= loose[1];
            }
            free = free.map(|state| times(&step, state));
        }
        let [across, ground] = driven;
        let row = [
            across[0] - (sample.motor_position - origin),
            ground[0] - across[0],
            across[1] / start,
            free[0][0],
            free[1][0],
        ];
        columns.of.iter_mut().zip(row).for_each(|(c, x)| c.push(x));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::{Cause, columns};
    use crate::estimators::Sample;

    /// Of a motor side that accelerates evenly, `u = t^2 / 2`, a mode without damping lags by
    /// `(cos w t - 1) / w^2`: the particular solution is exact for a parabola.
    #[test]
    fn val_response_to_an_even_acceleration() {
        let sample = |k: usize| Sample {
            time: 0.002 * k as f64,
            motor_position: 0.5 * (0.002 * k as f64).powi(2),
            deformation: 0.0,
        };
        let samples: Vec<Sample> = (0..400).map(sample).collect();
        let w: f64 = 50.0;
        let found = columns(&samples, |_| w.ln(), 0.0, Cause::Inertia).of;
        for (k, sample) in samples.iter().enumerate() {
            // The first interval has no parabola yet: it lacks h^2 / 8 of the input at most.
            let lag = ((w * sample.time).cos() - 1.0) / (w * w);
            assert!(
                (found[0][k] - lag).abs() < 2e-6,
                "{k}: {} {lag}",
                found[0][k]
            );
            let free = (w * sample.time).cos();
            assert!((found[3][k] - free).abs() < 1e-9, "{k}");
        }
    }

    /// Of a motor side that moves on evenly from a standing link, `q' = v (1 - cos w t)`, an inertia that falls slowly along the
    /// way, `s = d ln w / du`, adds the response to `s q'^2`:
    /// `y = s v^2 [(3/2 - 4/3 cos w t - 1/6 cos 2 w t) / w^2 - (t / w) sin w t]`.
    #[test]
    fn val_push_of_an_inertia_that_changes() {
        let (w, s, v): (f64, f64, f64) = (50.0, 1e-4, 2.0);
        let sample = |k: usize| Sample {
            time: 0.001 * k as f64,
            motor_position: 0.001 * k as f64 * v,
            deformation: 0.0,
        };
        let samples: Vec<Sample> = (0..400).map(sample).collect();
        let of = |cause| columns(&samples, |u| w.ln() + s * u, 0.0, cause).of;
        let [without, with] = [Cause::Stiffness, Cause::Inertia].map(of);
        let size = s * v * v * 0.4 / w;
        for (k, sample) in samples.iter().enumerate() {
            let (t, angle) = (sample.time, w * sample.time);
            let steady = 1.5 - 4.0 / 3.0 * angle.cos() - (2.0 * angle).cos() / 6.0;
            let pushed = s * v * v * (steady / (w * w) - t / w * angle.sin());
            // The push is that of the middle of an interval, `(w h)^2 / 8` from its mean.
            let found = with[0][k] - without[0][k];
            assert!(
                (found - pushed).abs() < 1e-3 * size,
                "{k}: {found:e} {pushed:e}"
            );
        }
    }
}
