//! Presliding friction after Dahl, and after Canudas de Wit and others (LuGre).

use super::coulomb_friction::COULOMB_FRICTION;
use super::grid::product;
use super::shared_parameters::{EXCESS, FRICTION, STRIBECK_VELOCITY};
use super::stribeck_friction::STRIBECK_FRICTION;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity, Slot, Zone,
};

struct Bristles {
    friction: f64,
    distance: f64,
    excess: f64,
    stribeck_velocity: f64,
    time_constant: f64,
}

impl Bristles {
    /// Deflection at which they slide with a velocity: 1 without a Stribeck curve.
    fn level(&self, v: f64) -> f64 {
        if self.excess == 0.0 {
            return 1.0;
        }
        let ratio = v / self.stribeck_velocity;
        1.0 + self.excess * (-ratio * ratio).exp()
    }

    /// Bristles' relative deflection `z` after a step in one direction: `dz/dx = (s - z / g) / x_s`, `s` the sense of the motion.
    fn deflection(&self, x: f64, v: f64, memory: &Memory) -> f64 {
        let travel = x - memory.position;
        let (sense, way) = (travel.signum(), travel.abs() / self.distance);
        let levels = self.levels(memory.states[0], v);
        relaxed(memory.state, sense, way, levels)
    }

    /// Levels at the start of a step, in the middle of its way and at its end. Where the acceleration is constant, the square of
    /// the velocity is linear over the way.
    fn levels(&self, from: f64, to: f64) -> [f64; 3] {
        let middle = (0.5 * (from * from + to * to)).sqrt();
        [from, middle, to].map(|v| self.level(v))
    }

    /// Rate of the deflection, as a share of the velocity.
    fn yielding(&self, v: f64, z: f64) -> f64 {
        1.0 - v.signum() * z / self.level(v)
    }
}

/// The deflection after a way, in presliding distances, with the levels at its start, middle and end: with `de = dw / g` the
/// equation is `dz/de = s g - z`, solved for a level that is quadratic in `e`. Exact for a constant level.
fn relaxed(before: f64, sense: f64, way: f64, [from, middle, to]: [f64; 3]) -> f64 {
    if from == to {
        return before + (sense * from - before) * -(-way / from).exp_m1();
    }
    let [first, second, third] = [from, middle, to].map(f64::recip);
    let rate = way * (first + 4.0 * second + third) / 6.0;
    if rate < SMALL {
        return before + rate * (sense * from - before);
    }
    // Share of `e` on the first half of the way.
    let half = way * (5.0 * first + 8.0 * second - third) / (24.0 * rate);
    let curved = ((middle - from) / half - (to - from)) / (half - 1.0);
    let slope = to - from - curved;
    let decay = -(-rate).exp_m1();
    let lag = 1.0 - decay / rate;
    let level = slope * lag + curved * (1.0 - 2.0 * lag / rate);
    before + (sense * from - before) * decay + sense * level
}

/// Ways over which a changing level is constant in floating point: the square of the rate is lost beside 1.
const SMALL: f64 = 1e-8;

impl Force for Bristles {
    fn force(&self, _motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64 {
        let z = self.deflection(x, v, memory);
        let rate = v * self.yielding(v, z) / self.distance;
        self.friction * (z + self.time_constant * rate)
    }

    fn remember(&self, motion: &Motion, x: f64, v: f64, memory: &mut Memory) {
        memory.state = self.deflection(x, v, memory);
        memory.states[0] = v;
        (memory.position, memory.time) = (x, motion.time);
    }

    fn switch(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> Option<f64> {
        (self.friction > 0.0).then_some(v)
    }

    /// That of Stribeck friction of the same curve.
    fn zone(&self) -> Option<Zone> {
        (self.excess > 0.0).then_some(Zone {
            until: 3.0 * self.stribeck_velocity,
            step: 0.5 * self.stribeck_velocity,
        })
    }

    fn stiffness(&self, v: f64, memory: &Memory) -> f64 {
        self.friction / self.distance * self.yielding(v, memory.state).max(0.0)
    }
}

/// Friction that builds up over a distance: `dF/dx = (F_c - F sign x') / x_s`, and with what LuGre's bristles have besides.
pub const PRESLIDING_HYSTERESIS: Effect = Effect {
    name: "presliding_hysteresis",
    title: "presliding hysteresis",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Asperities bend like bristles before they slide: after each reversal the force goes from \
        one side to the other over a distance x_s, F = F_c z, dz/dx = (1 - z sign x' / g) / x_s. Small motion sees \
        a spring with a loop, large motion Coulomb friction. Dahl's bristles have g = 1 and do not depend on speed. Those of the \
        LuGre model slide as Stribeck friction does, g = 1 + excess exp(-(v / v_s)^2), and are damped while they bend, \
        F = F_c (z + T dz/dt). Source: \
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
        Parameter {
            // A smaller one is within the shape of any friction.
            bounds: |_| (0.01, 5.0),
            ..EXCESS
        },
        Parameter {
            neutral: 0.0,
            ..STRIBECK_VELOCITY
        },
        Parameter {
            name: "bristle_time_constant",
            role: ParameterRole::Shape,
            quantity: Quantity::TIME,
            // The stiffest bristles vibrate at 31 times the mode: their damping ratio is at most 4.
            bounds: |scales| (2e-5 * scales.period(), 0.04 * scales.period()),
            neutral: 0.0,
            typical: |scales| 3e-3 * scales.period(),
        },
    ],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Contains(&STRIBECK_FRICTION),
        Property::Vanish(&["excess", "stribeck_velocity"]),
        Property::Vanish(&["bristle_time_constant"]),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Hysteresis),
    ],
    law: |p| {
        Law::Force(Box::new(Bristles {
            friction: p[0],
            distance: p[1].max(f64::MIN_POSITIVE),
            excess: p[2],
            stribeck_velocity: p[3].max(f64::MIN_POSITIVE),
            time_constant: p[4],
        }))
    },
    starts: |scales| {
        let friction = [0.015, 0.06, 0.25].map(|size| size * scales.force);
        let distance = [0.02, 0.08, 0.25, 0.8].map(|size| size * scales.deformation);
        let velocity = (STRIBECK_VELOCITY.typical)(scales);
        let bent = 3e-3 * scales.period();
        product(&[&friction, &distance, &[0.5], &[velocity], &[bent]])
    },
};
