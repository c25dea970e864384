//! Integration of a chain: Runge-Kutta of fourth order between events and instants.

use super::chain::{Chain, MotorSide, State};
use super::piecewise::Grid;
use super::runge_kutta::Span;
use super::stepper::Stepper;
use super::trace::Trace;
use std::collections::VecDeque;

/// An impulse on the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// When, s.
    pub time: f64,
    /// Jump of the velocity of the link; of the motor side where there is none.
    pub size: f64,
}

/// An instant at which the motion starts anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// When, s.
    pub time: f64,
    /// Position and velocity of the motor side, and of the link.
    pub state: [f64; 4],
}

/// The instants at which something is not smooth, in any order.
#[derive(Clone, Debug, Default)]
pub struct Timed {
    /// Instants at which a law jumps, s.
    pub breaks: Vec<f64>,
    /// Impulses on the link.
    pub kicks: Vec<Kick>,
    /// Where the motion starts anew.
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
    let mut trace = Trace::with_capacity(grid.input.len() + 1, !chain.resonances.is_empty());
    motion(chain, grid, state, timed, &mut trace, |_| ());
    trace
}

/// [`integrate`], shown in parts of about `nodes` nodes, the last one with `true`: so that a long motion
/// need not be held. A part begins with the [`OVERLAP`] nodes that ended the one before.
pub(super) fn integrate_in_parts(
    chain: &mut Chain,
    grid: &Grid,
    state: State,
    timed: &Timed,
    nodes: usize,
    mut see: impl FnMut(&Trace, bool),
) {
    let room = nodes.min(grid.input.len() + 1) + MOST_NODES;
    let mut trace = Trace::with_capacity(room, !chain.resonances.is_empty());
    motion(chain, grid, state, timed, &mut trace, |trace| {
        if trace.time.len() >= nodes.max(2 * OVERLAP) {
            see(trace, false);
            trace.keep_last(OVERLAP);
        }
    });
    see(&trace, true);
}

/// Nodes that two parts of a motion share. The slope of a value that has none of its own is known where
/// there is a node on either side: the last but one of a part, and the second of the next.
pub(super) const OVERLAP: usize = 3;

/// Nodes of a step for which a part has room: its ends, and events as a rule.
const MOST_NODES: usize = 16;

/// Appends the motion to a trace, `after` each step.
fn motion(
    chain: &mut Chain,
    grid: &Grid,
    mut state: State,
    timed: &Timed,
    trace: &mut Trace,
    mut after: impl FnMut(&mut Trace),
) {
    let steps = grid.input.len();
    let Some(first) = grid.input.first() else {
        return;
    };
    let stops = stops(chain, grid, timed);
    let mut ticks = Ticks::new(chain, &state);
    let span = Span {
        t0: grid.time[0],
        from: grid.time[0],
        last: grid.time[1],
        input: first,
    };
    let mut stepper = Stepper::new(chain, &span, &state, grid.time[1] - grid.time[0]);
    let mut next = 0;
    for k in 0..steps {
        let (t0, t1) = (grid.time[k], grid.time[k + 1]);
        let mut span = Span {
            t0,
            from: t0,
            last: t1,
            input: &grid.input[k],
        };
        let mut happen =
            |stepper: &mut Stepper, state: &mut State, span: &Span, trace: &mut Trace| {
                while let Some(&(time, stop)) = stops.get(next).filter(|stop| stop.0 <= span.from) {
                    debug_assert!(time <= span.from);
                    if matches!(stop, Stop::Kick(_) | Stop::Restart(_)) && !trace.time.is_empty() {
                        let mut before = stepper.settle(state, span);
                        before.motion.time = span.from.next_down();
                        trace.push(&before, state);
                    }
                    match stop {
                        Stop::Break => {}
                        Stop::Kick(size) => *state = kicked(stepper.chain, *state, size),
                        Stop::Restart(anew) => state[..4].copy_from_slice(&anew),
                        Stop::Tick => ticks.tick(stepper.chain, state, span.at(0.0).1[0]),
                    }
                    next += 1;
                }
                stops.get(next).map_or(f64::INFINITY, |stop| stop.0)
            };
        let mut stop = happen(&mut stepper, &mut state, &span, trace);
        let mut instant = stepper.settle(&state, &span);
        trace.push(&instant, &state);
        loop {
            let to = stop.min(t1);
            // What happens at the end of a step has not happened within it.
            span.last = if stop <= t1 { to.next_down() } else { to };
            stepper.advance(&mut state, span, to, instant, trace);
            if to == t1 {
                break;
            }
            (span.from, span.last) = (to, t1);
            stop = happen(&mut stepper, &mut state, &span, trace);
            instant = stepper.settle(&state, &span);
            trace.push(&instant, &state);
        }
        after(trace);
    }
    let span = Span {
        t0: grid.time[steps - 1],
        from: grid.time[steps],
        last: grid.time[steps],
        input: &grid.input[steps - 1],
    };
    trace.push(&stepper.settle(&state, &span), &state);
}

/// All instants from the first node on, in order.
fn stops(chain: &Chain, grid: &Grid, timed: &Timed) -> Vec<(f64, Stop)> {
    let breaks = timed.breaks.iter().map(|&time| (time, Stop::Break));
    let kicks = timed
        .kicks
        .iter()
        .map(|kick| (kick.time, Stop::Kick(kick.size)));
    let anew = |restart: &Restart| (restart.time, Stop::Restart(restart.state));
    let restarts = timed.restarts.iter().map(anew);
    let mut stops: Vec<_> = breaks.chain(kicks).chain(restarts).collect();
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
            // The tick that took a sample is at the sample's stamp, which has been rounded.
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

/// Share of a controller's period by which stamps may be off its ticks.
const SNAP: f64 = 1e-3;

/// Period of the loop that is sampled.
fn period(chain: &Chain) -> Option<f64> {
    let position_loop = chain.linear.position_loop?;
    (position_loop.sample_time > 0.0).then_some(position_loop.sample_time)
}

fn kicked(chain: &Chain, mut state: State, size: f64) -> State {
    match chain.linear.link {
        Some(_) => state[3] += size,
        None => state[1] += size,
    }
    state
}

/// A sampled position loop: what it saw at its last ticks.
struct Ticks {
    /// Positions, the oldest first.
    before: VecDeque<f64>,
}

impl Ticks {
    /// Before the first tick the axis moved as it does then.
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

/// Longest difference of a sampled loop, in periods: what is longer is no velocity.
const MOST_PERIODS: f64 = 1000.0;
