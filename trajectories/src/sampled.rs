//! A planned move at the ticks of a controller.

use crate::{AxisState, PlanError, Trajectory};

/// The most samples for each axis: 7 axes then take 1.7 GB, at 4 kHz they last 41 minutes.
pub const MAX_SAMPLES: usize = 10_000_000;

/// A move sampled at a fixed period, in flat buffers, axis after axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledTrajectory {
    period: f64,
    degrees_of_freedom: usize,
    samples: usize,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Trajectory {
    /// The move at the ticks `0, T_s, 2 T_s, ...` up to the first tick that is not before its end;
    /// that last sample is exactly the end state.
    ///
    /// `period` is `T_s` in s. Off the tick: allocates the buffers.
    ///
    /// # Errors
    /// [`PlanError::Period`] if the period is not finite and above 0, [`PlanError::TooManySamples`]
    /// if there would be more than [`crate::MAX_SAMPLES`] samples for each axis.
    pub fn sample(&self, period: f64) -> Result<SampledTrajectory, PlanError> {
        SampledTrajectory::new(self, period)
    }
}

impl SampledTrajectory {
    pub(crate) fn new(trajectory: &Trajectory, period: f64) -> Result<Self, PlanError> {
        if !(period.is_finite() && period > 0.0) {
            return Err(PlanError::Period { period });
        }
        let duration = trajectory.duration();
        let ticks = (duration / period).ceil();
        if ticks >= MAX_SAMPLES as f64 {
            return Err(PlanError::TooManySamples {
                duration,
                period,
                limit: MAX_SAMPLES,
            });
        }
        let last = ticks as usize;
        let size = (last + 1) * trajectory.degrees_of_freedom();
        let mut sampled = Self {
            period,
            degrees_of_freedom: trajectory.degrees_of_freedom(),
            samples: last + 1,
            positions: Vec::with_capacity(size),
            velocities: Vec::with_capacity(size),
            accelerations: Vec::with_capacity(size),
        };
        for axis in trajectory.axes() {
            (0..last).for_each(|tick| sampled.push(axis.state_at(tick as f64 * period)));
            sampled.push(axis.end());
        }
        Ok(sampled)
    }

    /// The states of the axes at the period (s), axis after axis, each with as many, at least one.
    pub(crate) fn of_states(period: f64, degrees_of_freedom: usize, states: &[AxisState]) -> Self {
        let each = |of: fn(&AxisState) -> f64| states.iter().map(of).collect();
        Self {
            period,
            degrees_of_freedom,
            samples: states.len() / degrees_of_freedom,
            positions: each(|state| state.position),
            velocities: each(|state| state.velocity),
            accelerations: each(|state| state.acceleration),
        }
    }

    /// The first samples of this move, up to and including a tick, followed by another move whose first sample
    /// is that tick. Both have the same axes and period.
    pub fn then(&self, tick: usize, next: &Self) -> Self {
        let axes = 0..self.degrees_of_freedom;
        let states = axes.flat_map(|axis| {
            let before = (0..=tick).filter_map(move |k| self.state(axis, k));
            before.chain((1..next.samples).filter_map(move |k| next.state(axis, k)))
        });
        let states: Vec<_> = states.collect();
        Self::of_states(self.period, self.degrees_of_freedom, &states)
    }

    fn push(&mut self, state: AxisState) {
        self.positions.push(state.position);
        self.velocities.push(state.velocity);
        self.accelerations.push(state.acceleration);
    }

    /// The same move axis by axis: what is run by one controller for each axis.
    pub fn axes(&self) -> Vec<Self> {
        (0..self.degrees_of_freedom)
            .map(|axis| Self {
                period: self.period,
                degrees_of_freedom: 1,
                samples: self.samples,
                positions: self.positions(axis).to_vec(),
                velocities: self.velocities(axis).to_vec(),
                accelerations: self.accelerations(axis).to_vec(),
            })
            .collect()
    }

    /// The motion of one axis on a straight path, `from + s displacement` (rad): `s` is the first axis of this
    /// trajectory, the path parameter from 0 to 1. Axes that are made of one `s` are on the path at every tick.
    pub fn along(&self, from: f64, displacement: f64) -> Self {
        let scaled = |values: &[f64]| values.iter().map(|value| displacement * value).collect();
        let positions = self.positions(0).iter();
        Self {
            period: self.period,
            degrees_of_freedom: 1,
            samples: self.samples,
            positions: positions.map(|s| from + displacement * s).collect(),
            velocities: scaled(self.velocities(0)),
            accelerations: scaled(self.accelerations(0)),
        }
    }

    /// The sampling period `T_s`, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Number of axes.
    pub fn degrees_of_freedom(&self) -> usize {
        self.degrees_of_freedom
    }

    /// Samples for each axis: ticks 0 to n, so n + 1, at least 1.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Positions of one axis at all ticks, rad; the last is exactly the target. Empty if there is
    /// no such axis.
    pub fn positions(&self, axis: usize) -> &[f64] {
        self.slice(&self.positions, axis)
    }

    /// Velocities of one axis at all ticks, rad/s. Empty if there is no such axis.
    pub fn velocities(&self, axis: usize) -> &[f64] {
        self.slice(&self.velocities, axis)
    }

    /// Accelerations of one axis at all ticks, rad/s^2. Empty if there is no such axis.
    pub fn accelerations(&self, axis: usize) -> &[f64] {
        self.slice(&self.accelerations, axis)
    }

    /// The state of one axis at a tick; the end state at every later tick. `None` if there is no
    /// such axis. Runs at the tick: no allocation.
    pub fn state(&self, axis: usize, tick: usize) -> Option<AxisState> {
        if axis >= self.degrees_of_freedom {
            return None;
        }
        let index = axis * self.samples + tick.min(self.samples - 1);
        Some(AxisState {
            position: self.positions[index],
            velocity: self.velocities[index],
            acceleration: self.accelerations[index],
        })
    }

    fn slice<'a>(&self, buffer: &'a [f64], axis: usize) -> &'a [f64] {
        if axis >= self.degrees_of_freedom {
            return &[];
        }
        &buffer[axis * self.samples..][..self.samples]
    }
}
