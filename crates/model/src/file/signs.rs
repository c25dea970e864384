//! What physics allows a parameter in a file.

use crate::effects::{Parameter, Scales, Visited};

/// The signs that physics allows a parameter, whatever the motion's scales are.
pub fn signs(parameter: &Parameter) -> (f64, f64) {
    let (low, high) = (parameter.bounds)(&Scales {
        deformation: 1.0,
        deformation_rate: 1.0,
        position: (-1.0, 1.0),
        velocity: 1.0,
        acceleration: 1.0,
        force: 1.0,
        input: 1.0,
        natural_frequency: 1.0,
        damping_ratio: 0.1,
        span: (0.0, 1.0),
        sample_time: 0.01,
        candidate_events: Vec::new(),
        candidate_frequencies: Vec::new(),
        candidate_orders: Vec::new(),
        candidate_stops: Vec::new(),
        forced: false,
        tracked: false,
        rigid: false,
        visited: Visited::default(),
    });
    (
        if low >= 0.0 { 0.0 } else { -f64::MAX },
        if high <= 0.0 { 0.0 } else { f64::MAX },
    )
}
