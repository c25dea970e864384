//! One step of the classical Runge-Kutta method, with dense output.
//!
//! Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, sections II.1 and II.6.

use super::chain::{Chain, Constants, Instant, MotorSide, State};
use super::piecewise::Cubic;

/// Position of a step in time.
#[derive(Clone, Copy)]
pub(super) struct Span<'a> {
    /// Start of the piece of the input, s.
    pub t0: f64,
    /// Start of the step, s.
    pub from: f64,
    /// Last instant that the laws may see, s: events at the step's end have not happened yet.
    pub last: f64,
    /// The input from `t0` on.
    pub input: &'a Cubic,
}

impl Span<'_> {
    /// Time that laws see, and input, `h` after the start.
    #[inline(always)]
    pub fn at(&self, h: f64) -> (f64, [f64; 3]) {
        let time = (self.from + h).min(self.last);
        (time, self.input.at(self.from - self.t0 + h))
    }
}

/// A step and its stages.
pub(super) struct Trial {
    /// State at the end.
    pub end: State,
    /// Slopes: at the start, twice the mean of the two in the middle, at the end.
    slopes: [State; 3],
    /// Length, s.
    pub h: f64,
    /// Forces of sticking friction in the middle and at the end.
    pub holding: [[f64; 3]; 2],
}

/// A step of given length from a state with its accelerations.
pub(super) type Step = fn(&Chain, &Constants, &Span, &State, &Instant, f64) -> Trial;

/// The same, in place and without its stages.
pub(super) type Whole = fn(&Chain, &Constants, &Span, &mut State, &Instant, f64);

/// The step for this chain, with its stages and without.
pub(super) fn steps(chain: &Chain) -> (Step, Whole) {
    let free = matches!(chain.linear.motor, MotorSide::Free { .. });
    let link = chain.linear.link.is_some();
    match (free, link, chain.is_linear()) {
        (false, _, true) => pair::<false, true, false>(),
        (true, false, true) => pair::<true, false, false>(),
        (true, true, true) => pair::<true, true, false>(),
        (false, _, false) => pair::<false, true, true>(),
        (true, false, false) => pair::<true, false, true>(),
        (true, true, false) => pair::<true, true, true>(),
    }
}

fn pair<const MOTOR: bool, const LINK: bool, const LAWS: bool>() -> (Step, Whole) {
    (
        trial::<MOTOR, LINK, LAWS>,
        |chain, constants, span, state, start, h| {
            let end = trial::<MOTOR, LINK, LAWS>(chain, constants, span, state, start, h).end;
            each::<MOTOR, LINK>(|i| state[i] = end[i]);
        },
    )
}

/// The entries of the state that move.
#[inline(always)]
fn each<const MOTOR: bool, const LINK: bool>(mut f: impl FnMut(usize)) {
    if MOTOR {
        f(0);
        f(1);
    }
    if LINK {
        f(2);
        f(3);
    }
}

#[inline(always)]
fn slope<const MOTOR: bool, const LINK: bool>(instant: &Instant, state: &State) -> State {
    let mut slope: State = [0.0; 4];
    if MOTOR {
        (slope[0], slope[1]) = (state[1], instant.motor);
    }
    if LINK {
        (slope[2], slope[3]) = (state[3], instant.link);
    }
    slope
}

/// A step of length `h` from a state with its accelerations. `MOTOR`, `LINK`: whether these have a state;
/// `LAWS`: whether there is more than the linear chain.
#[inline(always)]
fn trial<const MOTOR: bool, const LINK: bool, const LAWS: bool>(
    chain: &Chain,
    constants: &Constants,
    span: &Span,
    state: &State,
    start: &Instant,
    h: f64,
) -> Trial {
    let moved = |slope: &State, h: f64| {
        let mut moved = *state;
        each::<MOTOR, LINK>(|i| moved[i] += h * slope[i]);
        moved
    };
    let evaluate = |state: &State, (time, input): (f64, [f64; 3])| {
        let instant = chain.evaluate::<LAWS>(constants, time, state, input);
        (slope::<MOTOR, LINK>(&instant, state), instant.holding)
    };
    let half = span.at(0.5 * h);
    let k1 = slope::<MOTOR, LINK>(start, state);
    let (k2, _) = evaluate(&moved(&k1, 0.5 * h), half);
    let (k3, middle) = evaluate(&moved(&k2, 0.5 * h), half);
    let (k4, last) = evaluate(&moved(&k3, h), span.at(h));
    let (mut end, mut k23) = (*state, k2);
    each::<MOTOR, LINK>(|i| {
        k23[i] += k3[i];
        end[i] += h / 6.0 * (k1[i] + 2.0 * k23[i] + k4[i]);
    });
    Trial {
        end,
        slopes: [k1, k23, k4],
        h,
        holding: [middle, last],
    }
}

impl Trial {
    /// State at a share `s` of the step, of third order.
    pub fn within(&self, state: &State, s: f64) -> State {
        let (s2, s3) = (s * s, 2.0 / 3.0 * s * s * s);
        let weights = [s - 1.5 * s2 + s3, s2 - s3, s3 - 0.5 * s2];
        let mut within = *state;
        for (i, x) in within.iter_mut().enumerate() {
            let slopes = &self.slopes;
            let mean: f64 = (0..3).map(|k| weights[k] * slopes[k][i]).sum();
            *x += self.h * mean;
        }
        within
    }
}
