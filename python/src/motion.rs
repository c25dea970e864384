//! Planned moves.

use super::errors;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use quell::trajectories::{AxisState, Limits, Planner, SampledTrajectory};

/// Position, velocity and acceleration; or the limits of velocity, acceleration and jerk.
type Triple = (f64, f64, f64);
/// Positions, velocities and accelerations of one axis.
type Arrays<'py> = [Bound<'py, PyArray1<f64>>; 3];

fn state((position, velocity, acceleration): Triple) -> AxisState {
    AxisState {
        position,
        velocity,
        acceleration,
    }
}

fn limit((velocity, acceleration, jerk): Triple) -> Limits {
    Limits {
        velocity,
        acceleration,
        jerk,
    }
}

/// The quickest move within limits at the ticks of a rate, Hz: its duration, s, and each axis.
#[pyfunction]
pub fn plan<'py>(
    py: Python<'py>,
    from: Vec<Triple>,
    to: Vec<Triple>,
    limits: Vec<Triple>,
    rate: f64,
) -> PyResult<(f64, Vec<Arrays<'py>>)> {
    let planned = py.detach(|| {
        let all = |states: Vec<Triple>| -> Vec<_> { states.into_iter().map(state).collect() };
        let limits: Vec<_> = limits.into_iter().map(limit).collect();
        let planner = Planner::new(from.len())?;
        let trajectory = planner.plan(&all(from), &all(to), &limits)?;
        Ok((trajectory.duration(), trajectory.sample(1.0 / rate)?))
    });
    let (duration, sampled): (f64, SampledTrajectory) = planned.map_err(errors::plan)?;
    let axis = |axis: usize| {
        let parts = [
            sampled.positions(axis),
            sampled.velocities(axis),
            sampled.accelerations(axis),
        ];
        parts.map(|values| values.to_vec().into_pyarray(py))
    };
    Ok((
        duration,
        (0..sampled.degrees_of_freedom()).map(axis).collect(),
    ))
}
