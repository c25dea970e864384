//! Arms and programmes at random.

use super::plant::{Faults, PlantMode};
use super::programme::Programme;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// An arm of one to three modes that follow pose and payload, with the faults of joints and sensors, and ten moves.
pub fn programme(seed: u64) -> Programme {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut any = |low: f64, high: f64| random.random_range(low..high);
    let first = any(5.0, 14.0);
    let count = any(1.0, 4.0) as usize;
    // Up to 40 % over the range of a radian, in a bend or evenly.
    let (slope, bend) = match any(0.0, 1.0) {
        x if x < 0.4 => (0.0, 0.0),
        _ => (any(-0.25, 0.25), any(-0.15, 0.15)),
    };
    let load = any(0.0, 1.0);
    let modes = (0..count).map(|k| PlantMode {
        hertz: first * [1.0, any(1.6, 2.6), any(3.0, 4.0)][k],
        damping: any(0.01, 0.08),
        participation: if k == 0 { 1.0 } else { any(0.2, 1.0) },
        slope: slope * any(0.5, 1.0),
        bend: bend * any(0.5, 1.0),
        folds: false,
        payload: load * any(0.5, 1.0),
    });
    let modes: Vec<PlantMode> = modes.collect();
    // Each fault is there in one of three.
    let mut fault = |most: f64| {
        if any(0.0, 1.0) < 0.33 {
            any(0.0, most)
        } else {
            0.0
        }
    };
    let faults = Faults {
        friction: fault(200e-6),
        backlash: fault(100e-6),
        spikes: fault(0.01),
        lost: fault(0.05),
        lag: fault(3e-3),
        resolution: fault(20e-6),
        noise: 3e-6 + fault(50e-6),
    };
    let changes = any(0.0, 1.0) < 0.5;
    let declared = any(0.0, 1.0) < 0.5;
    let mut payload = 0.0;
    let mut position: f64 = 0.0;
    let moves = (0..10).map(|k| {
        if changes && k % 3 == 2 {
            payload = any(0.0, 1.0);
        }
        let mut target = any(0.0, 1.0);
        while (target - position).abs() < 0.15 {
            target = any(0.0, 1.0);
        }
        position = target;
        (target, payload)
    });
    let moves = moves.collect();
    Programme {
        name: format!(
            "seed {seed}: {count} modes, slope {slope:.2} {bend:.2}, {} payload, {faults:?}",
            if !changes {
                "no"
            } else if declared {
                "declared"
            } else {
                "unknown"
            }
        ),
        modes,
        faults,
        belief_hz: first * any(0.75, 1.25),
        shaper: ["zv", "zvd", "optimal"][any(0.0, 3.0) as usize],
        start: 0.0,
        moves,
        declared: f64::from(declared),
        inertia: None,
        seed,
    }
}
