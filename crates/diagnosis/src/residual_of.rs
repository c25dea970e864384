//! Location of an explanation's residual, and the candidates that it suggests.

use super::explanation::Explanation;
use super::locate::{Dynamics, Located, Residual, locate};
use super::point::Point;
use super::problem::Problem;
use quell_model::effects::Scales;
use quell_model::{Kinematics, simulate_windows};
use quell_recording::Role;
use std::f64::consts::TAU;

impl Problem<'_> {
    /// Replaces the candidate events, frequencies, orders and stops by those of an explanation's residual.
    pub fn locate_again(&mut self, own: &Explanation) {
        let located = self.locate(own);
        tracing::debug!(
            times = ?located.candidate_events,
            frequencies = ?located.candidate_frequencies,
            orders = ?located.candidate_orders,
            "candidate events"
        );
        let mut scales = self.scales.clone();
        scales
            .candidate_events
            .clone_from(&located.candidate_events);
        scales.candidate_frequencies = located.candidate_frequencies;
        scales.candidate_orders = located.candidate_orders;
        scales.candidate_stops = located.candidate_stops;
        if scales.forced {
            let residual = self.explained(&own.fitted.point, 0);
            let output = &self.experiments[0].outputs[0];
            scales.candidate_frequencies = super::screen::peaks(&output.time, &residual[0]);
        }
        self.scales = scales;
        self.scales_of_each = self.of_each(own, located.candidate_events);
    }

    /// The scales of each recording; `first` are the events of the first one.
    fn of_each(&self, own: &Explanation, first: Vec<f64>) -> Vec<(usize, Scales)> {
        let mut each: Vec<(usize, Scales)> = Vec::new();
        let mut known = Some(first);
        for (e, experiment) in self.experiments.iter().enumerate() {
            let events = known.take();
            let events =
                events.unwrap_or_else(|| self.locate_in(&own.fitted.point, e).candidate_events);
            let span = experiment.span();
            match each.iter_mut().find(|own| own.0 == experiment.recording) {
                Some((_, scales)) => {
                    scales.span = (scales.span.0.min(span.0), scales.span.1.max(span.1));
                    scales.candidate_events.extend(events);
                }
                None => each.push((
                    experiment.recording,
                    Scales {
                        span,
                        candidate_events: events,
                        ..self.scales.clone()
                    },
                )),
            }
        }
        each
    }

    /// Location of the residual of the first output.
    pub fn locate(&self, own: &Explanation) -> Located {
        self.locate_in(&own.fitted.point, 0)
    }

    /// Motor side and link at the stamps of the first output of an experiment.
    pub fn kinematics(&self, point: &Point, e: usize) -> [Vec<Kinematics>; 2] {
        let (experiment, local) = (&self.experiments[e], &point.locals[e]);
        let (keys, starts) = (self.keys(point, e), &local.departures);
        let simulated = simulate_windows(self.kind, &keys, &point.terms, experiment, starts);
        let (motor, link) = simulated.kinematics(&experiment.outputs[0].time, local.clocks[0]);
        [motor, link]
    }

    /// Location of the residual of the first output of an experiment.
    fn locate_in(&self, point: &Point, e: usize) -> Located {
        self.locate_series(point, e, &self.explained(point, e)[0])
    }

    /// Location of a residual of the first output of an experiment, in the motion that a point simulates.
    pub fn locate_series(&self, point: &Point, e: usize, residual: &[f64]) -> Located {
        let problem = self;
        let (experiment, local) = (&problem.experiments[e], &point.locals[e]);
        let output = &experiment.outputs[0];
        let [mut motor, mut link] = problem.kinematics(point, e);
        if output.role == Role::MotorPosition {
            // A law of position acts at the recorded position of the axis, not at the simulated one, which a
            // force error may have shifted.
            for (k, error) in residual.iter().enumerate() {
                motor[k][0] += error;
                link[k][0] += error;
            }
        }
        let mode = problem
            .kind
            .mode
            .map(|(f, xi)| (point.keys[f] * TAU, point.keys[xi]));
        // An error of the motor side acts through the coupling to its measured motion.
        let coupling = experiment.coupling.as_ref().map(|own| (own.rate, 1.0));
        let coupling = coupling.filter(|_| output.role == Role::MotorPosition);
        let (natural_frequency, damping_ratio) = coupling.or(mode).unwrap_or((0.0, 0.0));
        let windows = experiment.windows.iter();
        let restarts: Vec<f64> = windows.map(|w| w.time + local.clocks[0]).collect();
        locate(&Residual {
            time: &output.time,
            residual,
            noise_std: problem.whitening[e][0].deviation,
            motor: &motor,
            link: &link,
            dynamics: Dynamics {
                natural_frequency,
                damping_ratio,
            },
            restarts: &restarts,
            sensor_only: false,
        })
    }
}
