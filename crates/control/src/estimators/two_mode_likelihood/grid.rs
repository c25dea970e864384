//! Starts for two modes: every pair of frequencies of a grid is compared with the window at once.
//!
//! The sums of products of all columns of all modes of the grid give, for each pair, the cost with the best
//! linear unknowns. So one replay of the window finds the basin of the best pair, wherever it is.

use quell_shapers::Mode;

use super::fit::Priors;
use crate::estimators::likelihood::Window;
use crate::estimators::likelihood::cholesky::Cholesky;
use crate::estimators::likelihood::walk::{Step, Walk};
use crate::estimators::modal_response::{DEFORMATION, FREE, ModalResponse, VELOCITY};

/// Modes of the grid.
pub const MODES: usize = 16;
/// Ratio of neighbours. Four periods resolve an eighth of the frequency: half a period over their length. 16
/// modes reach an octave to either side.
const RATIO: f64 = 1.1;
/// Ratio of the last to the middle, `RATIO^7.5`.
pub const REACH: f64 = 2.04;
/// Columns of a mode: two of its free decay, `q'`, `q - u`.
const OF_A_MODE: usize = 4;
/// Columns of all modes, then 1, the input, and the measured deformation.
const WIDTH: usize = MODES * OF_A_MODE + 3;
const CONSTANT: usize = WIDTH - 3;
const TOTAL_INPUT: usize = WIDTH - 2;
const MEASURED: usize = WIDTH - 1;
/// Linear unknowns of a pair.
const UNKNOWNS: usize = 2 * OF_A_MODE + 2;
/// Index of each one's prior among the unknowns of a fit; the shares of both modes are free.
const PRIOR: [usize; UNKNOWNS] = [0, 1, 5, 8, 2, 3, 6, 8, 4, 9];
/// Number of starts that are kept: the best pair and, if the window is too short to tell on which side of a
/// strong mode the weak one lies, one to either side.
pub const STARTS: usize = 3;

/// Cost of a sample of the grid, and of a pair's solution, in samples of a pair of modes, as measured (75 ns a
/// sample).
const SAMPLE: usize = 6;
const PAIR: usize = 2;

/// A pair of the grid, and its sum of squares.
#[derive(Clone, Copy, Debug)]
struct Start {
    places: [usize; 2],
    cost: f64,
}

impl Start {
    /// Whether two starts lead to the same minimum: neighbours in both modes.
    fn is_near(&self, other: &Self) -> bool {
        (0..2).all(|k| self.places[k].abs_diff(other.places[k]) <= 1)
    }
}

/// The grid, its sums, and the present position in the window.
#[derive(Clone, Debug)]
pub struct Grid {
    modes: [Mode; MODES],
    responses: Vec<ModalResponse>,
    moments: Vec<[f64; WIDTH]>,
    walk: Walk,
    /// The next pair to be evaluated.
    next: [usize; 2],
    best: [Option<Start>; STARTS],
}

impl Grid {
    /// A grid; allocates all its memory.
    pub fn new(mode: Mode, sample_time: f64) -> Self {
        let mut grid = Self {
            modes: [mode; MODES],
            responses: vec![ModalResponse::new(mode, sample_time); MODES],
            moments: vec![[0.0; WIDTH]; WIDTH],
            walk: Walk::default(),
            next: [0, 1],
            best: [None; STARTS],
        };
        grid.begin(mode, sample_time);
        grid
    }

    /// Restarts around a mode.
    pub fn begin(&mut self, mode: Mode, sample_time: f64) {
        for (k, response) in self.responses.iter_mut().enumerate() {
            let steps = k as f64 - 0.5 * (MODES - 1) as f64;
            let w = mode.natural_frequency() * RATIO.powf(steps);
            // A scaled mode, by a factor of order one, is a mode, too.
            self.modes[k] = Mode::new(w, mode.damping_ratio()).unwrap_or(mode);
            *response = ModalResponse::new(self.modes[k], sample_time);
        }
        for sums in &mut self.moments {
            *sums = [0.0; WIDTH];
        }
        self.walk = Walk::default();
        self.next = [0, 1];
        self.best = [None; STARTS];
    }

    /// Continues: samples first, then pairs, within the budget. Returns whether all is done.
    pub fn advance(
        &mut self,
        window: &Window,
        priors: &Priors,
        variance: f64,
        budget: &mut usize,
    ) -> bool {
        while *budget > 0 && self.walk.count < window.samples().len() {
            self.absorb(window);
            *budget = budget.saturating_sub(SAMPLE);
        }
        if self.walk.count < window.samples().len() {
            return false;
        }
        while *budget > 0 && self.next[0] + 1 < MODES {
            let start = Start {
                places: self.next,
                cost: self.cost(priors, variance),
            };
            self.keep(start);
            self.next = match self.next {
                [i, j] if j + 1 < MODES => [i, j + 1],
                [i, _] => [i + 1, i + 2],
            };
            *budget = budget.saturating_sub(PAIR);
        }
        self.next[0] + 1 >= MODES
    }

    /// The starts of least cost, the best first.
    pub fn starts(&self) -> [Option<[Mode; 2]>; STARTS] {
        self.best
            .map(|start| start.map(|start| start.places.map(|k| self.modes[k])))
    }

    fn absorb(&mut self, window: &Window) {
        let Some((sample, step)) = self.walk.next(window, f64::INFINITY) else {
            return;
        };
        if let Step::Interval(length, input) = step {
            for response in &mut self.responses {
                response.advance(length, &input);
            }
        }
        if !sample.deformation.is_finite() {
            return;
        }
        let input = self.walk.input(sample);
        let mut row = [0.0; WIDTH];
        for (response, own) in self.responses.iter().zip(row.chunks_exact_mut(OF_A_MODE)) {
            let all = response.row(input, sample.deformation);
            own.copy_from_slice(&[all[FREE], all[FREE + 1], all[VELOCITY], all[DEFORMATION]]);
        }
        row[CONSTANT] = 1.0;
        row[TOTAL_INPUT] = input;
        row[MEASURED] = sample.deformation;
        for (i, &x) in row.iter().enumerate() {
            if x != 0.0 {
                for (sum, y) in self.moments[i].iter_mut().zip(&row[..=i]) {
                    *sum += x * y;
                }
            }
        }
    }

    /// Sum of squares of the next pair with the best linear unknowns; infinite where there are none.
    fn cost(&self, priors: &Priors, variance: f64) -> f64 {
        let [i, j] = self.next;
        let column = |n: usize| match n {
            0..OF_A_MODE => i * OF_A_MODE + n,
            n if n < 2 * OF_A_MODE => (j - 1) * OF_A_MODE + n,
            n => CONSTANT + n - 2 * OF_A_MODE,
        };
        let mut factor = Cholesky::<UNKNOWNS>::default();
        let mut rhs = [0.0; UNKNOWNS];
        for n in 0..UNKNOWNS {
            let p = column(n);
            let mut row = [0.0; UNKNOWNS];
            for (m, entry) in row.iter_mut().enumerate().take(n + 1) {
                *entry = self.moments[p][column(m)];
            }
            rhs[n] = self.moments[MEASURED][p];
            row[n] += variance * priors.precision[PRIOR[n]];
            if factor.append(n, &row).is_none() {
                return f64::INFINITY;
            }
        }
        let forward = factor.forward::<UNKNOWNS>(&rhs);
        let explained: f64 = (0..UNKNOWNS).map(|n| factor.explained(&forward, n)).sum();
        self.moments[MEASURED][MEASURED] - explained
    }

    /// Keeps a start among the best, unless a better one leads to the same minimum.
    fn keep(&mut self, start: Start) {
        if !start.cost.is_finite() {
            return;
        }
        let mut fresh = Some(start);
        for slot in &mut self.best {
            let Some(one) = fresh else { break };
            match slot {
                Some(other) if other.cost <= one.cost => {
                    if other.is_near(&one) {
                        return;
                    }
                }
                _ => fresh = slot.replace(one),
            }
            // A start that a better neighbour has replaced leads to the same minimum.
            if let (Some(pushed), Some(now)) = (fresh, &slot)
                && pushed.is_near(now)
            {
                return;
            }
        }
    }
}
