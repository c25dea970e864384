//! Shapers: trains for modes, and arrays through them.

use super::errors;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use quell::cli::shaping;
use quell::shapers::{
    self, Criterion, GridTrain, ImpulseTrain, Mode, Requirements, SHAPERS, Standing, UncertainMode,
    design_for_all, insensitivity, residual_vibration, shaper_by_name,
};
use serde_json::json;
use std::f64::consts::TAU;

/// Natural frequency, Hz, damping ratio, and one standard deviation of each.
pub type GivenMode = (f64, f64, f64, f64);

/// A mode, and how well it is known.
pub fn known((hertz, ratio, hertz_std, ratio_std): GivenMode) -> PyResult<UncertainMode> {
    Ok(UncertainMode {
        mode: Mode::from_hertz(hertz, ratio).map_err(errors::shaper)?,
        natural_frequency_std: TAU * hertz_std,
        damping_ratio_std: ratio_std,
    })
}

/// A train of impulses for modes, on the grid of a controller.
#[pyclass(frozen, module = "quell._quell")]
pub struct Shaper {
    shaper: &'static dyn shapers::Shaper,
    train: ImpulseTrain,
    pub grid: GridTrain,
}

#[pymethods]
impl Shaper {
    /// Designs the train of that name for all modes at once, at a rate in Hz.
    #[new]
    fn new(name: &str, modes: Vec<GivenMode>, rate: f64) -> PyResult<Self> {
        let shaper = shaper_by_name(name).ok_or_else(|| errors::no_shaper(name))?;
        let modes: Vec<UncertainMode> = modes.into_iter().map(known).collect::<PyResult<_>>()?;
        let train = design_for_all(shaper, &modes).map_err(errors::shaper)?;
        let grid = shaping::train(shaper, modes, 1.0 / rate).map_err(errors::shaper)?;
        Ok(Self {
            shaper,
            train,
            grid,
        })
    }

    #[getter]
    fn name(&self) -> &'static str {
        self.shaper.name()
    }

    #[getter]
    fn title(&self) -> &'static str {
        self.shaper.title()
    }

    #[getter]
    fn is_convex(&self) -> bool {
        self.shaper.is_convex()
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.grid.duration()
    }

    #[getter]
    fn gain(&self) -> f64 {
        self.grid.gain()
    }

    /// Instants, s, and amplitudes.
    fn impulses(&self) -> Vec<(f64, f64)> {
        let impulses = self.train.impulses().iter();
        impulses
            .map(|impulse| (impulse.time, impulse.amplitude))
            .collect()
    }

    /// Delays in ticks, and amplitudes.
    fn taps(&self) -> Vec<(u32, f64)> {
        let taps = self.grid.taps().iter();
        taps.map(|tap| (tap.delay, tap.amplitude)).collect()
    }

    /// Residual vibration of the taps at each frequency, Hz.
    fn residual<'py>(
        &self,
        py: Python<'py>,
        hertz: PyReadonlyArray1<'py, f64>,
        damping_ratio: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let taps = self.grid.to_impulses();
        let at = |hertz: &f64| residual_vibration(&taps, TAU * hertz, damping_ratio);
        let left: Vec<f64> = hertz.as_slice()?.iter().map(at).collect();
        Ok(left.into_pyarray(py))
    }

    /// The band, Hz, around a mode within which no more than `tolerance` is left.
    fn band(&self, hertz: f64, damping_ratio: f64, tolerance: f64) -> PyResult<Option<(f64, f64)>> {
        let taps = self.grid.to_impulses();
        let band = insensitivity(&taps, damping_ratio, TAU * hertz, tolerance);
        let band = band.map_err(errors::shaper)?;
        Ok(band.map(|band| (band.from * hertz, band.to * hertz)))
    }

    /// Columns through the train, each from rest at its first value, until all have come to their ends.
    fn apply<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let slices: Result<Vec<&[f64]>, _> =
            columns.iter().map(PyReadonlyArray1::as_slice).collect();
        let slices = slices?;
        let shaped = py.detach(|| shaping::shaped(&slices, &self.grid));
        let shaped = shaped.map_err(errors::shaper)?.into_iter();
        Ok(shaped.map(|column| column.into_pyarray(py)).collect())
    }
}

/// The table of shapers: name, title, summary.
#[pyfunction(name = "shapers")]
pub fn shapers_table() -> Vec<(&'static str, &'static str, &'static str)> {
    let line = |shaper: &&dyn shapers::Shaper| (shaper.name(), shaper.title(), shaper.summary());
    SHAPERS.iter().map(line).collect()
}

/// The shaper to take for modes that are known only so well, as JSON.
#[pyfunction]
pub fn recommend(
    modes: Vec<GivenMode>,
    longest_delay: f64,
    acceptable: f64,
    allow_negative: bool,
) -> PyResult<String> {
    let modes: Vec<UncertainMode> = modes.into_iter().map(known).collect::<PyResult<_>>()?;
    let wanted = Requirements {
        longest_delay,
        criterion: Criterion::Worst95,
        acceptable,
        tolerance: 0.0,
        allow_negative,
    };
    let found = shapers::recommend(&modes, &wanted).map_err(errors::shaper)?;
    let line = |one: &shapers::Candidate| {
        json!({
            "shaper": one.shaper.name(),
            "delay_s": one.delay,
            "residual": one.nominal,
            "residual_mean": one.expected,
            "residual_95": one.worst_95,
            "eligible": one.standing == Standing::Eligible,
        })
    };
    let candidates: Vec<_> = found.candidates.iter().map(line).collect();
    Ok(json!({ "best": line(&found.best), "candidates": candidates }).to_string())
}
