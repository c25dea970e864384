//! A static law as a curve over the coordinate of its slot.

use super::{Effect, Force, Law, Memory, Motion, Reading, Slot};

/// The static law of an effect, named or learned, at points of its slot's coordinate, in the unit of the slot:
/// a force, a coefficient, a relative change, or an addition. `None` if the law is no curve ([`Effect::slot`]).
///
/// `at` gives the other variables of the law: the model's stiffness and damping
/// ([`Model::still`](crate::Model::still)), and the other coordinates, usually 0. At velocity 0 dry friction
/// has no unique value; the result is 0.
///
/// # Example
/// ```
/// use quell_model::effects::{Effect, Motion, curve};
/// let stribeck = Effect::from_name("stribeck_friction").unwrap();
/// let found = curve(stribeck, &[2.0, 0.5, 0.1], &Motion::default(), &[-9.0, -1e-9, 0.0, 1e-9, 9.0]);
/// assert_eq!(found, Some(vec![-2.0, -3.0, 0.0, 3.0, 2.0]));
/// ```
pub fn curve(effect: &Effect, values: &[f64], at: &Motion, points: &[f64]) -> Option<Vec<f64>> {
    let (slot, law) = (effect.slot()?, (effect.law)(values));
    let value = |&point: &f64| value(slot, &law, at, point);
    points.iter().map(value).collect()
}

fn value(slot: Slot, law: &Law, at: &Motion, point: f64) -> Option<f64> {
    let now = Motion { time: point, ..*at };
    let driven = |motor: [f64; 2]| Motion { motor, ..*at };
    Some(match (slot, law) {
        (Slot::Spring | Slot::PositionForce, Law::Force(law)) => held(law.as_ref(), at, point),
        (Slot::Hysteresis, Law::Force(law)) => law.force(at, point, 0.0, &Memory::default()),
        (Slot::Friction, Law::Force(law)) => law.force(at, 0.0, point, &Memory::default()),
        (Slot::Friction, Law::Friction(_)) if point == 0.0 => 0.0,
        (Slot::Friction, Law::Friction(law)) => {
            point.signum() * law.level(point.signum(), 0.0, point.abs())
        }
        (Slot::Damping, Law::Force(law)) => {
            let force = |v: f64| law.force(at, point, v, &Memory::default());
            force(1.0) - force(0.0)
        }
        (Slot::PositionFriction, Law::Friction(law)) => law.level(1.0, point, 0.0),
        (Slot::PositionDamping, Law::Force(law)) => law.force(at, point, 1.0, &Memory::default()),
        (Slot::StiffnessDrift, Law::Force(law)) => {
            law.force(&now, 1.0, 0.0, &Memory::default()) / at.stiffness
        }
        (Slot::SpeedStiffness, Law::Force(law)) => {
            law.force(&driven([0.0, point]), 1.0, 0.0, &Memory::default()) / at.stiffness
        }
        (Slot::JointStiffness, Law::Force(law)) => {
            law.force(&driven([point, 0.0]), 1.0, 0.0, &Memory::default()) / at.stiffness
        }
        (Slot::JointDamping, Law::Force(law)) => {
            law.force(&driven([point, 0.0]), 0.0, 1.0, &Memory::default())
        }
        (Slot::TransmissionError, Law::Kinematic(law)) => law(point)[0],
        (Slot::DampingDrift, Law::Force(law)) => law.force(&now, 0.0, 1.0, &Memory::default()),
        (Slot::Drive, Law::Drive(law)) => law.map(point) - point,
        (Slot::Inertia, Law::Inertia(law)) => law.factor(at.time, point) - 1.0,
        (Slot::Sensor, Law::Sensor(law)) => law.read(&reading(at, point)) - point,
        (Slot::SensorDrift, Law::Sensor(law)) => law.read(&reading(&now, 0.0)),
        (Slot::Clock, Law::Sensor(law)) => law.instant(point) - point,
        _ => return None,
    })
}

/// The force at rest at a point; a contact has the branch of that point.
fn held(law: &dyn Force, at: &Motion, point: f64) -> f64 {
    let mut memory = Memory {
        time: at.time,
        position: point,
        ..Memory::default()
    };
    law.remember(at, point, 0.0, &mut memory);
    law.force(at, point, 0.0, &memory)
}

fn reading(at: &Motion, value: f64) -> Reading {
    Reading {
        time: at.time,
        value,
        motor: at.motor[0],
        tracked: false,
    }
}
