//! The place in the chain, from all the evidence.

use super::Residual;
use super::candidate_events::{CandidateEvent, Kind};
use super::coordinate::has_link;
use super::sensor_side::SensorSide;
use crate::CoordinateTrace;
use quell_model::effects::Place;

/// Half the chi-squared of one degree of freedom on its bound (half of the probability at 0) that chance
/// exceeds once in a thousand.
const CHANCE: f64 = 4.77;
/// Share of the chi-squared that a cause must explain. Less than 2 % would not improve held-out data, and an
/// integrator or a rounded input explains as much.
const WORTH: f64 = 0.02;

/// Evidence for each place: log-likelihood gains over noise, less the cost of their parameters.
pub(super) struct Evidence<'a> {
    pub residual: &'a Residual<'a>,
    pub missing: &'a [f64],
    /// Gain of a missing force of any course.
    pub dynamic_gain: f64,
    pub sensor: &'a SensorSide,
    /// Evidence of a few events.
    pub events: f64,
    /// Evidence of forces periodic in position.
    pub ripple: f64,
    pub candidate_events: &'a [CandidateEvent],
    /// Whether the residual without the sensor side has a significant frequency away from the mode.
    pub rings_elsewhere: bool,
}

impl Evidence<'_> {
    /// The first guess; `None` if nothing is above chance. The coordinate becomes the one that indicates the
    /// place: the sensor's regressor, the position of a ripple, the time of an event.
    pub fn place(&self, coordinate: &mut Option<CoordinateTrace>) -> Option<Place> {
        let n = self.residual.time.len() as f64;
        let dynamic = self.dynamic_gain - (0.5 * n.ln()).max(CHANCE);
        let sensor = self.sensor.evidence;
        let few = self.events.max(self.ripple);
        if dynamic.max(sensor).max(few) <= -0.5 * n * (1.0 - WORTH).ln() {
            return None;
        }
        if self.residual.sensor_only || sensor >= dynamic.max(few) {
            return Some(self.of_sensor(coordinate));
        }
        // A few causes of known shape are preferred if they gain more than half of what a force of any course
        // gains. If they gain less than that force, no coordinate may explain half of it either.
        let share = coordinate
            .iter()
            .flat_map(|c| &c.explained)
            .map(|e| e.1)
            .fold(0.0, f64::max);
        if few > 0.5 * dynamic && (few >= dynamic || share < 0.5) {
            return Some(self.of_causes(coordinate));
        }
        let changes = |s: &CandidateEvent| s.kind == Kind::Change && s.share > share;
        if self.candidate_events.iter().any(changes) {
            self.over_time(coordinate);
            return Some(Place::Link);
        }
        Some(self.of_coordinate(coordinate.as_ref()))
    }

    fn of_sensor(&self, coordinate: &mut Option<CoordinateTrace>) -> Place {
        // Below its own frequency a further mode, of the link or the base, looks like a sensor that is
        // sensitive to acceleration; a lag has the other sign.
        let springs = self.rings_elsewhere || self.sensor.acceleration < 0.0;
        if springs && !self.residual.sensor_only {
            *coordinate = None;
            return Place::Link;
        }
        if let Some((name, values)) = self
            .sensor
            .best
            .as_ref()
            .filter(|_| self.sensor.evidence > 0.0)
        {
            set(
                coordinate,
                name,
                values.clone(),
                self.residual.residual.to_vec(),
            );
        }
        Place::Sensor
    }

    fn of_causes(&self, coordinate: &mut Option<CoordinateTrace>) -> Place {
        if self.events >= self.ripple {
            self.over_time(coordinate);
            return Place::Environment;
        }
        let position = self.residual.motor.iter().map(|m| m[0]).collect();
        set(coordinate, "position", position, self.missing.to_vec());
        Place::Transmission
    }

    fn of_coordinate(&self, coordinate: Option<&CoordinateTrace>) -> Place {
        let no_link = !has_link(self.residual);
        let free = self.residual.dynamics.natural_frequency == 0.0;
        match coordinate.map(|c| c.coordinate.as_str()) {
            _ if no_link && free => Place::Drive,
            Some("deformation" | "deformation rate" | "hysteresis") => Place::Transmission,
            Some("position" | "velocity") if no_link => Place::Transmission,
            _ => Place::Link,
        }
    }

    fn over_time(&self, coordinate: &mut Option<CoordinateTrace>) {
        set(
            coordinate,
            "time",
            self.residual.time.to_vec(),
            self.missing.to_vec(),
        );
    }
}

fn set(coordinate: &mut Option<CoordinateTrace>, name: &str, x: Vec<f64>, missing: Vec<f64>) {
    let explained = coordinate.take().map(|c| c.explained).unwrap_or_default();
    *coordinate = Some(CoordinateTrace {
        coordinate: name.into(),
        x,
        missing,
        explained,
        ..CoordinateTrace::default()
    });
}
