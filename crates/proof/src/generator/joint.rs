//! A flexible joint and all that may be wrong with it.

use super::laws::Laws;
use super::surfaces::{BoucWen, Bristles, DryFriction, Gap, Knock, RoundedGap, Stop};

/// A body on a spring and a damper.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Its inertia.
    pub inertia: f64,
    /// Torque per angle.
    pub stiffness: f64,
    /// Torque per rate.
    pub damping: f64,
}

/// A pendulum on the link that swings far: a hanging hose.
#[derive(Clone, Copy, Debug)]
pub struct Hose {
    /// Its angular frequency, rad/s.
    pub frequency: f64,
    /// Its damping ratio.
    pub damping_ratio: f64,
    /// Mass times both lengths over the link's inertia.
    pub share: f64,
    /// The arm's length over the hose's.
    pub length_ratio: f64,
}

/// A filter in the sensor, of gain 1; time constants in s.
#[derive(Clone, Copy, Debug)]
pub enum Lag {
    /// `T s' + s = y`.
    First {
        /// `T`.
        time_constant: f64,
    },
    /// `T^2 s'' + 2 d T s' + s = y`.
    Second {
        /// `T`.
        time_constant: f64,
        /// `d`.
        damping_ratio: f64,
    },
}

/// The joint with what is hidden in it; absent or 0 where nothing is.
#[derive(Clone, Debug, Default)]
pub struct Joint {
    /// Inertia of the link about the joint.
    pub inertia: f64,
    /// Torque per deformation.
    pub stiffness: f64,
    /// Torque per rate of deformation.
    pub damping: f64,
    /// Friction across the transmission, or in the link's bearing.
    pub dry: Option<DryFriction>,
    /// Whether it is in the link's bearing.
    pub dry_bearing: bool,
    /// Torque and speed `v_0` of a bearing's friction of the size `tanh(v / v_0)`.
    pub creeping_bearing: [f64; 2],
    /// Presliding friction across the transmission.
    pub bristles: Option<Bristles>,
    /// Hysteretic spring across the transmission.
    pub hysteresis: Option<BoucWen>,
    /// Play in series with the spring.
    pub gap: Option<Gap>,
    /// Play whose edges are round.
    pub rounded_gap: Option<RoundedGap>,
    /// The spring's torque is `k (x + cubic x^3 + fifth x^5)`.
    pub cubic: f64,
    /// See [`cubic`](Self::cubic).
    pub fifth: f64,
    /// Coefficient `c` and power `p` of a further torque `k c |x|^p`, which has the same sign on both sides.
    pub even: [f64; 2],
    /// Deflection `d` of a spring of torque `k d atan(x / d)`; 0 for a straight one.
    pub softening: f64,
    /// Relative change of stiffness beyond a knee for `x > 0` and for `x < 0`, and the knee.
    pub bilinear: [f64; 3],
    /// Torque per squared rate of deformation.
    pub quadratic_damping: f64,
    /// Damping gained per squared deformation.
    pub bent_damping: f64,
    /// Torque per root of the rate of deformation.
    pub root_damping: f64,
    /// Amplitude, waves per rad and phase of an error of the transmission.
    pub ripple: [f64; 3],
    /// The same of further waves of that error; only beside a ripple.
    pub harmonics: Vec<[f64; 3]>,
    /// The stiffness changes by the first entry, with the second as time constant, s.
    pub warming: [f64; 2],
    /// Stiffness and time constant, s, of a spring and a dashpot in series beside the joint's spring.
    pub creep: Option<[f64; 2]>,
    /// Relative stiffness gained per motor speed, s/rad.
    pub speed_stiffening: f64,
    /// Depth and angular frequency of a damping that comes and goes.
    pub damping_waves: [f64; 2],
    /// Torque per speed of the link, to ground.
    pub viscous_drag: f64,
    /// Torque per squared speed of the link, to ground.
    pub quadratic_drag: f64,
    /// Torque `g sin(y + phase)` of gravity.
    pub gravity: [f64; 2],
    /// Relative change of the inertia with pose, `1 + a sin(y + phase)`.
    pub pose: [f64; 2],
    /// Time at which a load is taken up, s, and its inertia over the link's.
    pub payload: Option<[f64; 2]>,
    /// A further body on the link, and whether the tip is on it.
    pub outer: Option<(Body, bool)>,
    /// The body that the motor stands on.
    pub base: Option<Body>,
    /// A hose that swings.
    pub hose: Option<Hose>,
    /// A stop in the link's way.
    pub stop: Option<Stop>,
    /// Knocks on the link.
    pub knocks: Vec<Knock>,
    /// Amplitude, angular frequency and phase of a torque that shakes the link steadily.
    pub shaking: [f64; 3],
    /// How the sensor lags.
    pub lag: Option<Lag>,
    /// Laws that no textbook names: across the transmission, and pulling at the link.
    pub laws: Laws,
}

impl Joint {
    /// What the spring's torque has beside `k (x + cubic x^3)`, over `k`.
    pub fn uneven_spring(&self, x: f64) -> f64 {
        let mut torque = self.fifth * x.powi(5);
        let [coefficient, power] = self.even;
        if coefficient != 0.0 {
            torque += coefficient * x.abs().powf(power);
        }
        if self.softening != 0.0 {
            torque += self.softening * (x / self.softening).atan() - x;
        }
        torque
    }
}

/// The motion that the sensor sees, by the body that it is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// The link's angle.
    Link,
    /// The link's angle less the motor side's.
    Deformation,
}
