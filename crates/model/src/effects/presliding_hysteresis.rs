//! Presliding friction after Dahl.

use super::coulomb_friction::COULOMB_FRICTION;
use super::grid::product;
use super::shared_parameters::FRICTION;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity, Slot,
};

struct Dahl {
    friction: f64,
    distance: f64,
}

impl Dahl {
    /// Bristles' relative deflection `z` in [-1, 1]: `dz/dx = (1 - s z) / x_s`, `s` the sense of the
    /// motion. Exact for a step in one direction.
    fn deflection(&self, x: f64, memory: &Memory) -> f64 {
        let travel = x - memory.position;
        let relaxed = -(-travel.abs() / self.distance).exp_m1();
        memory.state + (travel.signum() - memory.state) * relaxed
    }
}

impl Force for Dahl {
    fn force(&self, _motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        self.friction * self.deflection(x, memory)
    }

    fn advance(&self, _motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        self.deflection(x, memory)
    }

    fn switch(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> Option<f64> {
        (self.friction > 0.0).then_some(v)
    }

    fn stiffness(&self, v: f64, memory: &Memory) -> f64 {
        self.friction / self.distance * (1.0 - v.signum() * memory.state)
    }
}

/// Friction that builds up over a distance: `dF/dx = (F_c - F sign x') / x_s`.
pub const PRESLIDING_HYSTERESIS: Effect = Effect {
    name: "presliding_hysteresis",
    title: "presliding hysteresis",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Asperities bend like bristles before they slide: after each reversal the force goes from \
        one side to the other over a distance x_s, dF/dx = (F_c - F sign x') / x_s. Small motion sees \
        a spring with a loop, large motion Coulomb friction. It does not depend on speed. Source: \
        Dahl, A solid friction model, Aerospace Corp. TOR-0158(3107-18)-1 (1968); Canudas de Wit, \
        Olsson, Astrom, Lischinsky, IEEE Trans. Automatic Control 40 (1995).",
    remedy: "Expect lost motion at each reversal; approach a target from one side, or compensate \
        with a bristle model.",
    parameters: &[
        FRICTION,
        Parameter {
            name: "presliding_distance",
            role: ParameterRole::Shape,
            quantity: Quantity::POSITION,
            // Shorter distances are Coulomb friction: of the typical size its bristles vibrate at 7 times the mode.
            bounds: |scales| (1e-3 * scales.deformation, 3.0 * scales.deformation),
            neutral: 1.0,
            typical: |scales| 0.1 * scales.deformation,
        },
    ],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Hysteresis),
    ],
    law: |p| {
        Law::Force(Box::new(Dahl {
            friction: p[0],
            distance: p[1].max(f64::MIN_POSITIVE),
        }))
    },
    starts: |scales| {
        let friction = [0.015, 0.06, 0.25].map(|size| size * scales.force);
        let distance = [0.02, 0.08, 0.25, 0.8].map(|size| size * scales.deformation);
        product(&[&friction, &distance])
    },
};
