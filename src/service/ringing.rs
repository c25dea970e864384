//! The residual vibration of a move: measured after its end, and as it would be without shaping.

use nalgebra::Complex;
use quell_shapers::Mode;

use crate::controller::ringing_time;

/// Periods after the end of a command in which the amplitude is measured.
const PERIODS: f64 = 2.0;
/// Number of frequencies to either side of the believed one that are tried if it is uncertain, and their ratio.
/// The ends are half and twice the belief, and neighbours are nearer than the resolution of two periods.
const TRIED: i32 = 14;
const RATIO: f64 = 1.05;
/// Change of a tick's increment that may be rounding of positions, rad.
pub const STEADY: f64 = 1e-12;
/// Fewest samples for a fit of four numbers that averages the noise.
const FEWEST: usize = 12;

/// Most periods for which an undamped mode is taken to ring: the estimator's window.
const LONGEST: f64 = 40.0;

/// How long a mode is taken to ring after a command, s.
pub fn rings_for(mode: Mode) -> f64 {
    ringing_time(mode).min(LONGEST * mode.damped_period())
}

/// Amplitude of a decaying oscillation at the first sample, in the samples' unit; `None` where there
/// are too few samples, or fewer than one period of them.
///
/// Least squares of `exp(-xi w t) (a cos w_d t + b sin w_d t) + c` over the first two periods; the
/// amplitude is `hypot(a, b)`. Where the mode is not `sure`, the frequency that fits best is taken.
/// `samples` are (time in s, deformation), in order.
pub fn amplitude(samples: &[(f64, f64)], mode: Mode, sure: bool) -> Option<f64> {
    let range = if sure { 0..=0 } else { -TRIED..=TRIED };
    let best = range
        .filter_map(|step| {
            let omega = mode.natural_frequency() * RATIO.powi(step);
            fit(samples, Mode::new(omega, mode.damping_ratio()).ok()?)
        })
        .min_by(|a, b| a.variance.total_cmp(&b.variance))?;
    Some(best.amplitude)
}

/// The largest [`amplitude`] over any two periods of a stretch, in steps of a period.
pub fn largest(samples: &[(f64, f64)], mode: Mode, sure: bool) -> Option<f64> {
    let (first, last) = (samples.first()?.0, samples.last()?.0);
    let periods = ((last - first) / mode.damped_period()) as usize;
    let windows = (0..periods.max(1)).filter_map(|k| {
        let from = first + k as f64 * mode.damped_period();
        let start = samples.partition_point(|(time, _)| *time < from);
        amplitude(&samples[start..], mode, sure)
    });
    windows.reduce(f64::max)
}

struct Fit {
    amplitude: f64,
    variance: f64,
}

fn fit(samples: &[(f64, f64)], mode: Mode) -> Option<Fit> {
    let start = samples.first()?.0;
    let window = PERIODS * mode.damped_period();
    let inside = samples
        .iter()
        .take_while(|(time, _)| time - start <= window);
    let used: Vec<_> = inside.map(|(time, value)| (time - start, *value)).collect();
    if used.len() < FEWEST || used.last()?.0 < 0.5 * window {
        return None;
    }
    let columns = |time: f64| {
        let envelope = (-mode.decay_rate() * time).exp();
        let (sine, cosine) = (mode.damped_frequency() * time).sin_cos();
        [envelope * cosine, envelope * sine, 1.0]
    };
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for &(time, value) in &used {
        let row = nalgebra::Vector3::from(columns(time));
        normal += row * row.transpose();
        right += row * value;
    }
    let solution = normal.cholesky()?.solve(&right);
    let square = |&(time, value): &(f64, f64)| {
        (value - nalgebra::Vector3::from(columns(time)).dot(&solution)).powi(2)
    };
    let variance = used.iter().map(square).sum::<f64>() / (used.len() - 3) as f64;
    Some(Fit {
        amplitude: solution[0].hypot(solution[1]),
        variance,
    })
}

/// Residual amplitude of the deformation in a mode after planned positions (one a tick of `period` s, from
/// rest), if they were sent unshaped and followed exactly; in their unit, at their last tick.
///
/// `|sum du_k exp(lambda (t - t_k))|` with `lambda = -xi w + j w_d`: a step of the motor side leaves an
/// amplitude of its own height.
pub fn unshaped(planned: &[f64], period: f64, mode: Mode) -> f64 {
    let (envelope, angle) = (
        (-mode.decay_rate() * period).exp(),
        mode.damped_frequency() * period,
    );
    let (turn_re, turn_im) = (envelope * angle.cos(), envelope * angle.sin());
    let (mut re, mut im) = (0.0f64, 0.0f64);
    for pair in planned.windows(2) {
        (re, im) = (re * turn_re - im * turn_im, re * turn_im + im * turn_re);
        re += pair[1] - pair[0];
    }
    re.hypot(im)
}

/// The largest vibration amplitude of planned positions without acceleration, as in [`unshaped`]: in cruise and
/// at the end.
///
/// A velocity of `du` a tick also causes a constant part of `du / (1 - exp(lambda T))`, which is no vibration.
pub fn unshaped_in_all(planned: &[f64], period: f64, mode: Mode) -> f64 {
    let pole = Complex::new(-mode.decay_rate(), mode.damped_frequency()) * period;
    let turn = pole.exp();
    let forced = (Complex::new(1.0, 0.0) - turn).inv();
    let mut state = Complex::new(0.0, 0.0);
    let mut before = 0.0;
    let mut largest = unshaped(planned, period, mode);
    for pair in planned.windows(2) {
        let increment = pair[1] - pair[0];
        state = state * turn + increment;
        if (increment - before).abs() <= STEADY {
            largest = largest.max((state - forced * increment).norm());
        }
        before = increment;
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_amplitude_of_a_decay_known_in_closed_form() {
        let mode = Mode::from_hertz(8.0, 0.05).expect("a mode");
        let decay: Vec<_> = (0..400)
            .map(|k| f64::from(k) * 0.003)
            .map(|t| {
                let swing = (mode.damped_frequency() * t + 0.4).cos();
                (t, 2e-4 * (-mode.decay_rate() * t).exp() * swing + 1e-5)
            })
            .collect();
        let wrong = Mode::from_hertz(10.0, 0.05).expect("a mode");
        let known = amplitude(&decay, mode, true).expect("samples");
        let searched = amplitude(&decay, wrong, false).expect("samples");
        assert!((known / 2e-4 - 1.0).abs() < 1e-9, "{known:e}");
        assert!((searched / 2e-4 - 1.0).abs() < 0.05, "{searched:e}");
    }

    #[test]
    fn val_a_ramp_rings_in_cruise_as_at_its_end() {
        let mode = Mode::from_hertz(10.0, 0.0).expect("a mode");
        // 7.25 periods of constant velocity: begin and end leave v / omega each.
        let ramp: Vec<f64> = (0..=725)
            .map(|k| f64::from(k) * 1e-3)
            .chain([0.725; 3])
            .collect();
        let alone = 1.0 / mode.natural_frequency();
        let largest = unshaped_in_all(&ramp, 0.001, mode);
        let both = unshaped(&ramp, 0.001, mode);
        // Sums for integrals: (omega T)^2 / 24, and half a tick of phase.
        assert!((both / alone - 2f64.sqrt()).abs() < 0.05, "{both:e}");
        assert!((largest - both).abs() < 1e-9, "{largest:e}");
        let cruise = unshaped_in_all(&ramp[..700], 0.001, mode);
        assert!((cruise / alone - 1.0).abs() < 0.01, "{cruise:e}");
    }

    #[test]
    fn val_a_step_leaves_its_height_and_two_half_a_period_apart_cancel() {
        let mode = Mode::from_hertz(10.0, 0.0).expect("a mode");
        let step = [0.0, 1.0, 1.0, 1.0];
        assert!((unshaped(&step, 0.001, mode) - 1.0).abs() < 1e-12);
        let mut two = vec![0.5; 51];
        two[0] = 0.0;
        two.push(1.0);
        assert!(unshaped(&two, 0.001, mode) < 1e-9);
    }
}
