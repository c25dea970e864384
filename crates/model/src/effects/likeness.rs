//! How effects look alike that no motion tells apart, and what would tell them.

/// A way in which effects look alike in every motion, those with the narrower meaning first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likeness {
    /// Seen from the link, a base that rings and a second link that rings differ by their frequency only.
    Resonance,
    /// Far above the motion a mode bends with the first one.
    Flexibility,
    /// A function of the pose alone.
    Pose,
    /// To first order a shift in time, as a lag, a delay and drag are.
    ShiftInTime,
    /// The difference shows at rest and at the lowest speeds.
    LowSpeed,
}

/// All of them; what several have in common is told by the first.
pub const LIKENESSES: &[Likeness] = &[
    Likeness::Resonance,
    Likeness::Flexibility,
    Likeness::Pose,
    Likeness::ShiftInTime,
    Likeness::LowSpeed,
];

impl Likeness {
    /// Advice that tells effects apart that are alike in this way: a change of payload, mounting or sensor.
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
