//! How far the link moves for each unit that the motor side moves, from rest to rest or in motion.

use super::rest::{Motion, RestRule, phases};
use super::two_sides::{Series, unwrapped};
use quell_recording::{Channel, Recording, Role, plain};

/// Degrees in a radian.
const DEGREES: f64 = 180.0 / core::f64::consts::PI;
/// How far a ratio may be from a mistake's, relatively, and still be told as that: a tenth, as far as a scale or a lever
/// arm may be wrong.
const NEAR: f64 = 0.1;
/// Share of a ratio that its standard deviation may be at most: three of them stay within [`NEAR`].
pub(super) const CERTAIN: f64 = NEAR / 3.0;
/// Factor from which a ratio is no error of a scale: what the catalogue's effects do to a static gain stays below it (a load of
/// gravity some percent, a sensor's gain a tenth as a rule).
pub(super) const FAR: f64 = 2.0;
/// Share of a rest at its end whose mean is taken. The mean of half the samples has `sqrt(2)` times the deviation of that of all, and what
/// vibrates has fallen there to the square root of what the whole rest leaves of it, or less.
const SETTLED: f64 = 0.5;
/// Lowest number of samples of the link in a rest: from four on the standard deviation of their variance, `sqrt(2 / (n - 1))` of it, is
/// below the variance.
const FEWEST: usize = 4;

/// The slope of the link's position over that of the motor side, both at rest or in slow motion.
///
/// A joint at rest is not deformed by its motion, however elastic it is: the slope is 1 for sensors that both measure
/// the joint's motion. A load that depends on the pose changes it by the sag, a few percent. Without two rests the
/// slope is the gain of the link's law ([`Gain`](super::ratio_in_motion::Gain)), which motion below the mode shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticRatio {
    /// The slope.
    pub ratio: f64,
    /// One standard deviation of it: the scatter about the line, or that within the rests if it is larger.
    pub std: f64,
    /// Where the motor side's motion is from.
    pub motor_side: Role,
    /// Whether it is from motion, as there are no two rests.
    pub is_in_motion: bool,
}

/// What is wrong with the sensors of a link that does not go as far as its motor side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mistake {
    /// One of the two counts in the other direction.
    Sign,
    /// The link's numbers are degrees that are called radians, in which direction.
    DegreesOfLink(f64),
    /// The motor side's numbers are degrees that are called radians, in which direction.
    DegreesOfMotorSide(f64),
    /// A gear's ratio, or a unit.
    Scale,
}

impl StaticRatio {
    /// The ratio of a recording. `None` without a `link_position` and a `motor_position` or `command_position` of one
    /// dimension, or with neither two rests apart nor a motor side whose motion tells it.
    pub fn of(recording: &Recording) -> Option<Self> {
        let varies = |role: &Role| recording.channel(*role).is_some_and(Channel::varies);
        let roles = [Role::MotorPosition, Role::CommandPosition];
        let motor_side = roles.into_iter().find(varies)?;
        let motor = unwrapped(recording.channel(motor_side)?);
        let link = unwrapped(recording.channel(Role::LinkPosition)?);
        if motor.unit != link.unit || !["rad", "m"].contains(&motor.unit.as_str()) {
            return None;
        }
        let told = |(ratio, std), is_in_motion| Self {
            ratio,
            std,
            motor_side,
            is_in_motion,
        };
        let at_rest = rests(&motor, &link).and_then(|rests| line(&rests));
        let at_rest = at_rest.map(|line| told(line, false));
        // A command leads the motor side by the servo, which is no joint.
        let moves = || match motor_side {
            Role::MotorPosition => {
                let gain = Series::of(&motor, &link)?.certain_gain()?;
                Some(told((gain.ratio, gain.std), true))
            }
            _ => None,
        };
        at_rest.filter(Self::is_certain).or_else(moves)
    }

    fn is_certain(&self) -> bool {
        self.std <= CERTAIN * self.ratio.abs()
    }

    /// The mistake that the ratio tells for certain; `None` for a link that follows its motor side.
    pub fn mistake(&self) -> Option<Mistake> {
        let size = self.ratio.abs();
        if !self.is_certain() || !is_mistake(self.ratio) {
            return None;
        }
        let is = |other: f64| (size / other - 1.0).abs() < NEAR;
        let sign = self.ratio.signum();
        match sign < 0.0 {
            _ if is(DEGREES) => Some(Mistake::DegreesOfLink(sign)),
            _ if is(DEGREES.recip()) => Some(Mistake::DegreesOfMotorSide(sign)),
            true if is(1.0) => Some(Mistake::Sign),
            _ => Some(Mistake::Scale),
        }
    }

    /// The mistake in a sentence without a full stop, if there is one.
    pub fn contradiction(&self) -> Option<String> {
        self.mistake().map(|mistake| {
            let motor = self.motor_side;
            let ratio = plain(rounded(self.ratio));
            let way = |sign: f64| match sign < 0.0 {
                true => ", and counts in the other direction (scale = -1)",
                false => "",
            };
            let why = match mistake {
                Mistake::Sign => "one of the two counts in the other direction; write scale = -1 at its [[channel]]".into(),
                Mistake::DegreesOfLink(sign) => {
                    format!("link_position is in degrees; write unit = \"deg\" at its [[channel]]{}", way(sign))
                }
                Mistake::DegreesOfMotorSide(sign) => {
                    format!("{motor} is in degrees; write unit = \"deg\" at its [[channel]]{}", way(sign))
                }
                Mistake::Scale => format!(
                    "one of the two has another unit, another direction or a gear between; write scale = {ratio} at the \
                     [[channel]] of {motor} if it is measured before the gear"
                ),
            };
            let when = match self.is_in_motion {
                true => "in slow motion",
                false => "from rest to rest",
            };
            format!("{when} link_position moves {ratio} times as far as {motor}: {why}")
        })
    }
}

/// Whether no scale and no physics of a joint gives a ratio.
pub(super) fn is_mistake(ratio: f64) -> bool {
    !(FAR.recip()..FAR).contains(&ratio)
}

/// Three digits.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Means of motor side and link in the second half of a rest, and the link's variance there.
struct Rest {
    motor: f64,
    link: f64,
    variance: f64,
}

/// The rests of the motor side in which the link was measured.
fn rests(motor: &Channel, link: &Channel) -> Option<Vec<Rest>> {
    let values = motor.columns.first()?;
    let phases = phases(&motor.time, values, RestRule::from_values(values)).ok()?;
    let rest = phases.iter().filter(|phase| phase.motion == Motion::Rest);
    let within = rest.filter_map(|rest| {
        let settled = rest.end - SETTLED * (rest.end - rest.start);
        let part = |channel: &Channel| -> Option<Vec<f64>> {
            let from = channel.time.partition_point(|t| *t < settled);
            let until = channel.time.partition_point(|t| *t <= rest.end);
            Some(channel.columns.first()?.get(from..until)?.to_vec())
        };
        let (motor, link) = (part(motor)?, part(link)?);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (at, centre) = (mean(&motor), mean(&link));
        let square: f64 = link.iter().map(|value| (value - centre).powi(2)).sum();
        let finite = at.is_finite() && square.is_finite();
        (link.len() >= FEWEST && finite).then(|| Rest {
            motor: at,
            link: centre,
            variance: square / (link.len() - 1) as f64,
        })
    });
    Some(within.collect())
}

/// The least-squares line through the rests: its slope, and one standard deviation of that.
fn line(rests: &[Rest]) -> Option<(f64, f64)> {
    let count = rests.len() as f64;
    let mean = |of: fn(&Rest) -> f64| rests.iter().map(of).sum::<f64>() / count;
    let (motor, link) = (mean(|rest| rest.motor), mean(|rest| rest.link));
    let sum = |of: &dyn Fn(&Rest) -> f64| rests.iter().map(of).sum::<f64>();
    let spread = sum(&|rest| (rest.motor - motor).powi(2));
    let ratio = sum(&|rest| (rest.motor - motor) * (rest.link - link)) / spread;
    let left = sum(&|rest| (rest.link - link - ratio * (rest.motor - motor)).powi(2));
    let about = left / (count - 2.0).max(1.0) / spread;
    // A vibration that has not died out moves the mean of a rest by less than its standard deviation.
    let within = sum(&|rest| (rest.motor - motor).powi(2) * rest.variance) / spread.powi(2);
    let std = about.max(within).sqrt();
    (rests.len() >= 2 && ratio.is_finite() && std.is_finite()).then_some((ratio, std))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    /// A link of 6 Hz on a motor side that moves and rests, each through a scale.
    fn recording(scales: [f64; 2]) -> Recording {
        let time: Vec<f64> = (0..2000).map(|k| k as f64 / 250.0).collect();
        let moves = [(0.5, 0.8), (3.0, -0.5), (5.5, 0.3)];
        let gone = |t: f64, at: f64| {
            let s = ((t - at) / 0.3).clamp(0.0, 1.0);
            s * s * (3.0 - 2.0 * s)
        };
        let motor: Vec<f64> = time
            .iter()
            .map(|t| moves.iter().map(|(at, by)| by * gone(*t, *at)).sum())
            .collect();
        let rings = |t: f64, at: f64| {
            if t > at {
                (-1.5 * (t - at)).exp() * (TAU * 6.0 * (t - at)).sin()
            } else {
                0.0
            }
        };
        let vibration = |t: &f64| -> f64 {
            moves
                .iter()
                .map(|(at, by)| 0.1 * by * rings(*t, at + 0.3))
                .sum()
        };
        let link = time
            .iter()
            .zip(&motor)
            .map(|(t, u)| u + vibration(t))
            .collect();
        let channel = |role, values: Vec<f64>, scale: f64| Channel {
            role,
            unit: "rad".into(),
            time: time.clone(),
            columns: vec![values.iter().map(|value| scale * value).collect()],
        };
        Recording {
            name: "arm".into(),
            payload: None,
            channels: vec![
                channel(Role::MotorPosition, motor, scales[0]),
                channel(Role::LinkPosition, link, scales[1]),
            ],
        }
    }

    #[test]
    fn the_ratio_tells_the_mistake() {
        let told = |scales| StaticRatio::of(&recording(scales)).and_then(|own| own.mistake());
        assert_eq!(told([1.0, 1.0]), None);
        assert_eq!(told([1.0, 1.3]), None);
        assert_eq!(told([-1.0, -1.0]), None);
        assert_eq!(told([1.0, -1.0]), Some(Mistake::Sign));
        assert_eq!(told([-1.0, 1.0]), Some(Mistake::Sign));
        assert_eq!(told([1.0, DEGREES]), Some(Mistake::DegreesOfLink(1.0)));
        assert_eq!(told([1.0, -DEGREES]), Some(Mistake::DegreesOfLink(-1.0)));
        assert_eq!(told([DEGREES, 1.0]), Some(Mistake::DegreesOfMotorSide(1.0)));
        assert_eq!(told([100.0, 1.0]), Some(Mistake::Scale));
        assert_eq!(told([1.0, -2.5]), Some(Mistake::Scale));
    }

    #[test]
    fn one_rest_or_none_tells_no_ratio() {
        let mut still = recording([0.0, 1.0]);
        assert_eq!(StaticRatio::of(&still), None);
        still = recording([1.0, 1.0]);
        still.channels.truncate(1);
        assert_eq!(StaticRatio::of(&still), None);
    }
}
