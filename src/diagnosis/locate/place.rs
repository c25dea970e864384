//! The place in the chain, from all that was seen.

use super::Residual;
use super::events::Events;
use super::orders::Order;
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
    pub events: Events,
    pub suspects: &'a [Suspect],
    pub orders: &'a [Order],
    /// Whether a frequency away from the mode stands out of what the sensor side leaves.
    pub rings_elsewhere: bool,
}

impl Evidence<'_> {
    /// The first guess, none where nothing is above chance. The coordinate becomes the one that tells
    /// the place: the sensor's regressor, the position of a ripple, the time of an event.
    pub fn place(&self, coordinate: &mut Option<CoordinateTrace>) -> Option<Place> {
        let half = 0.5 * (self.residual.time.len() as f64).ln();
        let dynamic = self.dynamic_gain - half.max(CHANCE);
        let sensor = self.sensor.gain - (half * self.sensor.count as f64).max(CHANCE);
        let events = self.events.evidence;
        if dynamic.max(sensor).max(events) <= 0.0 {
            return None;
        }
        if self.residual.sensor_only || sensor >= dynamic.max(events) {
            if self.rings_elsewhere && !self.residual.sensor_only {
                return Some(Place::Link);
            }
            if sensor > 0.0 {
                self.against_regressor(coordinate);
            }
            return Some(Place::Sensor);
        }
        if events >= dynamic {
            self.over_time(coordinate);
            return Some(Place::Environment);
        }
        let shares = coordinate.iter().flat_map(|c| &c.explained).map(|e| e.1);
        let share = shares.fold(0.0, f64::max);
        Some(self.of_force(share, coordinate))
    }

    /// The place of a force, of which the best coordinate explains this share.
    fn of_force(&self, share: f64, coordinate: &mut Option<CoordinateTrace>) -> Place {
        let changes = |s: &&Suspect| s.kind == Kind::Change && s.share > share;
        let ripple = self
            .orders
            .first()
            .filter(|o| o.significant && o.share > share);
        let change = self.suspects.iter().find(changes);
        if change.is_some_and(|c| ripple.is_none_or(|r| c.share > r.share)) {
            self.over_time(coordinate);
            return Place::Link;
        }
        if ripple.is_some() {
            let position = self.residual.motor.iter().map(|m| m[0]).collect();
            set(coordinate, "position", position, self.missing.to_vec());
            return Place::Transmission;
        }
        self.of_coordinate(coordinate.as_ref())
    }

    fn of_coordinate(&self, coordinate: Option<&CoordinateTrace>) -> Place {
        let mut sides = self.residual.motor.iter().zip(self.residual.link);
        let no_link = sides.all(|(motor, link)| motor == link);
        let free = self.residual.dynamics.natural_frequency == 0.0;
        match coordinate.map(|c| c.coordinate.as_str()) {
            _ if no_link && free => Place::Drive,
            Some("deformation" | "deformation rate" | "hysteresis") => Place::Transmission,
            Some("position" | "velocity") if no_link => Place::Transmission,
            _ => Place::Link,
        }
    }

    fn against_regressor(&self, coordinate: &mut Option<CoordinateTrace>) {
        if let Some((name, values)) = &self.sensor.best {
            set(
                coordinate,
                name,
                values.clone(),
                self.residual.residual.to_vec(),
            );
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
