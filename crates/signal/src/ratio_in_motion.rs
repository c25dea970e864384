//! How far the link moves for each unit that the motor side moves, in motion.

use super::static_ratio::{CERTAIN, is_mistake};
use super::two_sides::{OVERLAP, Series};
use nalgebra::{SMatrix, SVector};

/// Unknowns of the law.
const UNKNOWNS: usize = 5;

/// The law of a link whose gain `g` is not known: `r`, `q`, `p` and `b` are whatever the joint is.
///
/// ```text
/// y = g u + p u' - q y' - r y'' + b
/// ```
///
/// `y'' = -w^2 (y - g u) - c (y' - g u') + b'`, Newton's law of a link on a spring and a damper, over `w^2`. Below the mode all
/// derivatives are small, and `y = g u + b`; near and above it they keep the resonance out of `g`. `p` is free, so that a sensor
/// that is late changes `p` and `q`, and not `g`.
///
/// It is integrated over windows as the law of [`Direction`](super::Direction) is. Windows of different widths see different
/// frequencies: a fit each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// `g`, in units of the link for each of the motor side.
    pub ratio: f64,
    /// One standard deviation, by what the law leaves in windows that do not overlap.
    pub std: f64,
}

impl Gain {
    /// Standard deviation, relatively.
    fn relative(&self) -> f64 {
        self.std / self.ratio.abs()
    }
}

impl Series {
    /// The gain of the width that knows it best, if it is certain. Noise of the derivatives makes it too small in narrow windows,
    /// so that one width that is certain of an usual gain outweighs all that are not.
    pub(super) fn certain_gain(&self) -> Option<Gain> {
        let gains = self.widths().filter_map(|width| self.gain(width));
        let certain: Vec<Gain> = gains.filter(|gain| gain.relative() <= CERTAIN).collect();
        let usual = |gain: &&Gain| !is_mistake(gain.ratio);
        let best = |a: &&Gain, b: &&Gain| a.relative().total_cmp(&b.relative());
        let plain = certain.iter().filter(usual).min_by(best);
        plain.or_else(|| certain.iter().min_by(best)).copied()
    }

    fn gain(&self, width: usize) -> Option<Gain> {
        let middle = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let middles = [middle(&self.motor), middle(&self.link)];
        let (mut normal, mut right, mut square, mut rows) = (
            SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros(),
            SVector::<f64, UNKNOWNS>::zeros(),
            0.0,
            0.0,
        );
        for at in self.starts(width)? {
            let (row, value) = self.motion(at, width, middles);
            normal += row * row.transpose();
            right += row * value;
            square += value * value;
            rows += 1.0;
        }
        let factor = normal.cholesky()?;
        let found = factor.solve(&right);
        let free = rows / OVERLAP as f64 - UNKNOWNS as f64;
        // The difference of two sums is not known better than they are rounded: it is no proof of a gain.
        let rounded = rows.sqrt() * f64::EPSILON * square;
        let left = (square - right.dot(&found)).max(rounded) / OVERLAP as f64;
        let variance = factor.inverse()[(0, 0)] * OVERLAP as f64 * left / free;
        let gain = Gain {
            ratio: found[0],
            std: variance.sqrt(),
        };
        (free > 0.0 && gain.ratio.is_finite() && gain.std.is_finite()).then_some(gain)
    }

    /// The integrals of the law's terms over a window, in units of half its span, and of the link.
    fn motion(
        &self,
        at: usize,
        width: usize,
        [motor, link]: [f64; 2],
    ) -> (SVector<f64, UNKNOWNS>, f64) {
        let (mut row, mut value) = (SVector::<f64, UNKNOWNS>::zeros(), 0.0);
        for k in at + 1..at + width {
            let [window, once, twice] = self.window(at, width, k);
            let (u, y) = (self.motor[k] - motor, self.link[k] - link);
            row += SVector::from([window * u, -once * u, once * y, -twice * y, window]);
            value += window * y;
        }
        (row, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAU: f64 = core::f64::consts::TAU;
    const RATE: f64 = 250.0;

    /// A motor side and a link whose force is `law(deformation, its rate)`, sampled, with sensors of a noise and of scales.
    fn joint(
        motor: impl Fn(f64) -> f64,
        law: impl Fn(f64, f64) -> f64,
        noise: f64,
        scales: [f64; 2],
    ) -> Series {
        let (fine, mut seed) = (20, 11_u64);
        let mut error = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            noise * ((seed >> 40) as f64 / f64::from(1 << 24) - 0.5)
        };
        let step = 1.0 / RATE / f64::from(fine);
        let (mut y, mut v, mut u) = (motor(0.0), 0.0, motor(0.0));
        let mut own = Series {
            time: Vec::new(),
            motor: Vec::new(),
            link: Vec::new(),
        };
        for k in 0..2000 * fine {
            let t = f64::from(k) * step;
            if k % fine == 0 {
                own.time.push(t);
                own.motor.push(scales[0] * (u + error()));
                own.link.push(scales[1] * (y + error()));
            }
            let next = motor(t + step);
            v += step * law(y - u, v - (next - u) / step);
            y += step * v;
            u = next;
        }
        own
    }

    /// Steps within a sample, of a joint without noise, and what the link does after them exactly.
    fn stepped(hertz: f64, xi: f64, at: f64, samples: usize) -> Series {
        let (w, wd) = (TAU * hertz, TAU * hertz * (1.0 - xi * xi).sqrt());
        let time: Vec<f64> = (0..samples).map(|k| k as f64 / RATE).collect();
        let link = |t: &f64| match t - at {
            d if d < 0.0 => 0.0,
            d => 1.0 - (-xi * w * d).exp() * ((wd * d).cos() + xi * w / wd * (wd * d).sin()),
        };
        Series {
            motor: time.iter().map(|t| f64::from(*t >= at)).collect(),
            link: time.iter().map(link).collect(),
            time,
        }
    }

    /// What is left of a fit is not known below the rounding of its sums.
    #[test]
    fn a_step_without_noise_tells_no_wrong_gain() {
        for hertz in [4.0, 8.0, 20.0, 52.0, 72.0, 99.6] {
            for (samples, step) in [(80, 2), (100, 1), (100, 92), (140, 1), (140, 128), (300, 3)] {
                for xi in [0.01, 0.042, 0.1] {
                    let found = stepped(hertz, xi, f64::from(step) / RATE, samples).certain_gain();
                    let wrong = found.filter(|own| is_mistake(own.ratio));
                    assert_eq!(wrong, None, "{hertz} Hz, {xi}, step {step} of {samples}");
                }
            }
        }
    }

    fn spring(hertz: f64, xi: f64) -> impl Fn(f64, f64) -> f64 {
        let w = TAU * hertz;
        move |d, rate| -w * w * d - 2.0 * xi * w * rate
    }

    /// Three tones below `top` Hz, without a rest.
    fn tones(top: f64) -> impl Fn(f64) -> f64 {
        move |t| {
            let tone = |share: f64, size: f64| size * (TAU * share * top * t + share).sin();
            tone(0.21, 0.3) + tone(0.47, 0.15) + tone(1.0, 0.08)
        }
    }

    #[test]
    fn val_the_gain_is_the_ratio_of_the_scales_whatever_the_mode() {
        for (hertz, xi) in [(3.0, 0.05), (8.0, 0.03), (8.0, 1.2), (60.0, 0.1)] {
            for scales in [[1.0, 1.0], [1.0, -1.0], [50.0, 1.0], [1.0, 5.0], [1.5, 1.0]] {
                let own = joint(tones(1.7), spring(hertz, xi), 1e-4, scales);
                let gain = own.certain_gain().unwrap();
                let right = scales[1] / scales[0];
                assert!(
                    (gain.ratio / right - 1.0).abs() < 0.01,
                    "{hertz} Hz, {scales:?}: {gain:?}"
                );
            }
        }
    }

    /// Where the motion tells no gain, none is told that would be a mistake of a sensor.
    #[test]
    fn what_is_far_from_slow_or_follows_by_play_is_no_mistake() {
        let w = TAU * 3.0;
        let no_mistake = |what: &str, own: Series| {
            let gain = own.certain_gain();
            assert!(
                gain.is_none_or(|gain| !is_mistake(gain.ratio)),
                "{what}: {gain:?}"
            );
        };
        for noise in [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
            // Far above the mode the link moves the other way, and by little.
            for hertz in [0.05, 0.3, 1.0] {
                let above = |t: f64| 0.1 * (TAU * 6.0 * t).sin();
                no_mistake(
                    "one tone above",
                    joint(above, spring(hertz, 0.03), noise, [1.0, 1.0]),
                );
                no_mistake(
                    "tones above",
                    joint(tones(12.0), spring(hertz, 0.03), noise, [1.0, 1.0]),
                );
            }
            // A motor side that gives way to a link that rings.
            for share in [-0.3, -0.05, 0.05, 0.3] {
                let recoils = |t: f64| share * (-0.1 * t).exp() * (TAU * 3.0 * t).cos();
                no_mistake(
                    "recoil",
                    joint(recoils, spring(3.0, 0.005), noise, [1.0, 1.0]),
                );
            }
            // Backlash as large as the motion, and an end stop in its middle.
            for gap in [0.05, 0.2, 0.4] {
                let play = |d: f64, rate: f64| -w * w * (d - d.clamp(-gap, gap)) - 0.5 * rate;
                no_mistake("backlash", joint(tones(1.7), play, noise, [1.0, 1.0]));
                let stiff = |d: f64, rate: f64| -w * w * d * (1.0 + d * d / gap.powi(2)) - rate;
                no_mistake("cubic", joint(tones(1.7), stiff, noise, [1.0, 1.0]));
            }
        }
    }
}
