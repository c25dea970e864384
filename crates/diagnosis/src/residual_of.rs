//! Where the residual of an explanation sits, and what it suggests to look at.

use super::explanation::Explanation;
use super::locate::{Dynamics, Located, Residual, locate};
use super::problem::Problem;
use quell_model::effects::Scales;
use quell_model::simulate_windows;
use quell_recording::Role;
use std::f64::consts::TAU;

impl Problem<'_> {
    /// The scales, with the events, frequencies, orders and stops that an explanation leaves, those that were
    /// suggested before behind them.
    pub fn located_in(&self, own: &Explanation) -> Scales {
        let located = self.locate(own);
        tracing::debug!(
            times = ?located.candidate_events,
            frequencies = ?located.candidate_frequencies,
            orders = ?located.candidate_orders,
            "candidate events"
        );
        let mut scales = self.scales.clone();
        scales.candidate_events = located.candidate_events;
        scales.candidate_frequencies = located.candidate_frequencies;
        scales.candidate_orders = located.candidate_orders;
        scales.candidate_stops = located.candidate_stops;
        if scales.forced {
            let residual = self.explained(&own.fitted.point, 0);
            let output = &self.experiments[0].outputs[0];
            scales.candidate_frequencies = super::screen::peaks(&output.time, &residual[0]);
        }
        scales
    }

    /// Where the residual of the first output sits.
    pub fn locate(&self, own: &Explanation) -> Located {
        let (problem, point) = (self, &own.fitted.point);
        let residual = problem.explained(point, 0);
        let (experiment, local) = (&problem.experiments[0], &point.locals[0]);
        let simulated = simulate_windows(
            problem.kind,
            &problem.keys(point, 0),
            &point.terms,
            experiment,
            &local.departures,
        );
        let output = &experiment.outputs[0];
        let (mut motor, mut link) = simulated.kinematics(&output.time, local.clocks[0]);
        if output.role == Role::MotorPosition {
            // Where a law of position acts is where the axis was, not where an error of the force has carried the
            // simulation.
            for (k, error) in residual[0].iter().enumerate() {
                motor[k][0] += error;
                link[k][0] += error;
            }
        }
        let mode = problem
            .kind
            .mode
            .map(|(f, xi)| (point.keys[f] * TAU, point.keys[xi]));
        let (natural_frequency, damping_ratio) = mode.unwrap_or((0.0, 0.0));
        let windows = experiment.windows.iter();
        let restarts: Vec<f64> = windows.map(|w| w.time + local.clocks[0]).collect();
        locate(&Residual {
            time: &output.time,
            residual: &residual[0],
            noise_std: problem.whitening[0][0].deviation,
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
