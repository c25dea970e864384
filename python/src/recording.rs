//! Recordings.

use super::errors;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use quell::recording::{self, Channel, Dimension, ROLES, UNITS};
use std::path::PathBuf;

/// Role, unit, stamps and columns of a channel that is handed over.
type Given<'py> = (
    String,
    String,
    PyReadonlyArray1<'py, f64>,
    Vec<PyReadonlyArray1<'py, f64>>,
);

/// The same of one that is given back, in SI.
type Held<'py> = (
    &'static str,
    String,
    Bound<'py, PyArray1<f64>>,
    Vec<Bound<'py, PyArray1<f64>>>,
);

/// Channels of one run of one machine.
#[pyclass(frozen, module = "quell._quell")]
pub struct Recording(pub recording::Recording);

#[pymethods]
impl Recording {
    /// Of channels in memory; the numbers are copied once, into SI.
    #[new]
    fn new(name: String, payload: Option<String>, channels: Vec<Given<'_>>) -> PyResult<Self> {
        let mut all = Vec::new();
        for (role, unit, time, columns) in channels {
            let copied = |array: &PyReadonlyArray1<f64>| Ok(array.as_slice()?.to_vec());
            let columns: PyResult<Vec<_>> = columns.iter().map(copied).collect();
            let channel = Channel::new(&role, &unit, copied(&time)?, columns?);
            all.push(channel.map_err(errors::recording)?);
        }
        Ok(Self(recording::Recording {
            name,
            payload,
            channels: all,
        }))
    }

    /// Reads a manifest, a folder, an MCAP file or a CSV file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| recording::Recording::from_path(path));
        read.map(Self).map_err(errors::recording)
    }

    /// Reads the recordings of all joints of a robot, each with its name.
    #[staticmethod]
    fn joints(py: Python<'_>, path: PathBuf) -> PyResult<Vec<(String, Self)>> {
        let read = py.detach(|| recording::Recording::joints(path));
        let own = |(joint, recording)| (joint, Self(recording));
        let read = read.map_err(errors::recording)?;
        Ok(read.into_iter().map(own).collect())
    }

    /// Writes a folder with a manifest.
    fn save(&self, py: Python<'_>, folder: PathBuf, compress: bool) -> PyResult<()> {
        let written = py.detach(|| self.0.write(folder, compress));
        written.map_err(errors::recording)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn payload(&self) -> Option<&str> {
        self.0.payload.as_deref()
    }

    /// All channels, copied.
    fn channels<'py>(&self, py: Python<'py>) -> Vec<Held<'py>> {
        let held = |channel: &Channel| {
            let array = |values: &Vec<f64>| values.clone().into_pyarray(py);
            let columns = channel.columns.iter().map(array).collect();
            let unit = channel.unit.clone();
            (channel.role.name(), unit, array(&channel.time), columns)
        };
        self.0.channels.iter().map(held).collect()
    }
}

/// The table of roles: name, allowed numbers of columns, SI units that are usual for it.
#[pyfunction]
pub fn roles() -> Vec<(&'static str, Vec<usize>, Vec<&'static str>)> {
    let si = |dimension: &Dimension| UNITS.iter().find(|unit| unit.dimension == *dimension);
    let line = |entry: &recording::RoleEntry| {
        let usual = entry.dimensions.iter().filter_map(si);
        let usual = usual.map(|unit| unit.si).collect();
        (entry.name, entry.columns.to_vec(), usual)
    };
    ROLES.iter().map(line).collect()
}

/// The table of units: spellings, SI unit.
#[pyfunction]
pub fn units() -> Vec<(Vec<&'static str>, &'static str)> {
    let line = |unit: &recording::Unit| (unit.names.to_vec(), unit.si);
    UNITS.iter().map(line).collect()
}
