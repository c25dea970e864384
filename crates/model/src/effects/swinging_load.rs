//! A load that hangs on the link and swings far.

use super::base_mode::BASE_MODE;
use super::grid::{frequencies_between, frequency_bounds, product};
use super::second_mode::SECOND_MODE;
use super::shared_parameters::DAMPING_RATIO;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity,
};

/// Angular frequency of a load that hangs on one centimetre, rad/s; none hangs on less.
const FASTEST: f64 = 31.0;

/// That of one that hangs on 2.5 m, rad/s.
const SLOWEST: f64 = 2.0;

/// Largest angle of the pendulum's phase in a step of its integration, at which the classical method is exact to 1e-5.
const RADIANS_A_STEP: f64 = 0.2;

/// Most such steps, for frequencies that no pendulum has.
const MOST: f64 = 1e3;

struct Pendulum {
    mass_ratio: f64,
    natural_frequency: f64,
    damping_ratio: f64,
    /// Angle for a unit of the scaled deflection `phi`.
    angle: f64,
}

impl Pendulum {
    /// `sin(a phi) / a` and `cos(a phi)`.
    fn lever(&self, phi: f64) -> [f64; 2] {
        match self.angle == 0.0 {
            true => [phi, 1.0],
            false => {
                let (sin, cos) = (self.angle * phi).sin_cos();
                [sin / self.angle, cos]
            }
        }
    }

    /// Rate of the deflection, and the acceleration that brings it back.
    fn rate_and_return(&self, p: f64, v: f64, [sin, cos]: [f64; 2]) -> [f64; 2] {
        let (w, rate) = (self.natural_frequency, p - v * cos);
        [rate, w * w * sin + 2.0 * self.damping_ratio * w * rate]
    }

    /// Rates of deflection and momentum `p = phi' + v cos(a phi)` while the link moves with `v`. The momentum spares the
    /// link's acceleration.
    fn rates(&self, [phi, p]: [f64; 2], v: f64) -> [f64; 2] {
        let lever = self.lever(phi);
        let [rate, back] = self.rate_and_return(p, v, lever);
        [rate, -back - self.angle * self.angle * v * rate * lever[0]]
    }

    /// Deflection and momentum at a time, the link's speed being linear within the step.
    fn at(&self, time: f64, v: f64, memory: &Memory) -> [f64; 2] {
        let [phi, p, before, ..] = memory.states;
        let span = (time - memory.time).max(0.0);
        let parts = (self.natural_frequency * span / RADIANS_A_STEP)
            .ceil()
            .min(MOST);
        let (h, change) = (span / parts, (v - before) / parts);
        let ahead =
            |[phi, p]: [f64; 2], rates: [f64; 2], h: f64| [phi + h * rates[0], p + h * rates[1]];
        let step = |state, part| {
            let speed = |share: f64| before + change * (part as f64 + share);
            let first = self.rates(state, speed(0.0));
            let second = self.rates(ahead(state, first, 0.5 * h), speed(0.5));
            let third = self.rates(ahead(state, second, 0.5 * h), speed(0.5));
            let fourth = self.rates(ahead(state, third, h), speed(1.0));
            let slope = |k: usize| (first[k] + 2.0 * (second[k] + third[k]) + fourth[k]) / 6.0;
            ahead(state, [slope(0), slope(1)], h)
        };
        (0..parts as usize).fold([phi, p], step)
    }
}

impl Force for Pendulum {
    fn force(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64 {
        self.load(motion, x, v, memory)[0]
    }

    fn load(&self, motion: &Motion, _x: f64, v: f64, memory: &Memory) -> [f64; 2] {
        if self.mass_ratio == 0.0 {
            return [0.0; 2];
        }
        let [phi, p] = self.at(motion.time, v, memory);
        let [sin, cos] = self.lever(phi);
        let [rate, back] = self.rate_and_return(p, v, [sin, cos]);
        let squared = self.angle * self.angle;
        let inertia = self.mass_ratio * motion.inertia;
        let load = [
            -inertia * (back * cos + squared * rate * rate * sin),
            inertia * squared * sin * sin,
        ];
        // A load that whirls faster than any step resolves is no pendulum.
        match load.iter().all(|own| own.is_finite()) {
            true => load,
            false => [0.0; 2],
        }
    }

    /// Deflection, momentum and the link's speed in [`Memory::states`]. The load hangs straight before the motion.
    fn remember(&self, motion: &Motion, x: f64, v: f64, memory: &mut Memory) {
        let [phi, p] = match memory.state == 0.0 {
            true => [0.0, v],
            false => self.at(motion.time, v, memory),
        };
        (memory.states[0], memory.states[1], memory.states[2]) = (phi, p, v);
        (memory.state, memory.position, memory.time) = (1.0, x, motion.time);
    }
}

/// A pendulum on the link: `phi'' = -w^2 sin(th) / a - 2 xi w phi' - y'' cos(th)`, `th = a phi`.
pub const SWINGING_LOAD: Effect = Effect {
    name: "swinging_load",
    title: "swinging load",
    places: &[Place::Link],
    physics: "A hose, a cable or a load on a hook hangs on the link and swings so far that it is no linear pendulum: \
        th'' + 2 xi w th' + w^2 sin(th) = -a y'' cos(th). a = w^2 tilt is the link's lever over the string's length. With M = \
        mass_ratio times the link's inertia, the load pulls the link with M (th'^2 sin(th) - (th'' + a y'' cos(th)) cos(th)) / a, \
        and adds M sin(th)^2 to its inertia, since it is dragged along its string. Small swings are those of a second mode. \
        Source: Abdel-Rahman, Nayfeh and Masoud, J. Vibration and Control 9 (2003); Singhose, Kim and Kenison, ASME J. \
        Dynamic Systems, Measurement, and Control 130 (2008).",
    remedy: "Tie the hose or the load to the arm; else shape for the pendulum's frequency as well.",
    parameters: &[
        Parameter {
            name: "mass_ratio",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.1,
        },
        Parameter {
            name: "natural_frequency",
            role: ParameterRole::Frequency,
            quantity: Quantity::FREQUENCY,
            bounds: |scales| {
                let lowest = frequency_bounds(scales).0.min(SLOWEST);
                (lowest, FASTEST)
            },
            neutral: 1.0,
            typical: |_| 2.0 * SLOWEST,
        },
        DAMPING_RATIO,
        Parameter {
            // The angle at which the load hangs behind a link of unit acceleration: its lever over gravity.
            name: "tilt",
            role: ParameterRole::Shape,
            quantity: Quantity::new(0, -1, 2),
            bounds: |scales| (0.0, 10.0 / scales.acceleration),
            neutral: 0.0,
            typical: |scales| 1.0 / scales.acceleration,
        },
    ],
    properties: &[
        Property::Contains(&SECOND_MODE),
        Property::Contains(&BASE_MODE),
        Property::Alike(Likeness::Resonance),
    ],
    law: |p| {
        Law::Force(Box::new(Pendulum {
            mass_ratio: p[0],
            natural_frequency: p[1],
            damping_ratio: p[2],
            angle: p[1] * p[1] * p[3],
        }))
    },
    starts: |scales| {
        let frequencies = frequencies_between(scales, (SLOWEST, FASTEST), 6);
        let swings = [0.1, 1.0].map(|angle: f64| {
            // A swing of some angle is slower than a small one, by a sixteenth of its square (Landau and Lifshitz, Mechanics,
            // section 11).
            let small = 1.0 / (1.0 - angle * angle / 16.0);
            let frequencies = frequencies.iter().map(|own| (small * own).min(FASTEST));
            let frequencies: Vec<f64> = frequencies.collect();
            product(&[
                &[0.1],
                &frequencies,
                &[0.05],
                &[angle / scales.acceleration],
            ])
        });
        swings.concat()
    },
};
