//! Likenesses of effects that no motion distinguishes, and the remedies.

/// A way in which effects are alike in every motion, those with the narrower meaning first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likeness {
    /// In the link's motion a mode of the base and one of a second link differ by their frequency only.
    Resonance,
    /// A mode far above the motion bends in proportion to the first one.
    Flexibility,
    /// A function of the pose alone.
    Pose,
    /// A shift in time to first order, as by a lag, a delay and drag.
    ShiftInTime,
    /// The difference shows at rest and at the lowest speeds.
    LowSpeed,
}

/// All of them; if effects share several, the first one counts.
pub const LIKENESSES: &[Likeness] = &[
    Likeness::Resonance,
    Likeness::Flexibility,
    Likeness::Pose,
    Likeness::ShiftInTime,
    Likeness::LowSpeed,
];

impl Likeness {
    /// Advice on how to distinguish effects that are alike in this way: a change of payload, mounting or
    /// sensor.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Resonance => "a sensor on the base, which a second mode of the arm leaves still",
            Self::Flexibility => {
                "faster motion, or an accelerometer beside the sensor: a mode shows at its own frequency, a gain \
                 does not"
            }
            Self::Pose => {
                "turning the axis' mounting, which gravity does not follow, or remounting the sensor, whose \
                 errors go with it"
            }
            Self::ShiftInTime => {
                "a common trigger for all clocks, which leaves no offset free, or another payload, which drag \
                 depends on and a lag does not"
            }
            Self::LowSpeed => {
                "slower and smaller motion than was recorded, seen by a sensor of less noise"
            }
        }
    }
}
