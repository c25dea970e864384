//! Cubic stiffness.

use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Part of the nominal stiffness at which softening ends.
const SOFTEST: f64 = 0.1;

struct Cubic {
    k3: f64,
    /// Deformation beyond which the spring is straight.
    straight: f64,
}

impl Cubic {
    fn new(k3: f64) -> Self {
        let straight = match k3 < 0.0 {
            true => ((1.0 - SOFTEST) / (-3.0 * k3)).sqrt(),
            false => f64::INFINITY,
        };
        Self { k3, straight }
    }
}

impl Force for Cubic {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        let curved = x.clamp(-self.straight, self.straight);
        let beyond = 3.0 * self.k3 * curved * curved * (x - curved);
        motion.stiffness * (self.k3 * curved * curved * curved + beyond)
    }
}

/// A spring that hardens or softens with the square of its deformation: `F = k (x + k3 x^3)`.
///
/// Softening ends where a tenth of the stiffness is left; from there on the spring is straight, as no
/// spring lets go altogether.
pub const CUBIC_STIFFNESS: Effect = Effect {
    name: "cubic_stiffness",
    title: "cubic stiffness",
    places: &[Place::Transmission],
    physics: "The spring force is F = k (x + k3 x^3). Teeth, bearings and harmonic drives harden (k3 > 0) as \
        more of them carry; buckling parts soften. The frequency of free vibration of amplitude A \
        shifts by a factor 1 + 3/8 k3 A^2. Softening ends where a tenth of the stiffness is left. \
        Source: Duffing, Erzwungene Schwingungen bei veraenderlicher \
        Eigenfrequenz (1918); Tuttle and Seering, IEEE Trans. Robotics and Automation 12 (1996).",
    remedy: "Shape for the frequency at the amplitude that is worked with; it shifts with the size \
        of the move.",
    parameters: &[Parameter {
        name: "k3",
        role: ParameterRole::Size,
        quantity: Quantity::new(0, -2, 0),
        // The spring keeps a positive slope over the motion: 1 + 3 k3 x^2 > 0.
        bounds: |scales| {
            let unit = scales.deformation.powi(-2);
            (-0.33 * unit, 10.0 * unit)
        },
        neutral: 0.0,
        typical: |scales| 0.2 * scales.deformation.powi(-2),
    }],
    properties: &[Property::Slot(Slot::Spring)],
    law: |p| Law::Force(Box::new(Cubic::new(p[0]))),
    starts: |scales| {
        let unit = scales.deformation.powi(-2);
        [-0.2, -0.05, 0.05, 0.2, 0.8, 2.5]
            .map(|size| vec![size * unit])
            .to_vec()
    },
};
