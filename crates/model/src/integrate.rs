//! Integration of a chain: Runge-Kutta of fourth order between events and given instants.

use super::chain::{Chain, MotorSide, State};
use super::piecewise::Grid;
use super::runge_kutta::Span;
use super::stepper::Stepper;
use super::trace::Trace;
use crate::effects::Impulse;
use std::collections::VecDeque;

/// An instant at which the motion is restarted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// When, s.
    pub time: f64,
    /// Position and velocity of the motor side, and of the link.
    pub state: [f64; 4],
}

/// The instants at which the motion is not smooth, in any order.
#[derive(Clone, Debug, Default)]
pub struct Timed {
    /// Instants at which a law jumps, s.
    pub breaks: Vec<f64>,
    /// Impulses on the link.
    pub impulses: Vec<Impulse>,
    /// Restarts of the motion.
    pub restarts: Vec<Restart>,
}

/// An event at an instant.
#[derive(Clone, Copy)]
enum Stop {
    Break,
    Kick(f64),
    Restart([f64; 4]),
    Tick,
}

/// Simulates the chain over the grid from a state at its first node.
///
/// Smooth chains err by the fourth power of the step; steps end where friction stops to slide or to
/// stick, where a force has a corner, where the input has a node and where something happens at a
/// given time. Each such end is a node of the trace: between two nodes the motion is smooth. Allocates the
/// trace and nothing else.
pub fn integrate(chain: &mut Chain, grid: &Grid, state: State, timed: &Timed) -> Trace {
    let trace = Trace::of(chain, grid.input.len() + 1);
    let Some(mut journey) = Journey::new(chain, grid, state, timed, trace) else {
        return Trace::default();
    };
    (0..grid.input.len()).for_each(|k| journey.step(k));
    journey.end()
}

/// [`integrate`] in parts of about `nodes` nodes, the last one marked `true`, so that a long motion need not be
/// kept in memory. A part begins with the last [`OVERLAP`] nodes of the one before.
pub(super) fn integrate_in_parts(
    chain: &mut Chain,
    grid: &Grid,
    state: State,
    timed: &Timed,
    nodes: usize,
    mut see: impl FnMut(&Trace, bool),
) {
    let room = nodes.min(grid.input.len() + 1) + MOST_NODES;
    let trace = Trace::of(chain, room);
    let Some(mut journey) = Journey::new(chain, grid, state, timed, trace) else {
        return see(&Trace::default(), true);
    };
    for k in 0..grid.input.len() {
        journey.step(k);
        if journey.trace.time.len() >= nodes.max(2 * OVERLAP) {
            see(&journey.trace, false);
            journey.trace.keep_last(OVERLAP);
        }
    }
    see(&journey.end(), true);
}

/// Number of nodes that two parts of a motion share. A value without a slope of its own needs a node on either
/// side: its slope is known at the last node but one of a part, and at the second node of the next.
pub(super) const OVERLAP: usize = 3;

/// Nodes of a step for which a part has room: its ends, and the usual number of events.
const MOST_NODES: usize = 16;

/// The integration in progress over the grid.
struct Journey<'a> {
    stepper: Stepper<'a>,
    grid: &'a Grid,
    state: State,
    ticks: Ticks,
    /// Events at given instants, in order.
    stops: Vec<(f64, Stop)>,
    /// Index of the next one.
    next: usize,
    trace: Trace,
}

impl<'a> Journey<'a> {
    /// Starts at the first node; `None` where the grid has no step.
    fn new(
        chain: &'a mut Chain,
        grid: &'a Grid,
        state: State,
        timed: &Timed,
        trace: Trace,
    ) -> Option<Self> {
        let span = Span {
            t0: grid.time[0],
            from: grid.time[0],
            last: *grid.time.get(1)?,
            input: grid.input.first()?,
        };
        let lasting = timed.impulses.iter().filter(|own| own.duration > 0.0);
        chain.impulses = lasting.copied().collect();
        let stops = stops(chain, grid, timed);
        let ticks = Ticks::new(chain, &state);
        Some(Self {
            stepper: Stepper::new(chain, &span, &state, grid.time[1] - grid.time[0]),
            grid,
            state,
            ticks,
            stops,
            next: 0,
            trace,
        })
    }

    /// One step of the grid.
    #[inline]
    fn step(&mut self, k: usize) {
        let (t0, t1) = (self.grid.time[k], self.grid.time[k + 1]);
        if let Some(pull) = &mut self.stepper.chain.pull {
            pull.go_to(k, t0);
        }
        let mut span = Span {
            t0,
            from: t0,
            last: t1,
            input: &self.grid.input[k],
        };
        loop {
            let stop = self.happen(&span);
            let instant = self.stepper.settle(&self.state, &span);
            self.trace.push(&instant, &span);
            let to = stop.min(t1);
            // An event at the end of a step has not happened within it.
            span.last = if stop <= t1 { to.next_down() } else { to };
            let (state, trace) = (&mut self.state, &mut self.trace);
            self.stepper.advance(state, span, to, instant, trace);
            if to == t1 {
                return;
            }
            (span.from, span.last) = (to, t1);
        }
    }

    /// Applies the events at the start of a span; returns the time of the next one.
    #[inline]
    fn happen(&mut self, span: &Span) -> f64 {
        loop {
            let Some(&(time, stop)) = self.stops.get(self.next) else {
                return f64::INFINITY;
            };
            if time > span.from {
                return time;
            }
            self.next += 1;
            if matches!(stop, Stop::Kick(_) | Stop::Restart(_)) && !self.trace.time.is_empty() {
                let mut before = self.stepper.settle(&self.state, span);
                before.motion.time = span.from.next_down();
                self.trace.push(&before, span);
            }
            let (chain, state) = (&mut *self.stepper.chain, &mut self.state);
            match stop {
                Stop::Break => {}
                Stop::Kick(size) => *state = kicked(chain, span.from, *state, size),
                Stop::Restart(anew) => *state = anew,
                Stop::Tick => self.ticks.tick(chain, state, span.at(0.0).1[0]),
            }
        }
    }

    /// Adds the last node.
    fn end(mut self) -> Trace {
        let steps = self.grid.input.len();
        let span = Span {
            t0: self.grid.time[steps - 1],
            from: self.grid.time[steps],
            last: self.grid.time[steps],
            input: &self.grid.input[steps - 1],
        };
        let instant = self.stepper.settle(&self.state, &span);
        self.trace.push(&instant, &span);
        self.trace
    }
}

/// All instants from the first node on, in order.
fn stops(chain: &Chain, grid: &Grid, timed: &Timed) -> Vec<(f64, Stop)> {
    let breaks = timed.breaks.iter().map(|&time| (time, Stop::Break));
    let short = timed.impulses.iter().filter(|own| own.duration <= 0.0);
    let kicks = short.map(|own| (own.time, Stop::Kick(own.size)));
    let ends = chain.impulses.iter().flat_map(|own| {
        let half = 0.5 * own.duration;
        [own.time - half, own.time + half].map(|time| (time, Stop::Break))
    });
    let anew = |restart: &Restart| (restart.time, Stop::Restart(restart.state));
    let restarts = timed.restarts.iter().map(anew);
    let mut stops: Vec<_> = breaks.chain(kicks).chain(ends).chain(restarts).collect();
    stops.retain(|stop| stop.0 >= grid.time[0]);
    if let Some(period) = period(chain) {
        let (mut node, mut tick) = (0, 0);
        loop {
            let mut time = grid.time[0] + f64::from(tick) * period;
            while grid
                .time
                .get(node)
                .is_some_and(|&at| at < time - SNAP * period)
            {
                node += 1;
            }
            let Some(&at) = grid.time.get(node) else {
                break;
            };
            // The controller read a sample at its stamp, which has been rounded.
            if (at - time).abs() <= SNAP * period {
                time = at;
            }
            stops.push((time, Stop::Tick));
            tick += 1;
        }
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    stops
}

/// Largest difference of stamps from a controller's ticks, as a share of its period.
const SNAP: f64 = 1e-3;

/// Period of the loop that is sampled.
fn period(chain: &Chain) -> Option<f64> {
    let position_loop = chain.linear.position_loop?;
    (position_loop.sample_time > 0.0).then_some(position_loop.sample_time)
}

/// The state after an impulse at a time.
fn kicked(chain: &Chain, time: f64, mut state: State, size: f64) -> State {
    let body = if chain.linear.link.is_some() { 2 } else { 0 };
    let factors = chain
        .inertias
        .iter()
        .map(|own| own.factor(time, state[body]));
    state[body + 1] += size / factors.product::<f64>();
    state
}

/// A sampled position loop: its readings at the last ticks.
struct Ticks {
    /// Positions, the oldest first.
    before: VecDeque<f64>,
}

impl Ticks {
    /// Before the first tick the velocity is taken as constant.
    fn new(chain: &Chain, state: &State) -> Self {
        let (period, span) = match chain.linear.position_loop {
            Some(own) if own.sample_time > 0.0 => (own.sample_time, own.velocity_span),
            _ => (1.0, 0.0),
        };
        let count = (span / period).round().clamp(1.0, MOST_PERIODS) as u32;
        let ago = |k: u32| state[0] - f64::from(k) * period * state[1];
        Self {
            before: (1..=count).rev().map(ago).collect(),
        }
    }

    fn tick(&mut self, chain: &mut Chain, state: &State, reference: f64) {
        let Some(position_loop) = chain.linear.position_loop else {
            return;
        };
        if let MotorSide::Free { .. } = chain.linear.motor {
            let span = self.before.len() as f64 * position_loop.sample_time;
            let oldest = self.before.pop_front().unwrap_or(state[0]);
            let rate = (state[0] - oldest) / span;
            chain.held = Some(chain.put_out(&position_loop, reference, [state[0], rate]));
            self.before.push_back(state[0]);
        }
    }
}

/// Longest time of the velocity difference of a sampled loop, in periods.
const MOST_PERIODS: f64 = 1000.0;
