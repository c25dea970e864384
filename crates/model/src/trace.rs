//! A simulated motion at the nodes of its grid and at its events between them.

use super::chain::{Chain, Instant};
use super::piecewise::Cubic;
use super::runge_kutta::Span;

/// Position, velocity and acceleration.
pub type Kinematics = [f64; 3];

/// A simulated motion; all series have one entry a node. At a jump of a velocity there are two nodes, a
/// rounding error apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Node times, s.
    pub time: Vec<f64>,
    /// Motor side, as an encoder sees it.
    pub motor: Vec<Kinematics>,
    /// Link; the motor side again where there is none.
    pub link: Vec<Kinematics>,
    /// Force of the drive on the motor side; where the link's position is the input, the force that holds it
    /// there.
    pub force: Vec<f64>,
    /// Position and velocity of the motor side as the transmission sees it; empty where that is what an encoder sees.
    pub transmitted: Vec<[f64; 2]>,
    /// The input from the node on; empty where it does not drive the link.
    pub input: Vec<Cubic>,
}

impl Trace {
    /// An empty one of a chain, with room for so many nodes.
    pub(super) fn of(chain: &Chain, nodes: usize) -> Self {
        let room = |needed: bool| if needed { nodes } else { 0 };
        Self {
            time: Vec::with_capacity(nodes),
            motor: Vec::with_capacity(nodes),
            link: Vec::with_capacity(nodes),
            force: Vec::with_capacity(nodes),
            transmitted: Vec::with_capacity(room(!chain.kinematics.is_empty())),
            input: Vec::with_capacity(room(chain.linear.link_gain != 0.0)),
        }
    }

    /// Adds the node at the start of a span, unless it is not later than the last one.
    pub(super) fn push(&mut self, instant: &Instant, span: &Span) {
        if self
            .time
            .last()
            .is_some_and(|last| *last >= instant.motion.time)
        {
            return;
        }
        let [u, v] = instant.encoder;
        let [y, rate] = instant.motion.link;
        self.time.push(instant.motion.time);
        self.motor.push([u, v, instant.motor]);
        self.link.push([y, rate, instant.link]);
        self.force.push(instant.force);
        if self.transmitted.capacity() > 0 {
            self.transmitted.push(instant.motion.motor);
        }
        if self.input.capacity() > 0 {
            self.input.push(span.input.shifted(span.from - span.t0));
        }
    }

    /// Drops all nodes but the last.
    pub(super) fn keep_last(&mut self, count: usize) {
        let gone = self.time.len().saturating_sub(count);
        self.time.drain(..gone);
        self.motor.drain(..gone);
        self.link.drain(..gone);
        self.force.drain(..gone);
        self.transmitted.drain(..gone.min(self.transmitted.len()));
        self.input.drain(..gone.min(self.input.len()));
    }
}

/// The value at `t` of the cubic through values and rates at two ends.
pub fn hermite(t0: f64, t1: f64, from: [f64; 2], to: [f64; 2], t: f64) -> f64 {
    let h = t1 - t0;
    let s = (t - t0) / h;
    let (a, b) = (h * from[1], h * to[1]);
    let rise = to[0] - from[0];
    let (c2, c3) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
    from[0] + s * (a + s * (c2 + s * c3))
}

/// Values with slopes from differences over both neighbours; next to a jump over one neighbour only.
pub(super) fn sloped(time: &[f64], values: Vec<f64>) -> Vec<[f64; 2]> {
    let last = values.len() - 1;
    let apart = |a: usize, b: usize| time[b] > time[a].next_up();
    (0..values.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            let (a, b) = (
                if apart(a, k) { a } else { k },
                if apart(k, b) { b } else { k },
            );
            let slope = (values[b] - values[a]) / (time[b] - time[a]);
            [values[k], if a < b { slope } else { 0.0 }]
        })
        .collect()
}
