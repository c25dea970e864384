//! The least worst residual as a matrix game: one player mixes instants, the other modes and phases.
//!
//! `|H| <= V` is `Re(exp(-j phi) H) <= V` for every phase, so that `min max |H|` over amplitudes at all
//! instants is a matrix game with infinitely many rows and columns. Each player in turn adds the best answers
//! to the other's mix, until both values are practically equal. Times are in units of `1 / omega_n`.
//!
//! Source: McMahan, Gordon and Blum 2003 (double oracle).

use crate::game::solve;
use crate::pole::{dot, unit_pole};
use arrayvec::ArrayVec;
use core::f64::consts::PI;
use num_complex::Complex64;
use num_traits::Float;

/// Frequencies over the box, fine enough for a hump in ten of them, and damping ratios.
const FREQUENCIES: usize = 49;
const RATIOS: usize = 9;
/// Instants at which an impulse is tried.
const INSTANTS: usize = 128;
/// Room for the strategies of a player, of which a good ten are in a mix.
pub(crate) const ROOM: usize = 40;
/// Strategies that a player adds in a round.
const NEW: usize = 4;
/// Rounds, at most; a dozen is usual.
const ROUNDS: usize = 60;
/// The residual found is within this part of the least possible, or within [`FLOOR`]: a ten-thousandth of the
/// vibration is below what an encoder sees of it, and half of that is 1 % of what one period leaves of a box of 4 %.
const GAP: f64 = 0.01;
const FLOOR: f64 = 5e-5;
/// Shares of the command that are negligible: all together leave less than a hundredth of the floor.
const NEGLIGIBLE: f64 = 0.01 * FLOOR / ROOM as f64;

/// Frequencies from and to, over the estimate, and damping ratios from and to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Uncertainty {
    pub frequencies: (f64, f64),
    pub ratios: (f64, f64),
}

/// A mode and a phase: the residual's part in that direction, times in units of `1 / omega_n`.
#[derive(Clone, Copy)]
struct Direction {
    pole: Complex64,
    turn: Complex64,
}

impl Direction {
    /// The payment of an impulse so long before the end.
    fn part(&self, before_end: f64) -> f64 {
        dot(self.turn, self.pole.scale(before_end).exp())
    }
}

/// The game as far as it is known.
pub(crate) struct DoubleOracle {
    delay: f64,
    /// Lowest and highest frequency, and the damping ratios.
    frequencies: (f64, f64),
    ratios: ArrayVec<f64, RATIOS>,
    directions: ArrayVec<Direction, ROOM>,
    instants: ArrayVec<f64, ROOM>,
    payoff: [[f64; ROOM]; ROOM],
    /// The best train so far: instants and amplitudes.
    pub best: ArrayVec<(f64, f64), ROOM>,
}

impl DoubleOracle {
    /// The first strategies: impulses about half a period apart, and a mode with four phases.
    pub fn new(uncertainty: Uncertainty, delay: f64) -> Self {
        let (lowest, highest) = uncertainty.ratios;
        let step = (highest - lowest) / (RATIOS - 1) as f64;
        let count = if step > 0.0 { RATIOS } else { 1 };
        let ratios = (0..count).map(|k| lowest + step * k as f64).collect();
        let mut game = Self {
            delay,
            frequencies: uncertainty.frequencies,
            ratios,
            directions: ArrayVec::new(),
            instants: ArrayVec::new(),
            payoff: [[0.0; ROOM]; ROOM],
            best: ArrayVec::new(),
        };
        for k in 0..NEW {
            let phase = Complex64::new(0.0, 0.5 * PI * k as f64);
            game.add_direction(unit_pole(lowest), phase.exp());
        }
        let gaps = Float::round(delay / PI).clamp(1.0, 8.0);
        (0..=gaps as usize).for_each(|k| game.add_instant(delay * k as f64 / gaps));
        game
    }

    fn add_direction(&mut self, pole: Complex64, turn: Complex64) {
        let direction = Direction { pole, turn };
        for (entry, instant) in self.payoff[self.directions.len()]
            .iter_mut()
            .zip(&self.instants)
        {
            *entry = direction.part(self.delay - instant);
        }
        self.directions.push(direction);
    }

    fn add_instant(&mut self, instant: f64) {
        let column = self.instants.len();
        for (row, direction) in self.payoff.iter_mut().zip(&self.directions) {
            row[column] = direction.part(self.delay - instant);
        }
        self.instants.push(instant);
    }

    /// The worst residual of the best train found.
    pub fn solve(&mut self) -> f64 {
        let (mut least, mut most) = (0.0_f64, f64::INFINITY);
        for _ in 0..ROUNDS {
            let found = solve(&self.payoff, self.directions.len(), self.instants.len());
            let (worst, new_directions) = self.against(&found.columns, found.value);
            if worst < most {
                most = worst;
                let shares = self.instants.iter().copied().zip(found.columns);
                self.best = shares.filter(|share| share.1 > NEGLIGIBLE).collect();
            }
            let (lower, new_instants) = self.instants_against(&found.rows, found.value);
            least = least.max(lower);
            let nothing_new = new_directions.is_empty() && new_instants.is_empty();
            if nothing_new || most <= least * (1.0 + GAP) + FLOOR {
                break;
            }
            self.forget(&found.rows, &found.columns);
            new_directions
                .iter()
                .for_each(|new| self.add_direction(new.pole, new.turn));
            new_instants.iter().for_each(|&new| self.add_instant(new));
        }
        most
    }

    /// The worst residual of a mix of instants, and the modes and phases that make most of it.
    fn against(&self, shares: &[f64; ROOM], value: f64) -> (f64, ArrayVec<Direction, NEW>) {
        let (mut worst, mut found) = (0.0_f64, ArrayVec::<(f64, Direction), NEW>::new());
        let (first, last) = self.frequencies;
        let step = (last - first) / (FREQUENCIES - 1) as f64;
        for &ratio in &self.ratios {
            let pole = unit_pole(ratio);
            let mut residuals = [Complex64::default(); FREQUENCIES];
            for (&instant, &share) in self.instants.iter().zip(shares).filter(|s| *s.1 > 0.0) {
                let before_end = self.delay - instant;
                let mut wave = pole.scale(first * before_end).exp().scale(share);
                let turn = pole.scale(step * before_end).exp();
                for residual in &mut residuals {
                    *residual += wave;
                    wave *= turn;
                }
            }
            let sizes = residuals.map(Complex64::norm);
            for (k, &size) in sizes.iter().enumerate() {
                worst = worst.max(size);
                let peak = (k == 0 || size >= sizes[k - 1])
                    && sizes.get(k + 1).is_none_or(|&next| size > next);
                if peak && size > value {
                    let direction = Direction {
                        pole: pole.scale(first + step * k as f64),
                        turn: residuals[k].scale(1.0 / size),
                    };
                    keep_largest(&mut found, size, direction);
                }
            }
        }
        (worst, found.iter().map(|entry| entry.1).collect())
    }

    /// The sure payment to a mix of modes and phases, and the instants that pay least to it.
    fn instants_against(&self, shares: &[f64; ROOM], value: f64) -> (f64, ArrayVec<f64, NEW>) {
        let step = self.delay / (INSTANTS - 1) as f64;
        let pays = self.pays(shares, step);
        let pay = |instant: f64| -> f64 {
            let all = self.directions.iter().zip(shares).filter(|s| *s.1 > 0.0);
            all.map(|(direction, share)| share * direction.part(self.delay - instant))
                .sum()
        };
        let (mut least, mut found) = (f64::INFINITY, ArrayVec::<(f64, f64), NEW>::new());
        for k in 0..INSTANTS {
            let (before, after) = (k.checked_sub(1).map(|k| pays[k]), pays.get(k + 1).copied());
            if before.is_some_and(|before| before < pays[k])
                || after.is_some_and(|after| after <= pays[k])
            {
                continue;
            }
            // The bottom of the parabola through three points.
            let shift = match (before, after) {
                (Some(before), Some(after)) => {
                    0.5 * (before - after) / (before - 2.0 * pays[k] + after)
                }
                _ => 0.0,
            };
            let instant = step * (k as f64 + shift);
            let paid = pay(instant);
            least = least.min(paid).min(pays[k]);
            if paid < value {
                keep_largest(&mut found, -paid, instant);
            }
        }
        (least, found.iter().map(|entry| entry.1).collect())
    }

    /// The payment of an impulse to a mix of modes and phases, at every instant of a grid.
    fn pays(&self, shares: &[f64; ROOM], step: f64) -> [f64; INSTANTS] {
        let mut pays = [0.0; INSTANTS];
        for (direction, &share) in self.directions.iter().zip(shares).filter(|s| *s.1 > 0.0) {
            let mut wave = direction.pole.scale(self.delay).exp().scale(share);
            let turn = direction.pole.scale(-step).exp();
            for pay in &mut pays {
                *pay += dot(direction.turn, wave);
                wave *= turn;
            }
        }
        pays
    }

    /// Makes room: strategies that are not in the mix go.
    fn forget(&mut self, rows: &[f64; ROOM], columns: &[f64; ROOM]) {
        if self.directions.len().max(self.instants.len()) + NEW <= ROOM {
            return;
        }
        let (directions, instants) = (self.directions.clone(), self.instants.clone());
        self.directions.clear();
        self.instants.clear();
        for (&instant, _) in instants.iter().zip(columns).filter(|s| *s.1 > 0.0) {
            self.instants.push(instant);
        }
        for (direction, _) in directions.iter().zip(rows).filter(|s| *s.1 > 0.0) {
            self.add_direction(direction.pole, direction.turn);
        }
    }
}

/// Keeps the entries of the largest sizes.
fn keep_largest<T>(kept: &mut ArrayVec<(f64, T), NEW>, size: f64, entry: T) {
    if kept.is_full() {
        let least = (0..NEW)
            .min_by(|&a, &b| kept[a].0.total_cmp(&kept[b].0))
            .unwrap_or(0);
        if kept[least].0 >= size {
            return;
        }
        kept.swap_remove(least);
    }
    kept.push((size, entry));
}
