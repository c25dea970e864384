//! The convergence criterion of an estimate: the standard deviation of the last estimates.

/// Standard deviations of `ln w` and `xi` below which an estimate has settled: a ZV shaper that is
/// off by `e` in either leaves `(pi / 2) e` of the vibration, so two standard deviations leave
/// 1.6 %.
pub const SETTLED: f64 = 0.005;

/// Estimates that a window holds.
const SLOTS: usize = 12;

/// Standard deviation of the estimates over a sliding window, half a period unless said otherwise.
///
/// The estimates are thinned to 12 a window, so the cost is the same at every rate; memory is
/// fixed.
///
/// Source: E. Pereira, J. R. Trapero, I. M. Diaz, V. Feliu, "Adaptive input shaping for manoeuvring
/// flexible structures using an algebraic identification technique", Automatica 45 (2009)
/// 1046-1051 (the standard deviation of the estimates as criterion); the threshold is ours, see
/// [`SETTLED`].
#[derive(Clone, Copy, Debug)]
pub struct Convergence {
    slots: [[f64; 2]; SLOTS],
    next: usize,
    count: usize,
    last: f64,
    periods: f64,
}

impl Default for Convergence {
    fn default() -> Self {
        Self::over(0.5)
    }
}

impl Convergence {
    /// A window of this number of periods of the estimated mode.
    pub fn over(periods: f64) -> Self {
        Self {
            slots: [[0.0; 2]; SLOTS],
            next: 0,
            count: 0,
            last: f64::NEG_INFINITY,
            periods,
        }
    }

    /// Takes an estimate of `w` (rad/s) and `xi` at a time.
    pub fn push(&mut self, time: f64, natural_frequency: f64, damping_ratio: f64) {
        let window = self.periods * core::f64::consts::TAU / natural_frequency;
        if time - self.last < window / SLOTS as f64 {
            return;
        }
        self.last = time;
        self.slots[self.next] = [natural_frequency.ln(), damping_ratio];
        self.next = (self.next + 1) % SLOTS;
        self.count = (self.count + 1).min(SLOTS);
    }

    /// Standard deviations of `ln w` and `xi` over the window; `None` until it is full.
    pub fn spread(&self) -> Option<[f64; 2]> {
        if self.count < SLOTS {
            return None;
        }
        let mut spread = [0.0; 2];
        for (k, value) in spread.iter_mut().enumerate() {
            let mean = self.slots.iter().map(|slot| slot[k]).sum::<f64>() / SLOTS as f64;
            let sum: f64 = self.slots.iter().map(|slot| (slot[k] - mean).powi(2)).sum();
            *value = (sum / (SLOTS - 1) as f64).sqrt();
        }
        Some(spread)
    }

    /// Whether both spreads are below [`SETTLED`].
    pub fn settled(&self) -> bool {
        self.spread()
            .is_some_and(|[w, xi]| w < SETTLED && xi < SETTLED)
    }
}
