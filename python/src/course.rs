//! The motion of a joint from its recorded positions.

use super::errors;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use quell::recording::{Channel, Role};
use quell::signal::Course;

/// Position, velocity and acceleration at the stamps of a position, by the smoother of `signal`.
#[pyfunction]
pub fn course<'py>(
    py: Python<'py>,
    time: PyReadonlyArray1<'py, f64>,
    position: PyReadonlyArray1<'py, f64>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
    let mut channel = Channel {
        role: Role::MotorPosition,
        unit: "rad".into(),
        time: time.as_slice()?.to_vec(),
        columns: vec![position.as_slice()?.to_vec()],
    };
    channel.unwrap_turns();
    let course = py.detach(|| Course::of(&channel)).map_err(errors::course)?;
    let of = |order: usize| -> Vec<f64> { course.state.iter().map(|own| own[order]).collect() };
    Ok([0, 1, 2].map(|order| of(order).into_pyarray(py)))
}
