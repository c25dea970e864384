//! Which of two positions of a joint follows the other.

use super::static_ratio::{FAR, rounded};
use super::strong::STRONG;
use super::two_sides::{FEWEST, OVERLAP, Series, unwrapped};
use nalgebra::{Matrix4, Vector3, Vector4};
use quell_recording::{Recording, Role, plain, range};

/// Newton's law of the link, fitted to a motor side `u` and a link `y` as they are written, and exchanged.
///
/// ```text
/// written    y'' = -w^2 (y - u) - c (y' - u') - d u' + b
/// exchanged  u'' = -w^2 (u - y) - c (u' - y') - d y' + b
/// ```
///
/// Nothing but the joint accelerates the link, while a drive moves the motor side. So the joint is a spring and a damper
/// in the direction that is true, and needs a negative stiffness in the other one, wherever the move is slower than the mode.
/// A sensor of the side that follows may be late: by `d / w^2` behind the rate of the other side.
/// Derivatives are taken from the windows `p(s) = (1 - s^2)^4` of the weak form, so that none is taken of noise.
///
/// Source: Shinbrot, "On the analysis of linear and nonlinear systems", Trans. ASME 79 (1957).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// `w^2` as written and exchanged, 1/s^2.
    pub stiffness: [f64; 2],
    /// `c` as written and exchanged, 1/s.
    pub damping: [f64; 2],
    /// Difference of the information criteria, `n ln(s_written / s_exchanged)`: `s` is the share of the acceleration that
    /// is left, `n` the number of windows that do not overlap. Where the gain of the link is certain, `s_written` is the least one
    /// with and without it.
    pub evidence: f64,
    /// How many times as far as the link the motor side moves: the ratio of both ranges.
    pub travel: f64,
}

impl Direction {
    /// The fit at the width of window that tells the two apart best. `None` without a `motor_position` and a `link_position`
    /// of one unit that vary, or where too few samples are in a row.
    pub fn of(recording: &Recording) -> Option<Self> {
        let of = |role| recording.channel(role).filter(|own| own.varies());
        let (motor, link) = (of(Role::MotorPosition)?, of(Role::LinkPosition)?);
        if motor.unit != link.unit {
            return None;
        }
        let series = Series::of(&unwrapped(motor), &unwrapped(link))?;
        let scaled = series.certain_gain().map(|gain| Series {
            link: series.link.iter().map(|value| value / gain.ratio).collect(),
            ..series.clone()
        });
        let fits = series.widths();
        fits.filter_map(|width| series.fit(width, scaled.as_ref()))
            .max_by(|a, b| a.evidence.abs().total_cmp(&b.evidence.abs()))
    }

    /// Whether the columns are exchanged: as written the joint has a negative stiffness, exchanged it is a spring and a
    /// damper, with very strong evidence.
    pub fn is_exchanged(&self) -> bool {
        let [written, exchanged] = self.stiffness;
        let passive = exchanged > 0.0 && self.damping[1] > 0.0;
        written < 0.0 && passive && self.evidence > STRONG
    }

    /// The mistake in a sentence without a full stop, if there is one.
    pub fn contradiction(&self) -> Option<String> {
        let hertz = self.stiffness[1].max(0.0).sqrt() / core::f64::consts::TAU;
        let is_far = !(FAR.recip()..FAR).contains(&self.travel);
        self.is_exchanged().then(|| match is_far {
            // The one that follows may swing through, yet by less than once more as far after a step.
            true => format!(
                "motor_position moves {} times as far as link_position, which no joint does: one of the two has another \
                 unit, or a gear is between; write scale = {} at the [[channel]] of motor_position if it is measured before \
                 the gear, or exchange the two",
                plain(rounded(self.travel)),
                plain(rounded(self.travel.recip()))
            ),
            false => format!(
                "motor_position follows link_position, with a mode near {hertz:.1} Hz, where a link follows its motor side: \
                 the two are exchanged; write role = \"link_position\" at the [[channel]] of motor_position, and role = \
                 \"motor_position\" at that of link_position"
            ),
        })
    }
}

impl Series {
    /// The fits of both directions in windows of so many samples.
    fn fit(&self, width: usize, scaled: Option<&Series>) -> Option<Direction> {
        let rows = self.rows(width)?;
        let (written, exchanged) = (law(&rows, 1, -1.0)?, law(&rows, 0, 1.0)?);
        // A scale that is wrong is no exchange: what it explains speaks for the columns as they are written.
        let scaled = scaled.and_then(|own| law(&own.rows(width)?, 1, -1.0));
        let left = scaled.map_or(written.1, |(_, left)| left.min(written.1));
        let apart = rows.len() as f64 / OVERLAP as f64;
        let evidence = apart * (left / exchanged.1).ln();
        (apart >= FEWEST as f64 / 2.0 && evidence.is_finite()).then_some(Direction {
            stiffness: [written.0[0], exchanged.0[0]],
            damping: [written.0[1], exchanged.0[1]],
            evidence,
            travel: range(&self.motor) / range(&self.link),
        })
    }

    fn rows(&self, width: usize) -> Option<Vec<Row>> {
        let starts = self.starts(width)?;
        Some(starts.into_iter().map(|at| self.row(at, width)).collect())
    }

    /// The integrals of a window; those of derivatives are moved to the window.
    fn row(&self, at: usize, width: usize) -> Row {
        let half = 0.5 * (self.time[at + width] - self.time[at]);
        let mut row = Row::default();
        for k in at + 1..at + width {
            let [window, once, twice] = self.window(at, width, k);
            let (once, twice) = (once / half, twice / half.powi(2));
            let deformation = self.link[k] - self.motor[k];
            row.joint += Vector3::new(window * deformation, -once * deformation, window);
            row.rates[0] -= once * (self.motor[k] - self.motor[at]);
            row.rates[1] -= once * (self.link[k] - self.link[at]);
            row.accelerations[0] += twice * (self.motor[k] - self.motor[at]);
            row.accelerations[1] += twice * (self.link[k] - self.link[at]);
        }
        row
    }
}

/// Integrals over a window: of deformation, its rate and 1, and of the rates and accelerations of motor side and link.
#[derive(Default)]
struct Row {
    joint: Vector3<f64>,
    rates: [f64; 2],
    accelerations: [f64; 2],
}

/// Least squares of an acceleration over what the joint does, and over the rate of the other side, behind which a sensor may
/// be late: the coefficients, and the share that is left.
fn law(rows: &[Row], which: usize, sign: f64) -> Option<(Vector4<f64>, f64)> {
    let (mut normal, mut right, mut whole) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
    for row in rows {
        let value = sign * row.accelerations[which];
        let terms = row.joint.push(row.rates[1 - which]);
        normal += terms * terms.transpose();
        right += terms * value;
        whole += value * value;
    }
    let found = normal.cholesky()?.solve(&right);
    let left = (1.0 - right.dot(&found) / whole).max(f64::EPSILON);
    left.is_finite().then_some((found, left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_recording::Channel;

    const TAU: f64 = core::f64::consts::TAU;

    /// Moves of the motor side at 500 Hz, and its rate.
    fn motor(t: f64) -> [f64; 2] {
        let moves = [(0.5, 0.25, 0.5), (2.0, 0.25, -0.7), (3.5, 0.3, 0.9)];
        moves.iter().fold([0.0, 0.0], |[u, v], (at, span, by)| {
            let s: f64 = ((t - at) / span).clamp(0.0, 1.0);
            let rate = 30.0 * s.powi(2) * (1.0 - s).powi(2) / span;
            [
                u + by * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
                v + by * rate,
            ]
        })
    }

    /// The link of a joint by Runge and Kutta, and a uniform error of both sensors.
    fn recording(hertz: f64, xi: f64, roles: [Role; 2], late: f64) -> Recording {
        let (w, step) = (TAU * hertz, 5e-4);
        let rate = |t: f64, [y, v]: [f64; 2]| {
            let [u, du] = motor(t);
            [v, w * w * (u - y) + 2.0 * xi * w * (du - v)]
        };
        let (mut state, mut seed) = ([0.0, 0.0], 7_u64);
        let mut error = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            1e-4 * ((seed >> 40) as f64 / f64::from(1 << 24) - 0.5)
        };
        let (mut time, mut columns) = (Vec::new(), [Vec::new(), Vec::new()]);
        for k in 0..10_000 {
            let t = f64::from(k) * step;
            if k % 4 == 0 {
                time.push(t);
                columns[0].push(motor(t - late)[0] + error());
                columns[1].push(state[0] + error());
            }
            let add = |d: [f64; 2], h: f64| [state[0] + h * d[0], state[1] + h * d[1]];
            let a = rate(t, state);
            let b = rate(t + step / 2.0, add(a, step / 2.0));
            let c = rate(t + step / 2.0, add(b, step / 2.0));
            let d = rate(t + step, add(c, step));
            state = [0, 1].map(|i| state[i] + step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        let channels = roles.into_iter().zip(columns);
        let channels = channels.map(|(role, column)| Channel {
            role,
            unit: "rad".into(),
            time: time.clone(),
            columns: vec![column],
        });
        Recording {
            name: "arm".into(),
            payload: None,
            channels: channels.collect(),
        }
    }

    #[test]
    fn val_the_link_is_what_the_joint_accelerates() {
        let roles = [Role::MotorPosition, Role::LinkPosition];
        let swapped = [Role::LinkPosition, Role::MotorPosition];
        for (hertz, xi) in [
            (3.0, 0.1),
            (6.0, 0.01),
            (8.0, 0.03),
            (14.0, 0.02),
            (25.0, 0.05),
        ] {
            let right = Direction::of(&recording(hertz, xi, roles, 0.0)).unwrap();
            assert!(!right.is_exchanged(), "{hertz} Hz: {right:?}");
            let wrong = Direction::of(&recording(hertz, xi, swapped, 0.0)).unwrap();
            assert!(wrong.is_exchanged(), "{hertz} Hz: {wrong:?}");
            let found = wrong.stiffness[1].sqrt() / TAU;
            assert!((found / hertz - 1.0).abs() < 0.05, "{hertz} Hz: {wrong:?}");
        }
    }

    /// The link passed through a sensor of second order with a corner at `hertz` and a damping of 0.6.
    fn filtered(mut own: Recording, hertz: f64) -> Recording {
        let w = TAU * hertz;
        let link = &mut own.channels[1];
        let step = link.time[1] - link.time[0];
        let [mut seen, mut rate] = [link.columns[0][0], 0.0];
        for value in &mut link.columns[0] {
            rate += step * (w * w * (*value - seen) - 1.2 * w * rate);
            seen += step * rate;
            *value = seen;
        }
        own
    }

    /// A sensor that filters makes the link late, and speaks for the columns as they are written.
    #[test]
    fn a_sensor_with_a_lag_is_not_exchanged() {
        let roles = [Role::MotorPosition, Role::LinkPosition];
        for hertz in [3.0, 6.0, 12.0] {
            for (xi, corner) in [(0.02, 23.0), (0.06, 16.0), (0.12, 12.0)] {
                let own = filtered(recording(hertz, xi, roles, 0.0), corner);
                let found = Direction::of(&own).unwrap();
                assert!(found.evidence < -STRONG, "{hertz} Hz: {found:?}");
            }
        }
    }

    /// A clock that is wrong by some samples exchanges nothing.
    #[test]
    fn a_late_or_early_sensor_is_not_exchanged() {
        for late in [-0.01, -0.002, 0.002, 0.01] {
            for hertz in [8.0, 60.0] {
                let roles = [Role::MotorPosition, Role::LinkPosition];
                let found = Direction::of(&recording(hertz, 0.03, roles, late));
                assert!(
                    found.is_none_or(|own| !own.is_exchanged()),
                    "{late} s, {hertz} Hz: {found:?}"
                );
            }
        }
    }
}
