//! Whether what drives a mode on during its decay is too small to have made its start.
//!
//! What works on a machine keeps its modes in vibration, and their amplitude falls by chance now and then. The complex amplitude
//! `A` of a mode that decays by its law `a` goes over half a period to `A' = A a' / a + w`; what drives it makes `w`, of the
//! variance `q` in each part. With `S = sum (a_k / a_0)^2` this keeps up `E |A|^2 = 2 q S`. The number of times in which `|A|^2` of
//! what is kept up rises beyond `b` times its mean is Poisson's, with the mean `2 s D b e^-b` over a time `D`, where `s` is the
//! rate. So a start beyond the `b` of one time in a thousand was excited, and then let go.
//!
//! Kalman's filter gives the likelihood of each `q`, whatever the noise of the sensor. A mode is let go where a `q` that does not
//! explain its start is more likely, by very strong evidence, than each that does. What its law does not describe of a true decay
//! is noise, too, but small beside the start. Further modes of the fit at the same line of the spectrum are paid for, by the
//! Bayesian criterion: they describe a driven mode, too.
//!
//! Sources: R. E. Kalman, J. Basic Engineering 82 (1960); D. Aldous, Probability Approximations via the Poisson Clumping
//! Heuristic, Springer (1989), chapter D; R. E. Kass and A. E. Raftery, J. American Statistical Association 90 (1995).

use super::course::{Course, courses};
use super::damped::{Damped, Fit, Segment, coefficients};
use super::level::ABOUT;
use quell_signal::STRONG;
use std::f64::consts::TAU;

/// Probability with which what is kept up may rise to the start by chance.
const BY_CHANCE: f64 = 1e-3;
/// Variances `q` that are tried, over the least one that explains the start: powers of 2. A course of a start of 1 with a `q` 1e-8
/// times that is free by all that a sensor shows.
const DRIVEN: std::ops::RangeInclusive<i32> = -24..=8;
/// Variances of the sensor's noise that are tried, over that without any `q`, which is the greatest: powers of 4.
const NOISE: std::ops::RangeInclusive<i32> = -12..=0;

/// Whether a mode of a fit is let go at the start of its decays, in a recording of some duration, s.
pub fn is_let_go(fit: &Fit, segments: &[Segment], own: &Damped, duration: f64) -> bool {
    let seconds = |segment: &Segment| segment.period * segment.values.nrows() as f64;
    let longest = segments.iter().map(seconds).fold(0.0, f64::max);
    let about = (TAU * ABOUT / longest).max(own.rate);
    let is_beside =
        |other: &Damped| other != own && (other.frequency - own.frequency).abs() < about;
    let Some(linear) = coefficients(segments, &fit.modes) else {
        return false;
    };
    let all = (fit, segments, &linear[..]);
    let alone = courses(all, own, &|_| true);
    let with = courses(all, own, &|other| !is_beside(other));
    let (Some(alone), Some(with)) = (alone, with) else {
        return false;
    };
    let beside: Vec<&Damped> = fit.modes.iter().filter(|other| is_beside(other)).collect();
    let count = alone.iter().map(Course::count).sum::<usize>() as f64;
    // With the two of its amplitude.
    let unknowns = |mode: &Damped| (mode.unknowns() + 2) as f64;
    let paid: f64 = beside.iter().map(|mode| unknowns(mode)).sum();
    let start = alone.iter().map(|course| course.start).fold(0.0, f64::max);
    let explains = explains(own, &alone, start, duration);
    let [let_go, kept_up] = likelihoods(&alone, start, explains);
    let kept_up = kept_up.max(likelihoods(&with, start, explains)[1]);
    let free = 1.0 - unknowns(own) / count;
    (let_go - kept_up) * free - paid * count.ln() > STRONG
}

/// The least `q` that keeps up the start.
fn explains(own: &Damped, courses: &[Course], start: f64, duration: f64) -> f64 {
    let sum = courses
        .iter()
        .map(|course| course.kept_up(own))
        .fold(1.0, f64::max);
    let span = courses.first().map_or(0.0, |course| course.span);
    // Of a rate `s` the sum is `1 / (1 - e^(-2 s T))`.
    let rate = -(-1.0 / sum).ln_1p() / (2.0 * span);
    let many = (2.0 * rate * duration / BY_CHANCE).max(std::f64::consts::E);
    // The iteration contracts by `1 / b`.
    let rises = (0..20).fold(many.ln(), |b, _| (many * b).ln());
    start / (2.0 * sum * rises)
}

/// Twice the logarithms of the greatest likelihoods: of a `q` below this one, and of one that is not.
fn likelihoods(courses: &[Course], start: f64, explains: f64) -> [f64; 2] {
    let most = noise_alone(courses) + f64::EPSILON.powi(2) * start;
    let mut best = [f64::NEG_INFINITY; 2];
    for noise in NOISE.map(|power| most * 4.0_f64.powi(power)) {
        for power in DRIVEN {
            let score = likelihood(courses, start, [explains * 2.0_f64.powi(power), noise]);
            let place = &mut best[usize::from(power >= 0)];
            *place = place.max(score);
        }
    }
    best
}

/// Mean square of what the law alone leaves of the amplitudes: the variance of the sensor's noise where nothing drives.
fn noise_alone(courses: &[Course]) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for course in courses {
        let law = course.law();
        let power: f64 = law.iter().map(|own| own * own).sum();
        for part in &course.amplitudes {
            let along: f64 = law.iter().zip(part).map(|(own, value)| own * value).sum();
            let left = law
                .iter()
                .zip(part)
                .map(|(own, value)| value - own * along / power);
            squares += left.map(|value| value * value).sum::<f64>();
            count += part.len() as f64;
        }
    }
    squares / f64::max(count, 1.0)
}

/// Twice the logarithm of the likelihood of `q` and the variance of the sensor's noise, by Kalman's filter; of the start no more
/// is known than its size.
///
/// What drives goes on during the half period over which an amplitude is a mean: as of a random walk, the mean has a third of `q`
/// more than its start, and half of it in common with its end.
fn likelihood(courses: &[Course], start: f64, [driven, noise]: [f64; 2]) -> f64 {
    let mut twice = 0.0;
    for course in courses {
        for part in &course.amplitudes {
            let (mut at, mut unsure) = (0.0, start);
            for (value, fall) in part.iter().zip(&course.falls) {
                let variance = unsure + noise + driven / 3.0;
                let innovation = value - at;
                let gain = fall * (unsure + driven / 2.0) / variance;
                at = fall * at + gain * innovation;
                unsure = fall * fall * (unsure + driven) - gain * gain * variance;
                twice -= innovation * innovation / variance + variance.ln();
            }
        }
    }
    twice
}
