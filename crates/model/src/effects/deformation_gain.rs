//! A sensor that sees more or less of the deformation than the link's end has.

use super::grid::sizes;
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Reading, Sensor,
};

struct Participation {
    error: f64,
}

impl Sensor for Participation {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value + self.error * (reading.value - reading.motor)
    }
}

/// The sensor shows `u + (1 + g) (y - u)`.
pub const DEFORMATION_GAIN: Effect = Effect {
    name: "deformation_gain",
    title: "deformation gain",
    places: &[Place::Sensor],
    physics: "The place that the sensor looks at takes another part in the mode than the model's link: of \
        the deformation it shows 1 + g times as much, of rigid motion just what there is. A strain \
        gauge of wrong factor does the same. Source: Ewins, Modal Testing (2000), chapter 2.",
    remedy: "The sensor sees another share of the mode than believed: check where it is mounted, \
        and the lever arm.",
    parameters: &[Parameter {
        name: "error",
        role: ParameterRole::Size,
        quantity: Quantity::NUMBER,
        bounds: |_| (-0.9, 5.0),
        neutral: 0.0,
        typical: |_| 0.1,
    }],
    properties: &[
        Property::OfDeformationOnly,
        Property::Alike(Likeness::Flexibility),
        Property::Alike(Likeness::Pose),
    ],
    law: |p| Law::Sensor(Box::new(Participation { error: p[0] })),
    starts: |_| sizes(1.0, [-0.2, 0.2]),
};
