//! A drive that follows its input with a first-order lag.

use super::cubic::with_slopes;
use super::grid::sizes;
use super::sensor_lag::first_order;
use super::{Drive, Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity};

struct Lag {
    time_constant: f64,
}

impl Drive for Lag {
    fn run(&self, time: &[f64], values: &mut [f64]) {
        if self.time_constant > 0.0 {
            let mut curve = with_slopes(time, values);
            first_order(self.time_constant, time, &mut curve, None);
            for (value, point) in values.iter_mut().zip(&curve) {
                *value = point[0];
            }
        }
    }

    fn is_static(&self) -> bool {
        false
    }
}

/// First-order lag `T z' + z = u` of the drive.
pub const DRIVE_LAG: Effect = Effect {
    name: "drive_lag",
    title: "drive lag",
    places: &[Place::Drive],
    physics: "The loop that makes the current, or the servo that follows the command, answers as T z' + \
        z = u. The axis gets the slow part of its input T later and little of what is faster than \
        1 / T. Source: Leonhard, Control of Electrical Drives (2001), chapter 7.",
    remedy: "Put the lag into the model of the drive, or raise the bandwidth of the inner loop.",
    parameters: &[Parameter {
        name: "time_constant",
        role: ParameterRole::Size,
        quantity: Quantity::TIME,
        bounds: |scales| (0.0, 3.0 * scales.period()),
        neutral: 0.0,
        typical: |scales| 0.05 * scales.period(),
    }],
    properties: &[Property::Alike(Likeness::ShiftInTime)],
    law: |p| {
        Law::Drive(Box::new(Lag {
            time_constant: p[0],
        }))
    },
    starts: |scales| sizes(scales.period(), [0.005, 0.02, 0.06, 0.15, 0.4, 1.0]),
};
