//! The filter that can be retuned in motion.

use super::errors;
use super::shaper::{GivenMode, Shaper, known};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use quell::shapers::{self, Mode, MotionLimits, Retune, RetuneOutcome, Setpoint, UncertainMode};
use serde_json::json;

/// Position, velocity and acceleration.
type Given = (f64, f64, f64);
/// The same over time.
type Arrays<'py> = [PyReadonlyArray1<'py, f64>; 3];

/// Setpoints of arrays, tick by tick.
fn setpoints<'a>(arrays: &'a Arrays<'_>) -> PyResult<impl Fn(usize) -> Setpoint + 'a> {
    let [p, v, a] = arrays;
    let (p, v, a) = (p.as_slice()?, v.as_slice()?, a.as_slice()?);
    Ok(move |tick: usize| Setpoint {
        position: p[tick],
        velocity: v[tick],
        acceleration: a[tick],
    })
}

/// One axis at the tick.
#[pyclass(module = "quell._quell")]
pub struct AdaptiveFilter(shapers::AdaptiveFilter);

#[pymethods]
impl AdaptiveFilter {
    /// At rest at position 0, for ticks of `1 / rate` s.
    #[new]
    fn new(rate: f64, capacity: usize, horizon: usize) -> Self {
        Self(shapers::AdaptiveFilter::new(1.0 / rate, capacity, horizon))
    }

    /// One tick.
    fn step(&mut self, position: f64, velocity: f64, acceleration: f64) -> Given {
        let sent = self.0.step(Setpoint {
            position,
            velocity,
            acceleration,
        });
        (sent.position, sent.velocity, sent.acceleration)
    }

    /// A tick for each element of three arrays of one length.
    fn apply<'py>(
        &mut self,
        py: Python<'py>,
        planned: Arrays<'py>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
        let count = planned[0].as_slice()?.len();
        let at = setpoints(&planned)?;
        let mut sent: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(count));
        for tick in 0..count {
            let Setpoint {
                position,
                velocity,
                acceleration,
            } = self.0.step(at(tick));
            for (column, value) in sent.iter_mut().zip([position, velocity, acceleration]) {
                column.push(value);
            }
        }
        Ok(sent.map(|column| column.into_pyarray(py)))
    }

    /// Installs a train at rest.
    fn install(&mut self, shaper: &Shaper) -> PyResult<()> {
        self.0.install(&shaper.grid).map_err(errors::shaper)
    }

    /// Goes over to another train in motion; what came of it, as JSON.
    fn retune(
        &mut self,
        shaper: &Shaper,
        modes: Vec<GivenMode>,
        limits: Given,
        planned: Arrays<'_>,
        judged: (f64, f64),
    ) -> PyResult<String> {
        let modes: Vec<UncertainMode> = modes.into_iter().map(known).collect::<PyResult<_>>()?;
        let request = Retune {
            train: &shaper.grid,
            modes: &modes,
            limits: MotionLimits {
                velocity: limits.0,
                acceleration: limits.1,
                jerk: limits.2,
            },
            dead_band: judged.0,
            resolution: judged.1,
        };
        let count = planned[0].as_slice()?.len();
        let at = setpoints(&planned)?;
        // The first planned input is one tick from now.
        let outcome = self.0.retune(&request, count, |tick| at(tick - 1));
        Ok(match outcome {
            RetuneOutcome::Installed => json!({ "outcome": "installed" }),
            RetuneOutcome::Refused(refusal) => {
                json!({ "outcome": "refused", "reason": refusal.to_string() })
            }
            RetuneOutcome::Corrected(done) => json!({
                "outcome": "corrected",
                "cross_fade_s": done.cross_fade,
                "correction_s": done.duration,
                "until_rest_s": done.until_rest,
                "peak_over_limit": done.peaks.worst(),
            }),
        }
        .to_string())
    }

    /// Puts it to rest.
    fn reset(&mut self, position: f64) {
        self.0.reset(position);
    }

    #[getter]
    fn is_settled(&self) -> bool {
        self.0.is_settled()
    }

    #[getter]
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    #[getter]
    fn horizon(&self) -> usize {
        self.0.horizon()
    }

    /// Vibration left in a mode (Hz, damping ratio) by what was sent, and by what was planned.
    fn residual(&self, hertz: f64, damping_ratio: f64) -> PyResult<Option<(f64, f64)>> {
        let mode = Mode::from_hertz(hertz, damping_ratio).map_err(errors::shaper)?;
        Ok(self
            .0
            .residual(mode)
            .map(|left| (left.shaped, left.unshaped)))
    }
}
