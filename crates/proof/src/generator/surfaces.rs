//! Things that rub, stick and knock: laws of forces with corners or memory.

/// Dry friction: it holds up to a breakaway force and slides against a kinetic one.
#[derive(Clone, Copy, Debug)]
pub struct DryFriction {
    /// Kinetic force for sliding up and down.
    pub kinetic: [f64; 2],
    /// Breakaway over kinetic force, at least 1.
    pub breakaway: f64,
    /// Velocity over which the one falls to the other.
    pub stribeck_velocity: f64,
    /// Depth and waves per position of a friction that changes along the way.
    pub waves: [f64; 2],
}

impl DryFriction {
    /// Friction of one size.
    pub fn coulomb(force: f64) -> Self {
        Self {
            kinetic: [force; 2],
            breakaway: 1.0,
            stribeck_velocity: 1.0,
            waves: [0.0; 2],
        }
    }

    fn side(&self, sign: f64, position: f64) -> f64 {
        let force = if sign > 0.0 {
            self.kinetic[0]
        } else {
            self.kinetic[1]
        };
        force * (1.0 + self.waves[0] * (self.waves[1] * position).sin())
    }

    /// Force while sliding with this speed (at least 0) in the direction of `sign`, against it.
    pub fn sliding(&self, sign: f64, speed: f64, position: f64) -> f64 {
        let fall = (-(speed / self.stribeck_velocity).powi(2)).exp();
        -sign * self.side(sign, position) * (1.0 + (self.breakaway - 1.0) * fall)
    }

    /// By how much a holding force is too great, and where the surfaces then slide to.
    pub fn excess(&self, holding: f64, position: f64) -> (f64, f64) {
        let direction = -holding.signum();
        let limit = self.breakaway * self.side(direction, position);
        (holding.abs() - limit, direction)
    }
}

/// Bristles that bend before they slide: `z' = v - |v| z / g(v)` with Stribeck's `g` (LuGre; Dahl
/// without the second and third parameter).
///
/// Source: Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Trans. Automatic Control 40 (1995).
#[derive(Clone, Copy, Debug)]
pub struct Bristles {
    /// Force per deflection.
    pub stiffness: f64,
    /// Force per rate of deflection.
    pub damping: f64,
    /// Kinetic force.
    pub kinetic: f64,
    /// Breakaway over kinetic force.
    pub breakaway: f64,
    /// Stribeck velocity.
    pub stribeck_velocity: f64,
}

impl Bristles {
    /// Rate of the mean deflection `z` at slip velocity `v`.
    pub fn rate(&self, z: f64, v: f64) -> f64 {
        let fall = (-(v / self.stribeck_velocity).powi(2)).exp();
        let level = self.kinetic * (1.0 + (self.breakaway - 1.0) * fall);
        v - v.abs() * self.stiffness * z / level
    }

    /// Force against the motion.
    pub fn force(&self, z: f64, v: f64) -> f64 {
        self.stiffness * z + self.damping * self.rate(z, v)
    }
}

/// Hysteresis of a spring: `z' = A x' - beta |x'| |z|^(n-1) z - gamma x' |z|^n` with `n = 1`.
///
/// Source: Y.-K. Wen, J. Engineering Mechanics Division 102 (1976).
#[derive(Clone, Copy, Debug)]
pub struct BoucWen {
    /// Force per deflection for small loops.
    pub stiffness: f64,
    /// Width of the loop, 1 / position.
    pub beta: f64,
    /// Shape of the loop, 1 / position.
    pub gamma: f64,
}

impl BoucWen {
    /// Rate of the hysteretic deflection.
    pub fn rate(&self, z: f64, v: f64) -> f64 {
        v - self.beta * v.abs() * z - self.gamma * v * z.abs()
    }
}

/// Play between teeth: the spring is loose within `half` on either side.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Half of the play.
    pub half: f64,
    /// Damping within the play over the damping in contact: oil.
    pub oil: f64,
}

impl Gap {
    /// Compression of the teeth (0 within the play) and whether they touch.
    pub fn compression(&self, x: f64) -> (f64, bool) {
        match x {
            x if x > self.half => (x - self.half, true),
            x if x < -self.half => (x + self.half, true),
            _ => (0.0, false),
        }
    }
}

/// Play whose edges are round: `x + (|x - h, r| - |x + h, r|) / 2` with `|a, r| = sqrt(a^2 + r^2)` is bent.
#[derive(Clone, Copy, Debug)]
pub struct RoundedGap {
    /// Half of the play, `h`.
    pub half: f64,
    /// Radius of the edges, `r`.
    pub radius: f64,
    /// Damping within the play over the damping in contact: oil.
    pub oil: f64,
}

impl RoundedGap {
    /// Compression of the teeth, and its slope: the share of the teeth that touch.
    pub fn compression(&self, x: f64) -> (f64, f64) {
        let [inner, outer] = [x - self.half, x + self.half];
        let [near, far] = [inner.hypot(self.radius), outer.hypot(self.radius)];
        let share = 1.0 + 0.5 * (inner / near - outer / far);
        (x + 0.5 * (near - far), share)
    }
}

/// A rubber stop beyond which the link is pushed back: `k p (1 + d p')`, never pulled.
///
/// Source: K. H. Hunt, F. R. E. Crossley, J. Applied Mechanics 42 (1975), with exponent 1.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// Where it stands.
    pub position: f64,
    /// Force per penetration.
    pub stiffness: f64,
    /// Dissipation, s per position.
    pub dissipation: f64,
}

impl Stop {
    /// Force on the link.
    pub fn force(&self, position: f64, velocity: f64) -> f64 {
        let depth = position - self.position;
        if depth <= 0.0 {
            return 0.0;
        }
        -(self.stiffness * depth * (1.0 + self.dissipation * velocity)).max(0.0)
    }
}

/// A knock: half a sine of force.
#[derive(Clone, Copy, Debug)]
pub struct Knock {
    /// When it begins, s.
    pub start: f64,
    /// How long it lasts, s.
    pub length: f64,
    /// Its greatest force.
    pub force: f64,
}

impl Knock {
    /// Force at a time.
    pub fn at(&self, time: f64) -> f64 {
        let share = (time - self.start) / self.length;
        if (0.0..=1.0).contains(&share) {
            self.force * (std::f64::consts::PI * share).sin()
        } else {
            0.0
        }
    }
}
