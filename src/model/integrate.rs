//! Integration of a chain: Runge-Kutta of fourth order between events.
//!
//! A step ends where friction stops to slide or to stick, where a force has a corner and where
//! something happens at a given time; between them everything is smooth. Source: Hairer, Norsett,
//! Wanner, Solving Ordinary Differential Equations I, section II.6.

use super::chain::{Chain, Instant, MotorSide, State, coordinate};
use super::piecewise::{Cubic, Grid};
use super::trace::Trace;

/// Events in one step, above which the step is taken as it is: a chattering contact.
const MOST_EVENTS: usize = 16;

/// An impulse on the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// When, s.
    pub time: f64,
    /// Jump of the link's velocity.
    pub size: f64,
}

/// What is not smooth at which time.
#[derive(Clone, Debug, Default)]
pub struct Timed {
    /// Instants at which a law jumps, s, increasing.
    pub breaks: Vec<f64>,
    /// Impulses on the link, increasing in time.
    pub kicks: Vec<Kick>,
}

/// Simulates the chain over the grid from a state at its first node.
pub fn integrate(chain: &mut Chain, grid: &Grid, mut state: State, timed: &Timed) -> Trace {
    let steps = grid.input.len();
    let mut trace = Trace::with_capacity(steps + 1);
    let smooth = chain.forces.is_empty() && chain.frictions.is_empty();
    let mut instants = timed.breaks.clone();
    instants.extend(timed.kicks.iter().map(|kick| kick.time));
    instants.sort_by(f64::total_cmp);
    let mut next = 0;
    for k in 0..steps {
        let (t0, t1, input) = (grid.time[k], grid.time[k + 1], &grid.input[k]);
        if k == 0 {
            start(chain, t0, &state, input.at(0.0));
        }
        trace.push(&chain.instant(t0, &state, input.at(0.0)), &state);
        let mut from = t0;
        while instants.get(next).is_some_and(|&t| t < t1) {
            let at = instants[next].max(from);
            step(chain, &mut state, t0, from, at, input, smooth);
            for kick in timed
                .kicks
                .iter()
                .filter(|kick| kick.time == instants[next])
            {
                if at >= t0 && instants[next] >= grid.time[0] {
                    state[3] += kick.size;
                }
            }
            (from, next) = (at, next + 1);
        }
        step(chain, &mut state, t0, from, t1, input, smooth);
    }
    if let (Some(last), Some(&time)) = (grid.input.last(), grid.time.last()) {
        let s = time - grid.time[steps - 1];
        trace.push(&chain.instant(time, &state, last.at(s)), &state);
    }
    trace
}

/// Friction sticks or slides, memories begin.
fn start(chain: &mut Chain, time: f64, state: &State, input: [f64; 3]) {
    let (motion, _) = chain.motion(time, state, input);
    for element in &mut chain.forces {
        element.memory.time = time;
        element.memory.position = coordinate(element.place, &motion)[0];
    }
    for index in 0..chain.frictions.len() {
        let velocity = coordinate(chain.frictions[index].place, &motion)[1];
        chain.frictions[index].slides = if velocity == 0.0 {
            0.0
        } else {
            velocity.signum()
        };
        if velocity == 0.0 {
            release(chain, index, time, state, input);
        }
    }
}

/// Lets a friction at rest slide if what holds it is exceeded.
fn release(chain: &mut Chain, index: usize, time: f64, state: &State, input: [f64; 3]) {
    let force = chain.holding_force(index, time, state, input);
    let side = usize::from(force < 0.0);
    let element = &mut chain.frictions[index];
    element.slides = match force.abs() > element.law.breakaway[side] {
        true => force.signum(),
        false => 0.0,
    };
}

/// From `from` to `to` within the step that starts at `t0`.
fn step(
    chain: &mut Chain,
    state: &mut State,
    t0: f64,
    from: f64,
    to: f64,
    input: &Cubic,
    smooth: bool,
) {
    if to <= from {
        return;
    }
    if smooth {
        *state = runge_kutta(chain, state, t0, from, to - from, input);
        return;
    }
    let (mut now, mut events) = (from, 0);
    while now < to {
        let whole = to - now;
        let end = runge_kutta(chain, state, t0, now, whole, input);
        let found = (events < MOST_EVENTS)
            .then(|| first_event(chain, state, &end, t0, now, to, input))
            .flatten();
        let Some((event, fraction)) = found else {
            accept(chain, state, end, t0, now, to, input);
            return;
        };
        let length = locate(chain, state, event, fraction, t0, now, whole, input);
        let end = runge_kutta(chain, state, t0, now, length, input);
        let then = now + length;
        accept(chain, state, end, t0, now, then, input);
        if let Event::Friction(index) = event {
            turn(chain, index, state, then, input.at(then - t0));
        }
        // Never a step so short that time stands still.
        now = then.max(now + whole * 1e-9);
        events += 1;
    }
}

#[derive(Clone, Copy)]
enum Event {
    Friction(usize),
    Corner(usize),
}

/// Value whose fall through zero is the event, at a state.
fn margin(
    chain: &Chain,
    event: Event,
    state: &State,
    time: f64,
    input: [f64; 3],
    sign: f64,
) -> f64 {
    let (motion, _) = chain.motion(time, state, input);
    match event {
        Event::Friction(index) => {
            let element = &chain.frictions[index];
            if element.slides == 0.0 {
                let force = chain.holding_force(index, time, state, input);
                element.law.breakaway[usize::from(force < 0.0)] - force.abs()
            } else {
                element.slides * coordinate(element.place, &motion)[1]
            }
        }
        Event::Corner(index) => {
            let element = &chain.forces[index];
            let [x, v] = coordinate(element.place, &motion);
            sign * element.law.switch(x, v).unwrap_or(sign)
        }
    }
}

/// The event that comes first in the step, and where in it, by linear interpolation.
fn first_event(
    chain: &Chain,
    state: &State,
    end: &State,
    t0: f64,
    now: f64,
    to: f64,
    input: &Cubic,
) -> Option<(Event, f64)> {
    let frictions = (0..chain.frictions.len()).map(Event::Friction);
    let corners = (0..chain.forces.len()).map(Event::Corner);
    let mut first: Option<(Event, f64)> = None;
    for event in frictions.chain(corners) {
        let sign = sign_of(chain, event, state, now, input.at(now - t0));
        let before = margin(chain, event, state, now, input.at(now - t0), sign);
        let after = margin(chain, event, end, to, input.at(to - t0), sign);
        if after < 0.0 && sign != 0.0 {
            // A margin that is zero at the start has just been an event: it is not one again.
            let fraction = before.max(0.0) / (before.max(0.0) - after);
            let again = before <= 0.0 && matches!(event, Event::Corner(_));
            if !again && first.is_none_or(|(_, earliest)| fraction < earliest) {
                first = Some((event, fraction));
            }
        }
    }
    first
}

/// The sign that a corner's switch has at the start; 1 for friction.
fn sign_of(chain: &Chain, event: Event, state: &State, time: f64, input: [f64; 3]) -> f64 {
    let Event::Corner(index) = event else {
        return 1.0;
    };
    let (motion, _) = chain.motion(time, state, input);
    let element = &chain.forces[index];
    let [x, v] = coordinate(element.place, &motion);
    match element.law.switch(x, v) {
        Some(value) if value != 0.0 => value.signum(),
        _ => 0.0,
    }
}

/// Length of the step that ends at the event: false position, improved twice.
fn locate(
    chain: &Chain,
    state: &State,
    event: Event,
    fraction: f64,
    t0: f64,
    now: f64,
    whole: f64,
    input: &Cubic,
) -> f64 {
    let sign = sign_of(chain, event, state, now, input.at(now - t0));
    let at = |length: f64| {
        let end = runge_kutta(chain, state, t0, now, length, input);
        margin(
            chain,
            event,
            &end,
            now + length,
            input.at(now + length - t0),
            sign,
        )
    };
    let (mut low, mut high) = (0.0, whole);
    let mut below = margin(chain, event, state, now, input.at(now - t0), sign).max(0.0);
    let mut above = below - below.max(f64::MIN_POSITIVE) / fraction.max(1e-12);
    let mut length = fraction * whole;
    for _ in 0..3 {
        let value = at(length);
        if value > 0.0 {
            (low, below) = (length, value);
        } else {
            (high, above) = (length, value);
        }
        if below - above <= 0.0 {
            break;
        }
        length = low + (high - low) * below / (below - above);
    }
    length.clamp(0.0, whole)
}

/// The step is taken: memories move on.
fn accept(
    chain: &mut Chain,
    state: &mut State,
    end: State,
    t0: f64,
    _now: f64,
    then: f64,
    input: &Cubic,
) {
    *state = end;
    if chain.forces.is_empty() {
        return;
    }
    let (motion, _) = chain.motion(then, state, input.at(then - t0));
    for element in &mut chain.forces {
        let [x, _] = coordinate(element.place, &motion);
        element.memory.state = element.law.advance(then, x, &element.memory);
        (element.memory.position, element.memory.time) = (x, then);
    }
}

/// Friction stops to slide, or to stick.
fn turn(chain: &mut Chain, index: usize, state: &mut State, time: f64, input: [f64; 3]) {
    let element = &chain.frictions[index];
    if element.slides == 0.0 {
        let force = chain.holding_force(index, time, state, input);
        chain.frictions[index].slides = force.signum();
        return;
    }
    let (motion, _) = chain.motion(time, state, input);
    use crate::effects::Place;
    match (element.place, chain.linear.motor) {
        (Place::Drive, MotorSide::Free { .. }) => state[1] = 0.0,
        (Place::Transmission, _) if chain.linear.link.is_some() => state[3] = motion.motor[1],
        _ if chain.linear.link.is_some() => state[3] = 0.0,
        _ => {}
    }
    release(chain, index, time, state, input);
}

fn derivative(chain: &Chain, instant: &Instant, state: &State) -> State {
    let mut slope = [0.0; size_of::<State>() / size_of::<f64>()];
    if matches!(chain.linear.motor, MotorSide::Free { .. }) {
        (slope[0], slope[1]) = (state[1], instant.motor);
    }
    if chain.linear.link.is_some() {
        (slope[2], slope[3]) = (state[3], instant.link);
    }
    for k in 0..chain.resonances.len().min(instant.modes.len()) {
        (slope[4 + 2 * k], slope[5 + 2 * k]) = (state[5 + 2 * k], instant.modes[k]);
    }
    slope
}

/// One step of the classical method.
fn runge_kutta(chain: &Chain, state: &State, t0: f64, from: f64, h: f64, input: &Cubic) -> State {
    let s = from - t0;
    let slope = |s: f64, state: &State| {
        derivative(chain, &chain.instant(t0 + s, state, input.at(s)), state)
    };
    let moved = |slope: &State, h: f64| {
        let mut moved = *state;
        for (x, v) in moved.iter_mut().zip(slope) {
            *x += h * v;
        }
        moved
    };
    let k1 = slope(s, state);
    let k2 = slope(s + h / 2.0, &moved(&k1, h / 2.0));
    let k3 = slope(s + h / 2.0, &moved(&k2, h / 2.0));
    let k4 = slope(s + h, &moved(&k3, h));
    let mut end = *state;
    for i in 0..end.len() {
        end[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    end
}
