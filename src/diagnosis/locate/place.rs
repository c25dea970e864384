//! The place in the chain, from all that was seen.

use super::Residual;
use super::sensor_side::SensorSide;
use super::suspects::{Kind, Suspect};
use crate::diagnosis::CoordinateTrace;
use crate::effects::Place;

/// Half the chi-squared of one degree on its bound (half of the probability at 0) that chance exceeds
/// once in a thousand.
const CHANCE: f64 = 4.77;

/// What speaks for a place.
pub(super) struct Evidence<'a> {
    pub residual: &'a Residual<'a>,
    pub missing: &'a [f64],
    pub dynamic_gain: f64,
    pub sensor: &'a SensorSide,
    pub suspects: &'a [Suspect],
    pub orders: &'a [(f64, f64)],
}

impl Evidence<'_> {
    /// The first guess, none where nothing is above chance. The coordinate becomes the one that tells
    /// the place: the sensor's regressor, the position of a ripple, the time of an event.
    pub fn place(&self, coordinate: &mut Option<CoordinateTrace>) -> Option<Place> {
        let half = 0.5 * (self.residual.time.len() as f64).ln();
        let dynamic = self.dynamic_gain - half.max(CHANCE);
        let sensor = self.sensor.gain - (half * self.sensor.count as f64).max(CHANCE);
        if dynamic <= 0.0 && sensor <= 0.0 {
            return None;
        }
        if sensor >= dynamic || self.residual.sensor_only {
            if sensor > 0.0 {
                self.against_regressor(coordinate);
            }
            return Some(Place::Sensor);
        }
        if let Some(place) = self.event(coordinate) {
            return Some(place);
        }
        let ripple = self.ripple(coordinate);
        Some(ripple.unwrap_or_else(|| self.of_coordinate(coordinate.as_ref())))
    }

    fn against_regressor(&self, coordinate: &mut Option<CoordinateTrace>) {
        let Some((name, values)) = &self.sensor.best else {
            return;
        };
        let missing = self.residual.residual.to_vec();
        self.set(coordinate, name, values.clone(), missing);
    }

    /// A single event that is worth more than half of all that is missing.
    fn event(&self, coordinate: &mut Option<CoordinateTrace>) -> Option<Place> {
        let first = self.suspects.first()?;
        if first.gain < 0.5 * self.dynamic_gain {
            return None;
        }
        self.set(
            coordinate,
            "time",
            self.residual.time.to_vec(),
            self.missing.to_vec(),
        );
        Some(if first.kind == Kind::Change {
            Place::Link
        } else {
            Place::Environment
        })
    }

    /// A force periodic in position that explains more than the best coordinate.
    fn ripple(&self, coordinate: &mut Option<CoordinateTrace>) -> Option<Place> {
        let &(_, share) = self.orders.first()?;
        let shares = coordinate.iter().flat_map(|c| &c.explained).map(|e| e.1);
        if share < shares.fold(0.0, f64::max) {
            return None;
        }
        let position = self.residual.motor.iter().map(|m| m[0]).collect();
        self.set(coordinate, "position", position, self.missing.to_vec());
        Some(Place::Transmission)
    }

    fn of_coordinate(&self, coordinate: Option<&CoordinateTrace>) -> Place {
        let same = |(m, l): (&[f64; 3], &[f64; 3])| m == l;
        let no_link = self.residual.motor.iter().zip(self.residual.link).all(same);
        let free = self.residual.dynamics.natural_frequency == 0.0;
        match coordinate.map(|c| c.coordinate.as_str()) {
            _ if no_link && free => Place::Drive,
            Some("deformation" | "deformation rate" | "hysteresis") => Place::Transmission,
            Some("position" | "velocity") if no_link => Place::Transmission,
            _ => Place::Link,
        }
    }

    fn set(
        &self,
        coordinate: &mut Option<CoordinateTrace>,
        name: &str,
        x: Vec<f64>,
        missing: Vec<f64>,
    ) {
        let explained = coordinate.take().map(|c| c.explained).unwrap_or_default();
        *coordinate = Some(CoordinateTrace {
            coordinate: name.into(),
            x,
            missing,
            explained,
            ..CoordinateTrace::default()
        });
    }
}
