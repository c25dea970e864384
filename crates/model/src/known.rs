//! Known time-varying quantities of a joint: a force on its link, the inertia of its link.
//!
//! ```text
//! J(t) y'' = ... + F(t)          a link on a transmission: J(t) stands for the constant of the model
//! (m + J(t)) u'' = ... + F(t)    an axis without a spring: beside what moves with its motor
//! ```
//!
//! `F` is positive in the direction of positive motion. Other forces that change with the inertia, such as
//! centrifugal and Coriolis forces, must be part of `F`. Both are linear between their samples and constant
//! beyond the ends. An inertia in the unit `1` is a factor on the model's own, with any kind.

mod unit;

use super::chain::{Chain, ForceElement, Linear, MotorSide};
use super::{ExperimentError, Model};
use crate::effects::{Force, Inertia, Memory, Motion, Place};
use quell_recording::{Channel, Recording, Role};
use quell_signal::{CubicSpline, End, SignalError, noise_floor};
use std::sync::Arc;

/// The known forces and the known inertia of one recording.
#[derive(Clone, Debug, Default)]
pub struct Known {
    forces: Vec<Arc<Series>>,
    inertia: Option<KnownInertia>,
}

#[derive(Clone, Debug)]
struct KnownInertia {
    series: Arc<Series>,
    /// Whether it is a factor on the model's own.
    relative: bool,
}

/// Straight lines through samples.
#[derive(Debug)]
struct Series {
    time: Vec<f64>,
    values: Vec<f64>,
    /// Slope of each line, and the mean number of samples in a second.
    slopes: Vec<f64>,
    rate: f64,
}

impl Known {
    /// The known quantities of a recording; input role, input unit and position unit are in the `equation`.
    pub(super) fn of(
        model: &Model,
        recording: &Recording,
        equation: &unit::Equation,
    ) -> Result<Self, ExperimentError> {
        let mut known = Self::default();
        for channel in &recording.channels {
            match channel.role {
                Role::KnownForce => {
                    equation.takes_force(model, recording, channel)?;
                    known.forces.push(Arc::new(Series::of(channel)?));
                }
                Role::Inertia => {
                    equation.takes_inertia(model, recording, channel)?;
                    known.inertia = Some(KnownInertia {
                        relative: channel.unit == "1",
                        series: Arc::new(Series::of(channel)?),
                    });
                }
                _ => {}
            }
        }
        Ok(known)
    }

    /// Whether the absolute inertia is known, and not only its relative change.
    pub fn says_inertia(&self) -> bool {
        self.inertia.as_ref().is_some_and(|own| !own.relative)
    }

    /// Number of samples and standard deviation of the noise of each known force.
    pub fn noise_of_forces(&self) -> Vec<(usize, f64)> {
        let of = |own: &Arc<Series>| {
            (
                own.values.len(),
                noise_floor(&own.values).standard_deviation,
            )
        };
        self.forces.iter().map(of).collect()
    }

    /// The same with a sample of a known force changed.
    #[must_use]
    pub fn with_force_changed(&self, force: usize, sample: usize, by: f64) -> Self {
        let mut other = self.clone();
        let own = &self.forces[force];
        let mut values = own.values.clone();
        values[sample] += by;
        other.forces[force] = Arc::new(Series::new(own.time.clone(), values));
        other
    }

    /// Factor on the fastest natural frequency at the least of the known inertia.
    pub(super) fn hastens(&self, linear: &Linear, newton: f64) -> f64 {
        let Some(inertia) = &self.inertia else {
            return 1.0;
        };
        let least = inertia.series.values.iter().copied();
        let factor = inertia.factor(linear, newton);
        let least = least.map(|value| factor.of(value));
        least.fold(1.0, f64::min).sqrt().recip()
    }

    /// Adds the known quantities to a chain; `newton` is the chain's force for 1 N, or 1 N.m.
    pub(super) fn act_on(&self, chain: &mut Chain, newton: f64) {
        for series in &self.forces {
            let law = Box::new(Push {
                series: Arc::clone(series),
                scale: newton / chain.linear.unit_force,
            });
            let (place, memory) = (Place::Link, Memory::default());
            chain.forces.push(ForceElement { place, law, memory });
        }
        if let Some(inertia) = &self.inertia {
            let factor = inertia.factor(&chain.linear, newton);
            let series = Arc::clone(&inertia.series);
            chain.inertias.push(Box::new(Seen { series, factor }));
        }
    }
}

impl KnownInertia {
    fn factor(&self, linear: &Linear, newton: f64) -> Factor {
        match (self.relative, linear.link, linear.motor) {
            (true, ..) => Factor {
                base: 0.0,
                slope: 1.0,
            },
            (false, ..) if linear.link_is_input => Factor {
                base: 1.0,
                slope: newton / linear.held_inertia,
            },
            (false, Some((own, _)), _) => Factor {
                base: 0.0,
                slope: newton / own,
            },
            (false, None, MotorSide::Free { inertia, .. }) => Factor {
                base: 1.0,
                slope: newton / inertia,
            },
            (false, None, _) => Factor {
                base: 1.0,
                slope: 0.0,
            },
        }
    }
}

/// The factor on an inertia of the chain: `base + slope J`.
struct Factor {
    base: f64,
    slope: f64,
}

impl Factor {
    fn of(&self, inertia: f64) -> f64 {
        self.base + self.slope * inertia
    }
}

impl Series {
    fn of(channel: &Channel) -> Result<Self, SignalError> {
        let (time, values) = (&channel.time, &channel.columns[0]);
        // A spline refuses invalid series: fewer than two samples, values that are not finite, times that do
        // not advance.
        CubicSpline::new(time, values, End::Natural)?;
        Ok(Self::new(time.clone(), values.clone()))
    }

    fn new(time: Vec<f64>, values: Vec<f64>) -> Self {
        let slope = |k: usize| (values[k + 1] - values[k]) / (time[k + 1] - time[k]);
        let last = time.len() - 1;
        Self {
            slopes: (0..last).map(slope).collect(),
            rate: last as f64 / (time[last] - time[0]),
            time,
            values,
        }
    }

    #[inline]
    fn at(&self, time: f64) -> f64 {
        let last = self.time.len() - 1;
        let time = time.clamp(self.time[0], self.time[last]);
        // With an even clock the guess is right.
        let guess = (((time - self.time[0]) * self.rate) as usize).min(last - 1);
        let k = match self.time[guess] <= time && time <= self.time[guess + 1] {
            true => guess,
            false => self.time.partition_point(|t| *t <= time).clamp(1, last) - 1,
        };
        self.values[k] + self.slopes[k] * (time - self.time[k])
    }
}

/// A known force, as a negative resistance.
struct Push {
    series: Arc<Series>,
    scale: f64,
}

impl Force for Push {
    fn force(&self, motion: &Motion, _x: f64, _v: f64, _memory: &Memory) -> f64 {
        -self.scale * self.series.at(motion.time)
    }
}

/// A known inertia.
struct Seen {
    series: Arc<Series>,
    factor: Factor,
}

impl Inertia for Seen {
    fn factor(&self, time: f64, _position: f64) -> f64 {
        self.factor.of(self.series.at(time))
    }
}

pub(super) use unit::Equation;
