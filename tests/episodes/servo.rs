//! Two servos that a hand shows their way, at 30 samples a second: the first has dry friction, the drive of the second is late.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

/// Samples a second, and of an episode.
pub const RATE: f64 = 30.0;
pub const SAMPLES: usize = 600;
/// Gains of the servos: position 1/s, velocity kg.m^2/s; their inertia is 1.
const GAINS: [f64; 2] = [12.0, 40.0];
const NOISE: f64 = 2e-4;
/// How late the second joint's drive is, s; friction of the first one's.
const LATE: f64 = 0.08;
const FRICTION: f64 = 3.0;

/// Command of a joint, rad: what a hand shows it, held over a sample.
fn command(joint: usize, time: f64) -> f64 {
    let held = (time.max(0.0) * RATE + 1e-9).floor() / RATE;
    let parts = [(0.30, 0.21), (0.22, 0.37), (0.13, 0.83)];
    let each = parts.iter().map(|(size, hertz)| {
        size * (1.0 - (TAU * hertz * held * (1.0 + 0.1 * joint as f64)).cos())
    });
    each.sum()
}

/// State of a joint: a servo with dry friction, or with a drive that is late.
fn states(joint: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
    let (fine, [position_gain, velocity_gain]) = (100, GAINS);
    let dt = 1.0 / (RATE * fine as f64);
    let (friction, late) = [(FRICTION, 0.0), (0.0, LATE)][joint];
    let (mut x, mut v, mut seen) = (0.0_f64, 0.0_f64, Vec::new());
    for k in 0..SAMPLES {
        seen.push((x + NOISE * random.sample::<f64, _>(StandardNormal)) as f32);
        for step in 0..fine {
            let wanted = command(joint, k as f64 / RATE + step as f64 * dt - late);
            let force = velocity_gain * (position_gain * (wanted - x) - v);
            let sticks = v == 0.0 && force.abs() <= friction;
            let rubbing = friction * if v == 0.0 { force.signum() } else { v.signum() };
            let next = v + dt * if sticks { 0.0 } else { force - rubbing };
            // Friction brakes; it does not turn a motion round.
            v = if friction > 0.0 && next * v < 0.0 {
                0.0
            } else {
                next
            };
            x += dt * v;
        }
    }
    seen
}

/// States and commands of both joints over two episodes, the second after the first.
pub fn episodes() -> Vec<[f32; 4]> {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut rows = Vec::new();
    for _ in 0..2 {
        let [first, second] = [0, 1].map(|joint| states(joint, &mut random));
        for k in 0..SAMPLES {
            let [one, other] = [0, 1].map(|joint| command(joint, k as f64 / RATE) as f32);
            rows.push([first[k], second[k], one, other]);
        }
    }
    rows
}

/// The model of both, without what they hide.
pub fn servo() -> String {
    let [position, velocity] = GAINS;
    format!(
        "kind = \"rigid_axis\"\ninput_hold = \"zero_order\"\nmass = {{ value = 1.0, fixed = true }}\nviscous = 0.0\n\
         position_gain = {position}\nvelocity_gain = {velocity}\n"
    )
}

/// Checks that a diagnosis names the delay of the second joint's drive, or the same of its sensor.
pub fn names_the_delay(told: &serde_json::Value) {
    let finding = &told["findings"][0];
    assert!(
        ["drive_delay", "sensor_delay"].contains(&finding["effect"].as_str().unwrap()),
        "{finding}"
    );
    let delay = finding["parameters"][0]["value"].as_f64().unwrap();
    assert!((delay / LATE - 1.0).abs() < 0.02, "{finding}");
}
