//! The start of a motion: in equilibrium with the motor side, or held by friction.

use super::chain::{Chain, MotorSide, State, coordinate};
use super::departure::{
    Departure,
    StartComponent::{Deformation, DeformationRate, Mode, ModeRate, MotorPosition, MotorVelocity},
};
use super::experiment::Experiment;
use super::further_modes::FurtherModes;
use super::piecewise::Grid;
use crate::effects::Memory;

/// The state at the first node, and the start of further modes: in equilibrium with the motor side, plus the departure.
///
/// Friction holds a link anywhere in a band about the equilibrium without friction: the departure says where. A
/// link whose motor side rests has the velocity 0 exactly, so that it sticks there.
pub(super) fn start(
    chain: &mut Chain,
    grid: &Grid,
    experiment: &Experiment,
    departure: &Departure,
) -> (State, FurtherModes) {
    let mut state: State = [0.0; 4];
    let input = grid.input.first().map_or([0.0; 3], |cubic| cubic.at(0.0));
    state[0] = experiment.initial[0] + departure[MotorPosition];
    state[1] = experiment.initial[1] + departure[MotorVelocity];
    let (motion, _) = chain.motion(grid.time[0], &state, input);
    state[2] = motion.motor[0] + experiment.initial[2];
    state[3] = motion.motor[1] + experiment.initial[3];
    if matches!(chain.linear.motor, MotorSide::Prescribed) {
        state[2] += equilibrium(chain, grid.time[0], &state, input);
        state[3] = match rests(chain, experiment) {
            true => 0.0,
            false => motion.motor[1],
        };
    }
    state[2] += departure[Deformation];
    state[3] += departure[DeformationRate];
    let modes = FurtherModes {
        rest: motion.motor,
        departures: std::array::from_fn(|k| [departure[Mode(k)], departure[ModeRate(k)]]),
        ..FurtherModes::default()
    };
    (state, modes)
}

/// Whether the motor side rests over the first radian of the mode: the slope of its recorded positions is within three
/// standard deviations of what their jitter makes of none. The rate of the first samples is then that of their
/// noise or rounding, and would make the link ring.
///
/// The jitter has a sixth of the mean square of the second differences; the slope of `n` positions `h` apart has
/// the variance `12 / (n^3 h^2)` of it.
fn rests(chain: &Chain, experiment: &Experiment) -> bool {
    let inertia = chain.linear.link.map_or(0.0, |link| link.0);
    let time = &experiment.input_time;
    let until = time[0] + (inertia / chain.linear.stiffness).sqrt();
    let first = &experiment.input_values[..time.partition_point(|time| *time <= until)];
    let n = first.len() as f64;
    let (mut slope, mut jitter) = (0.0, 0.0);
    for (k, value) in first.iter().enumerate() {
        slope += (k as f64 - 0.5 * (n - 1.0)) * value * 12.0 / (n * (n * n - 1.0));
    }
    for three in first.windows(3) {
        jitter += (three[0] - 2.0 * three[1] + three[2]).powi(2) / (6.0 * (n - 2.0));
    }
    // Three have but one second difference.
    n > 3.0 && slope * slope <= 9.0 * jitter * 12.0 / (n * n * n)
}

/// Deformation in equilibrium without friction, by false position; 0 where there is none.
fn equilibrium(chain: &mut Chain, time: f64, state: &State, input: [f64; 3]) -> f64 {
    let stiffness = chain.linear.stiffness;
    if chain.forces.is_empty() || stiffness == 0.0 {
        return 0.0;
    }
    let frictions = std::mem::take(&mut chain.frictions);
    let inertia = chain.linear.link.map_or(1.0, |link| link.0);
    let still = [input[0], 0.0, 0.0];
    let found = zero(
        |d| {
            let mut state = *state;
            state[2] += d;
            state[3] = 0.0;
            settle(chain, time, &state, still);
            chain.instant(time, &state, still).link * inertia
        },
        stiffness,
    );
    for element in &mut chain.forces {
        element.memory = Memory::default();
    }
    chain.frictions = frictions;
    found
}

/// Gives the forces the memories of a chain that has come to rest at a state: the flank of a gap that it lies on.
fn settle(chain: &mut Chain, time: f64, state: &State, still: [f64; 3]) {
    let (motion, _) = chain.motion(time, state, still);
    for index in 0..chain.forces.len() {
        let attachment = chain.attachment(chain.forces[index].place);
        let [x, v] = coordinate(attachment, &motion);
        let element = &mut chain.forces[index];
        element.memory = Memory {
            time,
            position: x,
            ..Memory::default()
        };
        element.law.remember(&motion, x, v, &mut element.memory);
    }
}

/// The zero next to 0 of a force that falls on the whole, about as `-stiffness x`; it may be constant in places.
fn zero(mut force: impl FnMut(f64) -> f64, stiffness: f64) -> f64 {
    /// Doublings until the bracket is given up: a softening by 2^40 is no spring.
    const DOUBLINGS: usize = 40;
    let (mut low, mut at_low) = (0.0, force(0.0));
    let mut step = at_low / stiffness;
    if step == 0.0 || !step.is_finite() {
        return 0.0;
    }
    let ends = (0..DOUBLINGS).find_map(|_| {
        let (high, at_high) = (low + step, force(low + step));
        if at_high * at_low <= 0.0 {
            return Some((high, at_high));
        }
        (low, at_low) = (high, at_high);
        step *= 2.0;
        None
    });
    let Some((mut high, mut at_high)) = ends else {
        return 0.0;
    };
    // Illinois: in the long run each round at least halves the bracket; a few are usual.
    for _ in 0..100 {
        if at_high == 0.0 || (high - low).abs() <= 1e-14 * high.abs() {
            break;
        }
        let middle = (low * at_high - high * at_low) / (at_high - at_low);
        let value = force(middle);
        match value * at_high > 0.0 {
            true => at_low *= 0.5,
            false => (low, at_low) = (high, at_high),
        }
        (high, at_high) = (middle, value);
    }
    high
}
