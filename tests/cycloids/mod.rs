//! Moves without a jump of the acceleration, each with rest after it.

use std::f64::consts::TAU;

/// Position and velocity at an instant (s) of moves, each of a start (s), a duration (s) and a way.
pub fn cycloids(all: &[(f64, f64, f64)], t: f64) -> [f64; 2] {
    let (mut position, mut velocity) = (0.0, 0.0);
    for &(start, duration, way) in all {
        let s = ((t - start) / duration).clamp(0.0, 1.0);
        position += way * (s - (TAU * s).sin() / TAU);
        velocity += way / duration * (1.0 - (TAU * s).cos());
    }
    [position, velocity]
}
