//! Further modes: the motion drives them, and they do not act on it.
//!
//! ```text
//! eta'' = w^2 (u - eta) + 2 w (xi (u' - eta') + g (u' - y')) + b F
//! ```
//!
//! Motor side `u`, link `y` and input `F` are cubics between two nodes of the motion, so that `eta` is a power series there. A
//! mode may be faster than the steps of the motion: it has nodes of its own between them.
//! Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, section I.8, for the series.

use super::piecewise::{Cubic, RADIANS_A_STEP};
use super::trace::{Kinematics, Trace};
use crate::effects::Resonance;
use std::ops::RangeInclusive;

/// Most further modes whose start departs from that of the motor side.
pub const RESONANCES: usize = 2;

/// Radians of the fastest further mode between two nodes. It has a smaller amplitude than the first mode, so that twice the
/// step of that, with 16 times the relative error of a cubic between the nodes, is enough.
const RADIANS: f64 = 2.0 * RADIANS_A_STEP;

/// Most nodes of the modes in a step of the motion. The motion of a step is a cubic: a mode that turns by more than 50 radians in
/// it hardly rings, but follows.
const MOST: f64 = 100.0;

/// Last power of the series: what is left out changes the frequency by `RADIANS^8 / 9! = 1e-8` of it.
const ORDER: usize = 8;

/// The further modes of a chain.
#[derive(Clone, Debug, Default)]
pub struct FurtherModes {
    /// Their laws.
    pub laws: Vec<Resonance>,
    /// `b`: acceleration of the link by the input.
    pub link_gain: f64,
    /// Position and velocity of the motor side at the first node.
    pub rest: [f64; 2],
    /// Departures of the first modes from it.
    pub departures: [[f64; 2]; RESONANCES],
}

/// A quantity that sees further modes, at the nodes of a motion and at those that these need.
#[derive(Debug, Default)]
pub struct Seen {
    /// Times of the nodes, s.
    pub time: Vec<f64>,
    /// The quantity and its rate.
    pub curve: Vec<[f64; 2]>,
    /// The motor side, without its acceleration.
    pub motor: Vec<Kinematics>,
}

impl FurtherModes {
    /// Position and velocity of each mode at the first node.
    pub fn start(&self) -> Vec<[f64; 2]> {
        let departures = self
            .departures
            .into_iter()
            .chain(std::iter::repeat([0.0; 2]));
        let [u, v] = self.rest;
        let each = self.laws.iter().zip(departures);
        each.map(|(_, [position, rate])| [u + position, v + rate])
            .collect()
    }

    /// Adds the shares of the modes to a curve (values and rates at the nodes of a motion), between two nodes. Of the modes it
    /// sees the derivative of this order: 0 of a position. `states` are those at the first of the nodes, and become those at
    /// the last.
    pub fn seen(
        &self,
        trace: &Trace,
        nodes: RangeInclusive<usize>,
        (curve, order): (&[[f64; 2]], usize),
        states: &mut [[f64; 2]],
    ) -> Seen {
        let mut seen = Seen::default();
        let (first, last) = nodes.into_inner();
        let fastest = self.laws.iter().map(|law| law.natural_frequency);
        let step = RADIANS / fastest.fold(0.0, f64::max);
        for k in first..last {
            let piece = Piece::new(trace, k);
            let parts = (piece.length / step).ceil().clamp(1.0, MOST);
            let part = piece.length / parts;
            let base = Cubic::through(piece.length, curve[k], curve[k + 1]);
            for i in 0..parts as usize {
                let from = i as f64 * part;
                let shares = self.shares(&piece, (from, part), order, states);
                seen.push(&piece, from, &base, shares);
            }
        }
        // The last node has its rates from the piece behind it, where there is one.
        let is_end = last + 1 == trace.time.len();
        let piece = Piece::new(trace, if is_end { last - 1 } else { last });
        let at = if is_end { piece.length } else { 0.0 };
        let base = Cubic([curve[last][0], curve[last][1], 0.0, 0.0]).shifted(-at);
        let shares = self.shares(&piece, (at, 0.0), order, states);
        seen.push(&piece, at, &base, shares);
        seen
    }

    /// What the modes add to a quantity and its rate at an instant of a piece. Their states move on by `h` seconds.
    fn shares(
        &self,
        piece: &Piece,
        (at, h): (f64, f64),
        order: usize,
        states: &mut [[f64; 2]],
    ) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (law, state) in self.laws.iter().zip(states) {
            let driven = self.driving(law, piece).shifted(at);
            let (w, [x, v]) = (law.natural_frequency, *state);
            let damping = 2.0 * law.damping_ratio * w;
            let a = driven.0[0] - damping * v - w * w * x;
            let jerk = driven.0[1] - damping * a - w * w * v;
            let all = [x, v, a, jerk];
            sum[0] += law.share * all[order];
            sum[1] += law.share * all[order + 1];
            *state = advanced(law, driven, *state, h);
        }
        sum
    }

    /// The acceleration that drives a mode: all of it that does not depend on the mode.
    fn driving(&self, law: &Resonance, piece: &Piece) -> Cubic {
        let Piece {
            motor: Cubic(u),
            link: Cubic(y),
            input: Cubic(input),
            ..
        } = piece;
        let w = law.natural_frequency;
        let coupled = 2.0 * w * law.damping_coupling;
        let damped = 2.0 * w * law.damping_ratio + coupled;
        Cubic(std::array::from_fn(|k| {
            let own = w * w * u[k] + self.link_gain * input[k];
            let rate = |c: &[f64; 4]| c.get(k + 1).map_or(0.0, |next| (k + 1) as f64 * next);
            own + damped * rate(u) - coupled * rate(y)
        }))
    }
}

impl Seen {
    /// Adds a node, `at` seconds after the start of a piece.
    fn push(&mut self, piece: &Piece, at: f64, base: &Cubic, shares: [f64; 2]) {
        let [value, rate, _] = base.at(at);
        let [u, v, _] = piece.encoder.at(at);
        self.time.push(piece.start + at);
        self.curve.push([value + shares[0], rate + shares[1]]);
        self.motor.push([u, v, 0.0]);
    }
}

/// The motion between two nodes.
struct Piece {
    /// Its start, s.
    start: f64,
    /// Its length, s; 0 at a jump.
    length: f64,
    /// Motor side as an encoder sees it.
    encoder: Cubic,
    /// Motor side as the transmission sees it.
    motor: Cubic,
    /// Link.
    link: Cubic,
    /// Input, where it drives the link.
    input: Cubic,
}

impl Piece {
    fn new(trace: &Trace, k: usize) -> Self {
        let (start, end) = (trace.time[k], trace.time[k + 1]);
        // Across a jump nothing moves.
        let length = if end > start.next_up() {
            end - start
        } else {
            0.0
        };
        let two = |[x, v, _]: Kinematics| [x, v];
        let encoder = Cubic::through(length, two(trace.motor[k]), two(trace.motor[k + 1]));
        let transmitted = trace.transmitted.get(k..k + 2);
        Self {
            start,
            length,
            encoder,
            motor: transmitted.map_or(encoder, |own| Cubic::through(length, own[0], own[1])),
            link: Cubic::through(length, two(trace.link[k]), two(trace.link[k + 1])),
            input: trace.input.get(k).copied().unwrap_or_default(),
        }
    }
}

/// Position and velocity of a mode after a time, by the power series of `x'' + 2 xi w x' + w^2 x = f`.
fn advanced(law: &Resonance, Cubic(f): Cubic, [x, v]: [f64; 2], h: f64) -> [f64; 2] {
    if h == 0.0 {
        return [x, v];
    }
    let angle = law.natural_frequency * h;
    if angle > 2.0 * RADIANS {
        // A mode that is too fast for its nodes rests in what drives it.
        let [value, rate, _] = Cubic(f).at(h);
        return [value, rate].map(|own| own / law.natural_frequency.powi(2));
    }
    let (damping, stiffness) = (2.0 * law.damping_ratio * angle, angle * angle);
    let (mut last, mut next, mut power) = (x, h * v, h * h);
    let (mut position, mut rate) = (x + next, next);
    for k in 0..ORDER - 1 {
        let order = (k + 1) as f64;
        let driven = f.get(k).map_or(0.0, |f| f * power);
        let new = (driven - damping * order * next - stiffness * last) / (order * (order + 1.0));
        (last, next, power) = (next, new, power * h);
        position += new;
        rate += (order + 1.0) * new;
    }
    [position, rate / h]
}
