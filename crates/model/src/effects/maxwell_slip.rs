//! Hysteresis of any shape: elasto-plastic elements in parallel.

use super::learned::{ordinate, parameters, split, start};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, STATES, Slot};

/// Elements, and the ends of the range of their slip distances.
const PARAMETERS: usize = STATES + 2;

/// Ratio of longest to shortest slip distance: a factor of 2 from each to the next.
const RANGE: f64 = 128.0;

/// Remaining part of a slip distance that counts as slipping: rounding.
const ROUNDING: f64 = 1e-12;

struct MaxwellSlip {
    stiffness: [f64; STATES],
    /// Deflection at which each element slips.
    slip: [f64; STATES],
}

/// Slip distances of the elements for values of the parameters, in a geometric series. If the range does not
/// begin above 0, it begins at the usual value.
pub(crate) fn slip_distances(values: &[f64]) -> [f64; STATES] {
    let (_, from, to) = split(values);
    let from = if from > 0.0 { from } else { to / RANGE };
    let factor = (to / from).powf(1.0 / (STATES - 1) as f64);
    std::array::from_fn(|k| {
        let distance = from * factor.powi(k as i32);
        // An element with an invalid distance bears no force.
        if distance.is_finite() {
            distance.max(0.0)
        } else {
            0.0
        }
    })
}

impl MaxwellSlip {
    fn new(values: &[f64]) -> Self {
        let mut stiffness = [0.0; STATES];
        let ordinates = split(values).0.iter();
        stiffness
            .iter_mut()
            .zip(ordinates)
            .for_each(|(own, given)| *own = *given);
        Self {
            stiffness,
            slip: slip_distances(values),
        }
    }

    /// Deflection of an element after a distance in one direction.
    fn deflection(&self, k: usize, x: f64, memory: &Memory) -> f64 {
        let slip = self.slip[k];
        (memory.states[k] + (x - memory.position)).clamp(-slip, slip)
    }
}

impl Force for MaxwellSlip {
    fn force(&self, _motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        let force = |k: usize| self.stiffness[k] * self.deflection(k, x, memory);
        (0..STATES).map(force).sum()
    }

    /// Deflections in [`Memory::states`], exact for a step in one direction; [`Memory::state`] is that direction.
    fn remember(&self, motion: &Motion, x: f64, v: f64, memory: &mut Memory) {
        let before = *memory;
        for k in 0..STATES {
            memory.states[k] = self.deflection(k, x, &before);
        }
        if v != 0.0 {
            memory.state = v.signum();
        }
        (memory.position, memory.time) = (x, motion.time);
    }

    /// Positive until the next element starts to slip, or a slipping one reverses.
    fn switch(&self, _motion: &Motion, x: f64, v: f64, memory: &Memory) -> Option<f64> {
        let (travel, sense) = (x - memory.position, memory.state);
        let mut left: Option<f64> = None;
        let mut note = |value: f64| left = Some(left.map_or(value, |left| left.min(value)));
        for k in (0..STATES).filter(|&k| self.stiffness[k] != 0.0) {
            for side in [1.0, -1.0] {
                let room = self.slip[k] - side * memory.states[k];
                match room > ROUNDING * self.slip[k] {
                    true => note(room - side * travel),
                    false if side == sense => note(sense * v),
                    false => {}
                }
            }
        }
        left
    }
}

/// Elasto-plastic elements in parallel: each is a spring `k_i` in series with dry friction that slips beyond a
/// deflection `r_i`, so that the force is `sum k_i z_i`, `z_i` the deflection within `[-r_i, r_i]`.
pub const MAXWELL_SLIP: Effect = Effect {
    name: "maxwell_slip",
    title: "Maxwell slip",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Elements in parallel, each a spring that slips beyond a deflection r_i: the stop operators of Prandtl and \
        Ishlinskii. The slip distances are fixed, each twice the one before, up to the largest deformation, or at drive and link up to a tenth of the travel; the \
        stiffness k_i of each is learned and not below 0, so that every loop takes energy away. Any hysteresis that \
        follows Masing's rules, whatever the speed, is such a sum. Source: Prandtl, ZAMM 8 (1928); Ishlinskii, \
        Izvestiya Akademii Nauk SSSR OTN 9 (1944); Al-Bender, Lampaert, Swevers, IEEE Trans. Automatic Control \
        50 (2005).",
    remedy: "Expect the position to depend on the way it was reached; approach from one side, or model the loop.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(
            Quantity::new(1, -1, 0),
            |scales| (0.0, 10.0 * scales.force / scales.deformation),
            |scales| 0.05 * scales.force / scales.deformation,
        ),
        Quantity::POSITION,
    ),
    properties: &[Property::Slot(Slot::Hysteresis)],
    law: |p| Law::Force(Box::new(MaxwellSlip::new(p))),
    starts: |scales| {
        let (from, to) = scales.visited_motor_position();
        let (shortest, longest) = scales.visited_deformation();
        // Of what slides along the travel, more than a tenth of it is a force over the position.
        let along = 0.1 * (to - from);
        [along, longest.max(-shortest), along]
            .map(|largest| start::<PARAMETERS>((largest / RANGE, largest)))
            .to_vec()
    },
};
