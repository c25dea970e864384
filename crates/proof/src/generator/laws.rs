//! Laws that no textbook names: a force over position, a damping near one place, a friction of any power,
//! sliders in parallel. A joint has them and an axis has them.

use super::integrate::State;

/// Most sliders beside each other.
pub const SLIDERS: usize = 4;

/// A place towards which something is pulled: `-depth s exp((1 - s^2) / 2)` with `s = (x - place) / width`.
#[derive(Clone, Copy, Debug)]
pub struct Detent {
    /// Greatest force, one width from the place.
    pub depth: f64,
    /// The place.
    pub place: f64,
    /// Its width.
    pub width: f64,
}

/// A damper that acts near one place: `height exp(-s^2 / 2) v`.
#[derive(Clone, Copy, Debug)]
pub struct Bell {
    /// Force per rate in the place.
    pub height: f64,
    /// The place.
    pub place: f64,
    /// Its width.
    pub width: f64,
}

/// Friction that grows with a power of the rate: `c v (v^2 + e^2)^((n - 1) / 2)`, linear well below `e`.
#[derive(Clone, Copy, Debug)]
pub struct PowerFriction {
    /// `c`.
    pub coefficient: f64,
    /// `n`.
    pub power: f64,
    /// `e`.
    pub linear_below: f64,
}

/// A spring and a damper side by side that slide together when their force exceeds a level:
/// `f = clamp(k z + c v, -level, level)`, `c z' = f - k z`.
///
/// One is Coulomb's friction over a contact with compliance; several, with little damping, are the
/// elements of Maxwell's slip model.
///
/// Source: W. D. Iwan, J. Applied Mechanics 33 (1966), with a damper in each element.
#[derive(Clone, Copy, Debug)]
pub struct Slider {
    /// `k`.
    pub stiffness: f64,
    /// `c / k`, s; above 0.
    pub time_constant: f64,
    /// The level.
    pub level: f64,
}

/// All of these that are hidden in one machine.
#[derive(Clone, Debug, Default)]
pub struct Laws {
    /// A place that attracts.
    pub detent: Option<Detent>,
    /// A damper near one place.
    pub local_damper: Option<Bell>,
    /// Friction of any power.
    pub power_friction: Option<PowerFriction>,
    /// Sliders; no more than [`SLIDERS`].
    pub sliders: Vec<Slider>,
    /// Waves of a force over the position: amplitude, waves per position, phase.
    pub waves: Vec<[f64; 3]>,
}

impl Detent {
    fn force(&self, position: f64) -> f64 {
        let s = (position - self.place) / self.width;
        -self.depth * s * (0.5 * (1.0 - s * s)).exp()
    }
}

impl Bell {
    fn force(&self, position: f64, rate: f64) -> f64 {
        let s = (position - self.place) / self.width;
        self.height * (-0.5 * s * s).exp() * rate
    }
}

impl PowerFriction {
    fn force(&self, rate: f64) -> f64 {
        let speed = rate.hypot(self.linear_below);
        self.coefficient * rate * speed.powf(self.power - 1.0)
    }
}

impl Slider {
    fn force(&self, z: f64, rate: f64) -> f64 {
        let held = self.stiffness * (z + self.time_constant * rate);
        held.clamp(-self.level, self.level)
    }

    fn rate(&self, z: f64, rate: f64) -> f64 {
        (self.force(z, rate) / self.stiffness - z) / self.time_constant
    }
}

impl Laws {
    /// Force against a rate at a position, with the sliders' deflections from this state on.
    pub fn against(&self, position: f64, rate: f64, deflections: &[f64]) -> f64 {
        let damper = self.local_damper.map_or(0.0, |d| d.force(position, rate));
        let friction = self.power_friction.map_or(0.0, |law| law.force(rate));
        let sliders = self.sliders.iter().zip(deflections);
        damper + friction + sliders.map(|(s, z)| s.force(*z, rate)).sum::<f64>()
    }

    /// Rates of the sliders' deflections, into a state from this place on.
    pub fn slide(&self, rate: f64, state: &State, first: usize, rates: &mut State) {
        for (k, slider) in self.sliders.iter().enumerate() {
            rates[first + k] = slider.rate(state[first + k], rate);
        }
    }

    /// Force of a position.
    pub fn pull(&self, position: f64) -> f64 {
        let detent = self.detent.map_or(0.0, |detent| detent.force(position));
        let wave = |[size, waves, phase]: &[f64; 3]| size * (waves * position + phase).sin();
        detent + self.waves.iter().map(wave).sum::<f64>()
    }

    /// The longest step that follows all sliders, s: half their time constant.
    pub fn longest_step(&self) -> f64 {
        let constants = self.sliders.iter().map(|slider| 0.5 * slider.time_constant);
        constants.fold(f64::INFINITY, f64::min)
    }
}
