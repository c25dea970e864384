//! Simulation of one experiment at a point, compared with the recording.

use super::point::Point;
use super::problem::Problem;
use quell_model::effects::Law;
use quell_model::{Experiment, Output, Prediction, Simulated, predict_windows, simulate_windows};
use std::sync::atomic::Ordering::Relaxed;

/// Samples of the outputs that take as long as a step of the integration: each is predicted and whitened, and
/// has its part in the normal matrix. Measured: 0.5 us a step, 0.14 us a sample.
const ROWS_A_STEP: usize = 4;

/// A simulated experiment, compared with the recording.
pub struct Run {
    /// The motion; `None` in a frozen problem, which does not need it again.
    pub simulated: Option<Simulated>,
    /// Recorded minus predicted, for each output.
    pub residuals: Vec<Vec<f64>>,
    /// Rates of the prediction, for each output; empty where its clock is the input's.
    pub rates: Vec<Vec<f64>>,
}

impl Problem<'_> {
    /// One experiment at a point.
    pub fn run(&self, point: &Point, experiment: usize) -> Run {
        let (local, keys) = (&point.locals[experiment], self.keys(point, experiment));
        let (kind, data) = (self.kind, &self.experiments[experiment]);
        if self.stop.now() {
            return left_out(data);
        }
        let work = data.grid.input.len() + data.samples() / ROWS_A_STEP;
        self.simulated.fetch_add(work as u64, Relaxed);
        let (terms, starts) = (&point.terms, &local.departures);
        if self.frozen {
            let shown = predict_windows(kind, &keys, terms, data, starts, &local.clocks);
            return compared(data, shown.into_iter(), None);
        }
        let simulated = simulate_windows(kind, &keys, terms, data, starts);
        self.read(point, experiment, simulated)
    }

    /// A run of one experiment at a point that differs from that of `run` in one effect only. If the effect
    /// does not act on the motion, that is reused, unless it is coupled to what was read.
    pub fn run_again(&self, point: &Point, experiment: usize, term: usize, run: &Run) -> Run {
        let (own, data) = (&point.terms[term], &self.experiments[experiment]);
        match ((own.effect.law)(&own.values), &run.simulated) {
            (Law::Sensor(_) | Law::Resonance(_), Some(motion)) if data.coupling.is_none() => {
                self.read(point, experiment, motion.read_by(&point.terms, data))
            }
            _ => self.run(point, experiment),
        }
    }

    /// Compares a simulated experiment with the recording.
    fn read(&self, point: &Point, experiment: usize, simulated: Simulated) -> Run {
        let data = &self.experiments[experiment];
        let pairs = data.outputs.iter().zip(&point.locals[experiment].clocks);
        let shown: Vec<_> = pairs
            .map(|(output, &clock)| simulated.predict(output, clock))
            .collect();
        compared(data, shown.into_iter(), Some(simulated))
    }
}

/// A run that was skipped; it looks like one that diverged.
fn left_out(data: &Experiment) -> Run {
    let nothing = |output: &Output| vec![f64::NAN; output.values.len()];
    let rates = |output: &Output| match output.own_clock {
        true => nothing(output),
        false => Vec::new(),
    };
    Run {
        simulated: None,
        residuals: data.outputs.iter().map(nothing).collect(),
        rates: data.outputs.iter().map(rates).collect(),
    }
}

/// The predicted outputs, compared with the recording.
fn compared(
    data: &Experiment,
    shown: impl Iterator<Item = Prediction>,
    simulated: Option<Simulated>,
) -> Run {
    let against = |(output, mut shown): (&Output, Prediction)| {
        for (predicted, y) in shown.values.iter_mut().zip(&output.values) {
            *predicted = y - *predicted;
        }
        (
            shown.values,
            if output.own_clock {
                shown.rates
            } else {
                Vec::new()
            },
        )
    };
    let (residuals, rates) = data.outputs.iter().zip(shown).map(against).unzip();
    Run {
        simulated,
        residuals,
        rates,
    }
}
