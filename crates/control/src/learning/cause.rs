//! What makes a mode's frequency change along the way.
//!
//! `w^2 = k / J` is the same whether the stiffness `k` or the inertia `J` changes; the motion is not. Lagrange's
//! equation of a link `l` on a spring, with the motor side `u`, is
//! ```text
//! J l'' + J' l'^2 / 2 + d (l' - u') + k (l - u) = 0
//! ```
//! so that an inertia that changes pushes with `-J' l'^2 / (2 J) = (d ln w / du) l'^2`, and a stiffness does not.
//! Neither has an unknown that the other lacks. The likelihood of the moves decides between them: it is a
//! property of the arm, so that the evidence of the moves adds up.

/// What changes along the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The stiffness: the inertia is constant.
    Stiffness,
    /// The inertia, as of an arm that folds: the stiffness is constant.
    Inertia,
}

impl Cause {
    /// The more likely cause by a logarithm of odds, and the other one. At even odds a description of the inertia decides, and without
    /// one the stiffness, which needs no velocity.
    pub fn by_odds(odds: f64, is_described: bool) -> (Self, Self) {
        let inertia = odds > 0.0 || (odds == 0.0 && is_described);
        match inertia {
            true => (Self::Inertia, Self::Stiffness),
            false => (Self::Stiffness, Self::Inertia),
        }
    }

    /// 1 for the inertia, -1 for the stiffness.
    pub fn sign(self) -> f64 {
        match self {
            Self::Stiffness => -1.0,
            Self::Inertia => 1.0,
        }
    }
}
