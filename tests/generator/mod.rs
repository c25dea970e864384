//! Exact responses of one mode to jerk-limited moves, for tests and benches; shares no code with
//! the estimators.

use std::f64::consts::TAU;

use quell::estimators::Sample;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// A stretch of constant jerk.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub start: f64,
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub jerk: f64,
}

/// A move from rest to rest; it begins at `start` and moves the motor side by `amplitude`.
pub fn jerk_limited_move(
    start: f64,
    duration: f64,
    jerk_time: f64,
    amplitude: f64,
) -> Vec<Segment> {
    let half = 0.5 * duration;
    let edges = [
        (0.0, 1.0),
        (jerk_time, 0.0),
        (half - jerk_time, -1.0),
        (half + jerk_time, 0.0),
        (duration - jerk_time, 1.0),
        (duration, 0.0),
    ];
    let mut segments = vec![Segment {
        start: f64::MIN,
        position: 0.0,
        velocity: 0.0,
        acceleration: 0.0,
        jerk: 0.0,
    }];
    let mut last = Segment {
        start,
        position: 0.0,
        velocity: 0.0,
        acceleration: 0.0,
        jerk: 0.0,
    };
    for (time, jerk) in edges {
        last = Segment {
            start: start + time,
            jerk,
            ..at(&last, start + time)
        };
        segments.push(last);
    }
    let scale = amplitude / last.position;
    for segment in &mut segments {
        segment.position *= scale;
        segment.velocity *= scale;
        segment.acceleration *= scale;
        segment.jerk *= scale;
    }
    segments
}

fn at(segment: &Segment, time: f64) -> Segment {
    let t = time - segment.start;
    let Segment {
        position,
        velocity,
        acceleration,
        jerk,
        ..
    } = *segment;
    Segment {
        start: time,
        position: position + t * (velocity + t * (acceleration / 2.0 + t * jerk / 6.0)),
        velocity: velocity + t * (acceleration + t * jerk / 2.0),
        acceleration: acceleration + t * jerk,
        jerk,
    }
}

/// The mode that is to be found.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub frequency_hz: f64,
    pub damping_ratio: f64,
    /// Damper across the joint (else to ground).
    pub across: bool,
}

/// Deformation and its rate after `t`, on a stretch whose forcing is `b0 + b1 t + b2 t^2`.
fn advance(truth: &Truth, state: [f64; 2], force: [f64; 3], t: f64) -> [f64; 2] {
    let w = TAU * truth.frequency_hz;
    let decay = truth.damping_ratio * w;
    let wd = (w * w - decay * decay).sqrt();
    let p2 = force[2] / (w * w);
    let p1 = (force[1] - 4.0 * decay * p2) / (w * w);
    let p0 = (force[0] - 2.0 * decay * p1 - 2.0 * p2) / (w * w);
    let x = state[0] - p0;
    let v = state[1] - p1;
    let (sin, cos) = (wd * t).sin_cos();
    let e = (-decay * t).exp();
    let b = (v + decay * x) / wd;
    let free = e * (x * cos + b * sin);
    let rate = e * (v * cos - (decay * v + w * w * x) / wd * sin);
    [free + p0 + t * (p1 + t * p2), rate + p1 + 2.0 * t * p2]
}

/// Noise-free samples of a joint at rest that makes the moves of `segments`.
pub fn respond(truth: &Truth, segments: &[Segment], times: &[f64]) -> Vec<Sample> {
    let w = TAU * truth.frequency_hz;
    let ground = if truth.across {
        0.0
    } else {
        2.0 * truth.damping_ratio * w
    };
    let mut state = [0.0, 0.0];
    let mut index = 0;
    let mut begin = segments[1].start;
    let mut samples = Vec::with_capacity(times.len());
    let force = |from: &Segment| {
        [
            -from.acceleration - ground * from.velocity,
            -from.jerk - ground * from.acceleration,
            -ground * from.jerk / 2.0,
        ]
    };
    for &time in times {
        while index + 1 < segments.len() && segments[index + 1].start <= time {
            if index > 0 {
                let from = segments[index];
                state = advance(
                    truth,
                    state,
                    force(&from),
                    segments[index + 1].start - begin,
                );
            }
            index += 1;
            begin = segments[index].start;
        }
        let segment = &segments[index];
        let deformation = if index == 0 {
            0.0
        } else {
            advance(truth, state, force(segment), time - begin)[0]
        };
        let motor_position = if index == 0 {
            0.0
        } else {
            at(segment, time).position
        };
        samples.push(Sample {
            time,
            motor_position,
            deformation,
        });
    }
    samples
}

/// Stamps at a rate, in Hz.
pub fn stamps(rate_hz: f64, duration: f64) -> Vec<f64> {
    (0..(duration * rate_hz).round() as usize)
        .map(|k| k as f64 / rate_hz)
        .collect()
}

/// Adds Gaussian noise to the deformation.
pub fn add_noise(samples: &mut [Sample], std: f64, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let Ok(normal) = Normal::new(0.0, std) else {
        return;
    };
    for sample in samples {
        sample.deformation += normal.sample(&mut random);
    }
}
