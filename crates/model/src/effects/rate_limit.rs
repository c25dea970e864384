//! A drive whose output cannot change fast.

use super::grid::sizes;
use super::{Drive, Effect, Law, Parameter, ParameterRole, Place, Property, Quantity};

struct RateLimit {
    rate: f64,
}

impl Drive for RateLimit {
    fn run(&self, time: &[f64], values: &mut [f64]) {
        if self.rate > 0.0 {
            for k in 1..values.len() {
                let most = self.rate * (time[k] - time[k - 1]);
                values[k] = values[k - 1] + (values[k] - values[k - 1]).clamp(-most, most);
            }
        }
    }

    fn is_static(&self) -> bool {
        false
    }
}

/// The input, followed no faster than `R`: `|z'| <= R`. A rate of 0 stands for no limit.
pub const RATE_LIMIT: Effect = Effect {
    name: "rate_limit",
    title: "rate limit",
    places: &[Place::Drive],
    physics: "The drive follows its input exactly while that changes more slowly than R, and with the \
        rate R until it has caught up otherwise: a current against its inductance, a servo against \
        its speed limit. Source: Duda, AIAA J. Guidance, Control, and Dynamics 20 (1997).",
    remedy: "Lower speed or jerk until the command stays below the limit of rate.",
    parameters: &[Parameter {
        name: "rate",
        role: ParameterRole::Size,
        quantity: Quantity::commanded(1, -1),
        bounds: |scales| (0.0, 100.0 * scales.input * scales.natural_frequency),
        neutral: 0.0,
        typical: |scales| 0.3 * scales.input * scales.natural_frequency,
    }],
    properties: &[Property::ManyMinima],
    law: |p| Law::Drive(Box::new(RateLimit { rate: p[0] })),
    starts: |scales| {
        let unit = scales.input * scales.natural_frequency;
        sizes(
            unit,
            [15.0, 5.0, 2.0, 1.0, 0.5, 0.25, 0.12, 0.06, 0.03, 0.01],
        )
    },
};
