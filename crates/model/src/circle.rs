//! The circle in a tracker's radial coordinate: its centre, its radius, and whether that is the lever arm.

mod rests;
mod sums;

use crate::effects::levelling;
use nalgebra::Vector2;
use quell_signal::golden_section;
use rests::Rests;
use sums::{Blocks, Sums, UNKNOWNS};

/// Relative uncertainty of a lever arm that is not an exact number: a millimetre in a metre.
const KNOWN_TO: f64 = 1e-3;
/// Odds by which a lever arm is taken for exact ("strong", Kass and Raftery 1995).
const ODDS: f64 = 20.0;

/// Rates at which a drift of the frame may level off, over the inverse duration of the recording: even in time, and up to
/// the fastest of `sensor_drift` in steps of two.
const SETTLING: [f64; 6] = [0.0, 1.25, 2.5, 5.0, 10.0, 20.0];
/// Golden sections by which the rate is found to a thousandth of the step.
const SECTIONS: usize = 15;
/// Unknowns of such a drift: two of its direction, and its rate.
const DRIFT: usize = 3;
/// Unknowns of a radius that changes with the speed: how much, and how late.
const SHRINKAGE: usize = 2;

/// A radius, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// As the tracker shows it.
    pub seen: f64,
    /// Its standard deviation, by a jackknife over blocks of time, which is valid for noise of any colour.
    pub std: f64,
    /// Degrees of freedom of this standard deviation: `sum(v)^2 / sum(v^2)` of the blocks' shares `v` of the variance in white
    /// noise (Satterthwaite, Biometrics Bulletin 2 (1946); Bell and McCaffrey, Survey Methodology 28 (2002)). In one move only
    /// the few blocks on the way tell the radius from the centre.
    pub freedom: f64,
}

/// The circle of a tip about its joint: `r = R + c_x cos(angle) + c_y sin(angle) + noise`.
///
/// A tracker that filters its coordinates, or exposes them for some time, sees a smaller circle in motion: a lag `T` has the gain
/// `|1 / (1 + i T w)| = 1 - (T w)^2 / 2` at a speed `w`, an exposure over `T` the gain `1 - (T w)^2 / 24`, each somewhat late. Where
/// the radial coordinate shows that, multiples of `w^2` and of its rate are free. Else the centre of the frame would be off.
///
/// The frame of a tracker may drift, as in `sensor_drift`: its centre is `c + d (1 - exp(-s t)) / s` then. Where the radial
/// coordinate shows that, `d` is free, and `c` is the centre at the start.
pub(super) struct Circle {
    sums: Sums<3>,
    arm: f64,
    /// The radius `R` from the radial coordinate.
    pub(super) radius: Radius,
}

impl Circle {
    /// A circle from the tip's angles (rad) and radii (m) about the assumed centre and the motor side's speeds (rad/s) and
    /// accelerations (rad/s^2) at increasing times (s), from coordinates that were rounded to `step` (m), 0 for none; `None`
    /// where the arc is too short.
    pub(super) fn new(
        time: &[f64],
        [angle, radius]: [&[f64]; 2],
        [speed, acceleration]: [&[f64]; 2],
        arm: f64,
        step: f64,
    ) -> Option<Self> {
        let (start, duration) = (*time.first()?, time.last()? - time.first()?);
        let off: Vec<[f64; 1]> = radius.iter().map(|radius| [(radius - arm) / arm]).collect();
        let circle: Vec<(f64, f64)> = angle.iter().map(|angle| angle.sin_cos()).collect();
        let rows = |settling: Option<f64>, shrinks: bool| -> Vec<[f64; UNKNOWNS]> {
            let row = |k: usize| {
                let (sin, cos) = circle[k];
                let gone = settling.map_or(0.0, |own| levelling(time[k] - start, own));
                let fast = if shrinks { speed[k] } else { 0.0 };
                let late = 2.0 * fast * acceleration[k];
                [1.0, cos, sin, gone * cos, gone * sin, fast * fast, late]
            };
            (0..angle.len()).map(row).collect()
        };
        let all = vec![1.0; off.len()];
        let level = Blocks::new(&rows(None, false), &off, &all);
        let rests = Rests::new(angle, step / arm, level.sums()?.variance()?.sqrt());
        let (off, worth) = (rests.whitened(off), rests.worth(all));
        let blocks = |settling, shrinks| {
            let rows = rests.whitened(rows(settling, shrinks));
            Blocks::new(&rows, &off, &worth)
        };
        let criterion = |own: &Blocks, more| {
            let told = own.sums().and_then(|own| own.criterion(more));
            told.unwrap_or(f64::INFINITY)
        };
        let [round, shrunk] = [false, true].map(|shrinks| blocks(None, shrinks));
        let shrinks = criterion(&shrunk, SHRINKAGE) < criterion(&round, 0);
        let still = if shrinks { shrunk } else { round };
        let drift = levelled(duration, |settling| {
            criterion(&blocks(Some(settling), shrinks), DRIFT)
        });
        let (sums, left_out) = match drift.1 < criterion(&still, 0) {
            true => blocks(Some(drift.0), shrinks).told()?,
            false => still.told()?,
        };
        let (deviation, freedom) = jackknife(&left_out);
        let radius = Radius {
            seen: arm * (1.0 + sums.solved()?[0]),
            std: arm * deviation,
            freedom,
        };
        Some(Self { sums, arm, radius })
    }

    /// Whether the radius supports an exact lever arm against one that is off by a millimetre in a metre.
    fn arm_is_exact(&self) -> bool {
        let off = (self.radius.seen - self.arm) / self.radius.std;
        let loose = (KNOWN_TO * self.arm).hypot(self.radius.std) / self.radius.std;
        loose * (-0.5 * off * off).exp() > ODDS
    }

    /// Knowledge of (offset, `c_x / R`, `c_y / R`), as rows of a least-squares problem.
    pub(super) fn witness(&self) -> Vec<(Vec<f64>, f64)> {
        let normal = self.sums.normal;
        let exact = self.arm_is_exact();
        // If R is free, its row and column are eliminated.
        let schur = |i: usize, j: usize| match exact {
            true => normal[(i, j)],
            false => normal[(i, j)] - normal[(i, 0)] * normal[(0, j)] / normal[(0, 0)],
        };
        let right = |i: usize| match exact {
            true => self.sums.right[i],
            false => self.sums.right[i] - normal[(i, 0)] * self.sums.right[0] / normal[(0, 0)],
        };
        let normal = nalgebra::Matrix2::new(schur(1, 1), schur(1, 2), schur(2, 1), schur(2, 2));
        let Some(inverse) = normal.try_inverse() else {
            return Vec::new();
        };
        let centre = inverse * Vector2::new(right(1), right(2));
        let Some(variance) = self.sums.variance() else {
            return Vec::new();
        };
        let Some(root) = (normal / variance).cholesky() else {
            return Vec::new();
        };
        let l = root.l().transpose();
        let row = |i: usize| {
            let value = l[(i, 0)] * centre.x + l[(i, 1)] * centre.y;
            (vec![0.0, l[(i, 0)], l[(i, 1)]], value)
        };
        (0..2).map(row).collect()
    }
}

/// The standard deviation of an estimate and its degrees of freedom, from its values without each of the blocks and the
/// variances that white noise adds to it thereby.
fn jackknife(left_out: &[[f64; 2]]) -> (f64, f64) {
    let count = left_out.len() as f64;
    let mean = left_out.iter().map(|[one, _]| one).sum::<f64>() / count;
    let scatter: f64 = left_out.iter().map(|[one, _]| (one - mean).powi(2)).sum();
    let shares = left_out.iter().map(|[_, variance]| variance);
    let freedom = shares.clone().sum::<f64>().powi(2) / shares.map(|v| v * v).sum::<f64>();
    ((scatter * (count - 1.0) / count).sqrt(), freedom)
}

/// The rate at which a drift levels off that gives the least criterion, and that, by golden section between the neighbours of
/// the best of some rates.
fn levelled(duration: f64, criterion: impl Fn(f64) -> f64) -> (f64, f64) {
    let rates = SETTLING.map(|share| share / duration);
    let all = rates.map(&criterion);
    let order = |a: &usize, b: &usize| all[*a].total_cmp(&all[*b]);
    let best = (0..all.len()).min_by(order).unwrap_or(0);
    let neighbours = [
        rates[best.saturating_sub(1)],
        rates[(best + 1).min(all.len() - 1)],
    ];
    let refined = golden_section(criterion, neighbours, SECTIONS);
    match refined.1 < all[best] {
        true => refined,
        false => (rates[best], all[best]),
    }
}

/// The unknowns of the frame along the arc: the angle of its zero, and the circle's centre.
pub(super) fn frame_columns(angle: &[f64]) -> Vec<Vec<f64>> {
    let sine = angle.iter().map(|a| -a.sin()).collect();
    let cosine = angle.iter().map(|a| a.cos()).collect();
    vec![vec![1.0; angle.len()], sine, cosine]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;
    use statrs::distribution::{ContinuousCDF, StudentsT};
    use std::f64::consts::PI;

    const NOISE: f64 = 1e-5;

    /// How many deviations the rows of the witness are off for a frame that drifts by `by` in all.
    fn off(by: [f64; 2], settling: f64, seed: u64) -> [f64; 2] {
        let centre = [2e-4, -3e-4];
        let mut random = StdRng::seed_from_u64(seed);
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * 2e-3).collect();
        let angle: Vec<f64> = time.iter().map(|t| 0.8 * (1.3 * t).sin()).collect();
        let whole = levelling(8.0, settling);
        let radius = time.iter().zip(&angle).map(|(t, angle)| {
            let gone = levelling(*t, settling) / whole;
            let at = |k: usize| centre[k] + by[k] * gone;
            let noise: f64 = random.sample(StandardNormal);
            1.0 + at(0) * angle.cos() + at(1) * angle.sin() + NOISE * noise
        });
        let radius: Vec<f64> = radius.collect();
        let still = vec![0.0; time.len()];
        let own = Circle::new(&time, [&angle, &radius], [&still; 2], 1.0, 0.0).unwrap();
        off_centre(&own, centre)
    }

    /// How many deviations the rows of the witness are off for a centre.
    fn off_centre(own: &Circle, [x, y]: [f64; 2]) -> [f64; 2] {
        let off = own.witness().into_iter();
        let off: Vec<f64> = off
            .map(|(row, value)| value - row[1] * x - row[2] * y)
            .collect();
        [off[0], off[1]]
    }

    /// A tracker whose coordinates lag sees a smaller circle while the tip is fast. Its centre is where it is none the less, as
    /// is the radius at rest. Without the square of the speed the mean is 265.
    #[test]
    fn the_centre_that_a_lagging_tracker_sees_is_where_it_is() {
        let (lag, step) = (0.01, 2e-3);
        // Moves and rests of a second each.
        let at = |t: f64| {
            let moved = (t % 2.0).clamp(0.0, 1.0);
            0.6 * (t.max(0.0) / 2.0).floor() + 0.3 * (1.0 - (PI * moved).cos())
        };
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * step).collect();
        // As the clocks are registered, by the lag.
        let seen = |t: f64, back: f64| at(t - lag + back * step);
        let speed = time
            .iter()
            .map(|&t| (seen(t, 1.0) - seen(t, -1.0)) / (2.0 * step));
        let speed: Vec<f64> = speed.collect();
        let bend = |t: f64| seen(t, 1.0) - 2.0 * seen(t, 0.0) + seen(t, -1.0);
        let acceleration: Vec<f64> = time.iter().map(|&t| bend(t) / (step * step)).collect();
        let mut random = StdRng::seed_from_u64(5);
        let mut squares = 0.0;
        for _ in 0..40 {
            let centre = [0, 1].map(|_| 1e-4 * random.sample::<f64, _>(StandardNormal));
            let [mut x, mut y] = [1.0, 0.0];
            let (mut angle, mut radius) = (Vec::new(), Vec::new());
            for t in &time {
                for part in 1..=20 {
                    let there = at(t - step + step * f64::from(part) / 20.0);
                    x += step / 20.0 / lag * (there.cos() - x);
                    y += step / 20.0 / lag * (there.sin() - y);
                }
                let [x, y] = [x + centre[0], y + centre[1]];
                angle.push(y.atan2(x));
                radius.push(x.hypot(y) + NOISE * random.sample::<f64, _>(StandardNormal));
            }
            let motion = [&speed[..], &acceleration];
            let own = Circle::new(&time, [&angle, &radius], motion, 1.0, 0.0).unwrap();
            squares += off_centre(&own, centre)
                .map(|off| off * off)
                .iter()
                .sum::<f64>();
            assert!((own.radius.seen - 1.0).abs() < 6.0 * own.radius.std);
        }
        let mean = squares / 80.0;
        assert!((0.5..2.0).contains(&mean), "{mean}");
    }

    /// Whitened errors of the centre are about standard normal whether the frame is still or drifts. They leave out how well the
    /// rate of the drift is known.
    #[test]
    fn the_centre_of_a_frame_that_drifts_is_that_at_the_start() {
        for (by, settling) in [([0.0, 0.0], 0.0), ([3e-4, -2e-4], 0.0), ([3e-4, 2e-4], 0.4)] {
            let squares = (0..40).map(|seed| {
                let [first, second] = off(by, settling, seed);
                first.powi(2) + second.powi(2)
            });
            let mean = squares.sum::<f64>() / 80.0;
            assert!((0.5..2.0).contains(&mean), "{by:?} at {settling}: {mean}");
        }
    }

    /// Whitened errors of the centre are about standard normal where the tip mostly rests and its coordinates are rounded,
    /// whatever noise they have. With the samples of a rest for independent ones the first of these means is 620.
    #[test]
    fn the_centre_of_coordinates_that_are_rounded_is_known_as_well_as_told() {
        let mut random = StdRng::seed_from_u64(7);
        for noise in [0.0, 0.15, 0.3, 2.0] {
            let step = 1e-4;
            let squares = (0..40).map(|_| {
                let places: Vec<f64> = (0..9).map(|_| random.random_range(-0.8..0.8)).collect();
                let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
                let tip = time.iter().map(|t| {
                    let (from, to) = (places[(2.0 * t) as usize], places[(2.0 * t) as usize + 1]);
                    let angle = from + (to - from) * ((2.0 * t).fract() * 5.0).min(1.0);
                    let mut seen = |place: f64| {
                        let noise: f64 = noise * step * random.sample::<f64, _>(StandardNormal);
                        ((place + noise) / step).round() * step
                    };
                    [seen(angle.cos()), seen(angle.sin())]
                });
                let (angle, radius): (Vec<f64>, Vec<f64>) =
                    tip.map(|[x, y]| (y.atan2(x), y.hypot(x))).unzip();
                let still = vec![0.0; time.len()];
                let found = Circle::new(&time, [&angle, &radius], [&still; 2], 1.0, step).unwrap();
                found
                    .witness()
                    .iter()
                    .map(|(_, off)| off * off)
                    .sum::<f64>()
            });
            let mean = squares.sum::<f64>() / 80.0;
            assert!((0.5..2.0).contains(&mean), "{noise}: {mean}");
        }
    }

    /// One move between two rests tells the radius by a few blocks alone. Its error over its deviation is then Student's t of
    /// few degrees of freedom: one of a thousand recordings is beyond the quantile of one in a thousand.
    #[test]
    fn the_radius_of_one_move_is_known_to_few_degrees_of_freedom() {
        let mut random = StdRng::seed_from_u64(11);
        let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 3e-3).collect();
        let angle = time.iter().map(|t| 0.5 * ((t - 1.0) / 0.7).clamp(0.0, 1.0));
        let angle: Vec<f64> = angle.collect();
        let beyond = (0..3000).filter(|_| {
            let radius = angle.iter().map(|angle| {
                let noise: f64 = random.sample(StandardNormal);
                1.0 + 2e-4 * angle.cos() - 3e-4 * angle.sin() + NOISE * noise
            });
            let radius: Vec<f64> = radius.collect();
            let still = vec![0.0; time.len()];
            let found = Circle::new(&time, [&angle, &radius], [&still; 2], 1.0, 0.0)
                .unwrap()
                .radius;
            assert!((2.0..10.0).contains(&found.freedom), "{found:?}");
            let t = StudentsT::new(0.0, 1.0, found.freedom).unwrap();
            (found.seen - 1.0).abs() > t.inverse_cdf(0.9995) * found.std
        });
        // Three deviations beyond a count of three. It is 19 with as many degrees of freedom as for a motion that lasts.
        assert!(beyond.count() <= 8);
    }
}
