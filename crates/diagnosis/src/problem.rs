//! The least-squares problem behind every fit: experiments, unknowns, weighted residuals.

use super::held::may_be_held;
use super::point::{Global, Local, Point};
use super::stop::Stop;
use super::whitening::Whitening;
use nalgebra::{DMatrix, DVector};
use quell_model::effects::{Catalogue, Law, Scales};
use quell_model::{Departure, Experiment, Kind, Model, StartComponent, Term, Value};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Fitted rows of one output, as ranges of samples.
pub type Rows = Vec<Range<usize>>;

/// Changes of an experiment's residuals by errors of its sensors: for each error of one standard deviation one series for each
/// output.
pub type Responses = Vec<Vec<Vec<f64>>>;

/// The data, the unknowns and the noise of a fit.
#[derive(Clone)]
pub struct Problem<'a> {
    /// Structure of the model.
    pub kind: &'static Kind,
    /// The recordings, or windows of them.
    pub experiments: &'a [Experiment],
    /// For each experiment and output the rows that are fitted.
    pub rows: Vec<Vec<Rows>>,
    /// For each experiment and output the filter that makes the noise of its sensor white and of unit variance.
    pub sensor_noise: Vec<Vec<Whitening>>,
    /// The same for the noise of its sensor and of the input.
    pub noise: Vec<Vec<Whitening>>,
    /// The same as used for the weights: outputs whose residuals are all far above the noise weigh alike.
    pub whitening: Vec<Vec<Whitening>>,
    /// Responses of each experiment to rounding at rest, of its input and of its outputs.
    pub rounding_at_rest: Arc<Vec<Responses>>,
    /// Keys of the model that are free.
    pub free: Vec<usize>,
    /// Beliefs on the keys: value, standard deviation (of the logarithm where `logarithmic`).
    pub beliefs: Vec<(f64, f64)>,
    /// Bounds on the keys.
    pub bounds: Vec<(f64, f64)>,
    /// Values and beliefs of the given model's effects, for each effect; they are fitted as keys are.
    pub given: Vec<Vec<Value>>,
    /// Payloads of the recordings, that of the first one first.
    pub payloads: Vec<Option<String>>,
    /// Which of them have a free inertia.
    pub free_payloads: Range<usize>,
    /// Components of the start (see [`simulate`]) that are free.
    pub departures: Vec<StartComponent>,
    /// Typical sizes of these components.
    pub departure_scale: Departure,
    /// Effects that the model may lack.
    pub catalogue: Catalogue,
    /// Sizes of the motion.
    pub scales: Scales,
    /// The same for events of a single recording: its index, and its scales with the instants of candidate
    /// events.
    pub scales_of_each: Vec<(usize, Scales)>,
    /// Whether only the experiments' own unknowns are fitted.
    pub frozen: bool,
    /// Ends the work before its time.
    pub stop: Stop,
    /// Ends the search before its time: fits stay where they are, and no further ones begin. What is told of the search
    /// afterwards is fitted to its end, with this one unset.
    pub enough: Stop,
    /// Work so far, in simulated steps: a measure that is the same on every machine.
    pub simulated: Arc<AtomicU64>,
}

impl Problem<'_> {
    /// Whether the search, or all work, is to end now.
    pub(super) fn is_cut(&self) -> bool {
        self.enough.now() || self.stop.now()
    }

    /// Starting point: the model's values, and first guesses of the clocks.
    pub fn start(&self, model: &Model) -> Point {
        let terms = model.terms();
        Point {
            keys: model.keys(),
            given_terms: terms.len(),
            terms,
            locals: self.neutral_locals(),
            inertias: vec![1.0; self.payloads.len()],
            held: Vec::new(),
        }
    }

    /// The unknowns of each experiment before any fit.
    pub fn neutral_locals(&self) -> Vec<Local> {
        let local = |experiment: &Experiment| Local {
            clocks: experiment.outputs.iter().map(|o| o.clock_offset).collect(),
            departures: vec![Departure::default(); 1 + experiment.windows.len()],
        };
        self.experiments.iter().map(local).collect()
    }

    /// The shared unknowns at a point's structure.
    pub fn globals(&self, point: &Point) -> Vec<Global> {
        let keys = self.free.iter().map(|&key| Global::Key(key));
        let parameters = (0..point.terms.len()).flat_map(|term| {
            let Term { effect, values, .. } = &point.terms[term];
            let free = move |parameter: &usize| {
                let is_fitted = effect.parameters[*parameter].role.is_fitted();
                if !is_fitted || effect.is_without(*parameter, values[*parameter]) {
                    return false;
                }
                let given = self
                    .given(term, *parameter)
                    .is_some_and(|value| !value.fixed);
                term >= point.given_terms || given
            };
            let all = 0..point.terms[term].values.len();
            all.filter(free)
                .map(move |parameter| Global::Parameter(term, parameter))
        });
        let inertias = self.free_payloads.clone().map(Global::Inertia);
        let all = keys.chain(inertias).chain(parameters);
        all.filter(|global| !point.held.contains(global)).collect()
    }

    /// Value and belief that the given model has for a parameter of one of its effects.
    pub(super) fn given(&self, term: usize, parameter: usize) -> Option<&Value> {
        self.given.get(term)?.get(parameter)
    }

    /// Fixes keys and effects, so that only the experiments' own unknowns are fitted.
    pub fn freeze(&mut self) {
        self.frozen = true;
        self.free.clear();
        self.given.clear();
    }

    /// Components of the start that are free with a point's structure: those of the model, the deformation at
    /// which friction holds a link, and those of further modes that a force drives. Further modes driven by a
    /// prescribed motor side start at rest.
    pub fn departures(&self, point: &Point) -> Vec<StartComponent> {
        let mut free = self.departures.clone();
        let linear = (self.kind.linear)(&point.keys, self.experiments[0].input);
        if !free.contains(&StartComponent::Deformation) && may_be_held(&linear, &point.terms) {
            free.push(StartComponent::Deformation);
        }
        if self.scales.forced {
            let terms = point.terms.iter().filter(|term| term.acts());
            let modes = terms.filter(|t| matches!((t.effect.law)(&t.values), Law::Resonance(_)));
            free.extend(StartComponent::of_modes(modes.count()));
        }
        free
    }

    /// Free unknowns of the starts of an experiment: window and component. Further modes have no sensor at the
    /// start of a window; they continue from the window before.
    pub fn starts(&self, point: &Point, experiment: usize) -> Vec<(usize, StartComponent)> {
        let each = |component: StartComponent| {
            let windows = self.starts_of(point, experiment, component);
            windows.into_iter().map(move |window| (window, component))
        };
        self.departures(point).into_iter().flat_map(each).collect()
    }

    /// Windows of an experiment in which a component of the start is free.
    pub fn starts_of(
        &self,
        point: &Point,
        experiment: usize,
        component: StartComponent,
    ) -> Vec<usize> {
        let windows = point.locals[experiment].departures.len();
        (0..if component.is_of_mode() { 1 } else { windows }).collect()
    }

    /// Whether an unknown is fitted by its logarithm.
    pub(super) fn logarithmic(&self, global: Global) -> bool {
        match global {
            Global::Key(key) => self.kind.keys[key].range.0 > 0.0,
            Global::Parameter(..) => false,
            Global::Inertia(_) => true,
        }
    }

    /// Value of an unknown as the fit sees it, a logarithm where it is fitted by that.
    pub fn get(&self, point: &Point, global: Global) -> f64 {
        let value = match global {
            Global::Key(key) => point.keys[key],
            Global::Parameter(term, parameter) => point.terms[term].values[parameter],
            Global::Inertia(payload) => point.inertias[payload],
        };
        match self.logarithmic(global) {
            true => value.ln(),
            false => value,
        }
    }

    /// Sets an unknown, kept within its bounds.
    pub fn set(&self, point: &mut Point, global: Global, value: f64) {
        let value = match self.logarithmic(global) {
            true => value.exp(),
            false => value,
        };
        let (low, high) = self.limits(point, global);
        let value = value.clamp(low, high);
        match global {
            Global::Key(key) => point.keys[key] = value,
            Global::Parameter(term, parameter) => point.terms[term].values[parameter] = value,
            Global::Inertia(payload) => point.inertias[payload] = value,
        }
    }

    /// Values of the keys in one experiment: with its payload.
    pub fn keys(&self, point: &Point, experiment: usize) -> Vec<f64> {
        let payload = &self.experiments[experiment].payload;
        let index = self.payloads.iter().position(|other| other == payload);
        let inertia = index.map_or(1.0, |index| point.inertias[index]);
        self.kind.loaded(&point.keys, inertia)
    }

    /// Weighted, whitened rows of one experiment, from one series for each output.
    pub fn weigh(&self, experiment: usize, series: &[Vec<f64>]) -> Vec<f64> {
        self.weigh_rows(experiment, series, &self.rows[experiment])
    }

    /// The same of other rows.
    pub fn weigh_rows(&self, experiment: usize, series: &[Vec<f64>], own: &[Rows]) -> Vec<f64> {
        let mut rows = Vec::new();
        for (output, values) in series.iter().enumerate() {
            let whitening = &self.whitening[experiment][output];
            for range in &own[output] {
                whitening.apply(&values[range.clone()], &mut rows);
            }
        }
        rows
    }

    /// Window of each weighted row of one experiment; a row of the witness has none.
    pub fn windows(&self, experiment: usize, rows: usize) -> Vec<usize> {
        let data = &self.experiments[experiment];
        let mut windows = Vec::with_capacity(rows);
        for (output, ranges) in data.outputs.iter().zip(&self.rows[experiment]) {
            for stamp in ranges.iter().flat_map(|range| &output.time[range.clone()]) {
                windows.push(data.windows.partition_point(|window| window.time <= *stamp));
            }
        }
        windows.resize(rows, usize::MAX);
        windows
    }

    /// Weighted rows of the residuals of one experiment, with the witness' rows at the end. NaN (a diverged
    /// simulation) becomes a large number, so that the fit turns back.
    pub fn complete(&self, experiment: usize, raw: &[Vec<f64>]) -> DVector<f64> {
        let mut rows = self.weigh(experiment, raw);
        for (index, row) in rows.iter_mut().enumerate() {
            if !row.is_finite() || row.abs() > 1e12 {
                // The sign alternates, so that an offset does not fit it.
                *row = if index % 2 == 0 { 1e12 } else { -1e12 };
            }
        }
        for output in &self.experiments[experiment].outputs {
            rows.extend(output.witness.iter().map(|(_, value)| value));
        }
        DVector::from_vec(rows)
    }

    /// Columns of the linear nuisances of one experiment, the witness' rows at their end.
    pub fn linear(&self, experiment: usize) -> DMatrix<f64> {
        let outputs = &self.experiments[experiment].outputs;
        let zeros: Vec<Vec<f64>> = outputs.iter().map(|o| vec![0.0; o.values.len()]).collect();
        let witnesses: usize = outputs.iter().map(|output| output.witness.len()).sum();
        let (mut columns, mut before) = (Vec::new(), 0);
        for (index, output) in outputs.iter().enumerate() {
            for (c, column) in output.columns.iter().enumerate() {
                let mut series = zeros.clone();
                series[index] = column.clone();
                let mut rows = self.weigh(experiment, &series);
                let own = output.witness.iter().map(|(weights, _)| weights[c]);
                rows.extend(vec![0.0; before]);
                rows.extend(own);
                rows.extend(vec![0.0; witnesses - before - output.witness.len()]);
                columns.push(DVector::from_vec(rows));
            }
            before += output.witness.len();
        }
        match columns.is_empty() {
            true => DMatrix::zeros(0, 0),
            false => DMatrix::from_columns(&columns),
        }
    }
}
