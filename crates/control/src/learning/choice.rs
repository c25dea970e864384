//! The choice of a train: the one in force, the one without adaptation, or one that is solved for the way.

use quell_shapers::GridTrain;

use super::Learner;
use super::forecast::{Expected, Forecast};

/// Lengths of the trains that are tried, quarters of the slowest mode's period.
const QUARTERS: std::ops::RangeInclusive<usize> = 2..=8;
/// Expected residual as a part of the dead band, so that two standard deviations stay within it.
const GOAL: f64 = 0.5;

impl Learner {
    /// A train with a lower expected residual than the one in force, or none, and the expected residual.
    pub(super) fn choose(
        &self,
        forecast: &Forecast<'_>,
        modes: &[Expected],
        in_force: &GridTrain,
        period: f64,
    ) -> (Option<GridTrain>, f64) {
        let slowest = modes.iter().map(|m| m.point.log_w.map(f64::exp));
        let slowest = slowest.flatten().fold(f64::INFINITY, f64::min);
        let quarter = std::f64::consts::FRAC_PI_2 / slowest;
        let goal = GOAL * self.settings.dead_band;
        let capacity = (self.settings.longest_train / period) as usize;
        let mut best: Option<(GridTrain, f64)> = None;
        for quarters in QUARTERS {
            let ticks = (quarters as f64 * quarter / period).round() as usize;
            if ticks < 1 || ticks > capacity {
                continue;
            }
            let left = forecast.left(ticks);
            let Ok(train) = left.best(period) else {
                continue;
            };
            let expected = left.by(&train);
            // A longer train must leave a tenth less.
            if best.as_ref().is_none_or(|best| expected < 0.9 * best.1) {
                best = Some((train, expected));
            }
            if expected <= goal {
                break;
            }
        }
        // The train without adaptation is a candidate, too: it suits poorly known modes.
        let base = self.left_by(forecast, &self.settings.base);
        if best.as_ref().is_none_or(|best| base < 1.1 * best.1) {
            best = Some((self.settings.base.clone(), base));
        }
        let now = self.left_by(forecast, in_force);
        match best {
            Some((train, expected))
                if self.is_worth([now, expected], in_force, &train, quarter) =>
            {
                (Some(train), expected)
            }
            _ => (None, now),
        }
    }

    fn left_by(&self, forecast: &Forecast<'_>, train: &GridTrain) -> f64 {
        forecast.left_of(&[train]).by(train)
    }

    /// Whether another train leaves less than the one in force by more than the dead band, or as little with
    /// less delay.
    fn is_worth(
        &self,
        [now, expected]: [f64; 2],
        in_force: &GridTrain,
        train: &GridTrain,
        quarter: f64,
    ) -> bool {
        let goal = GOAL * self.settings.dead_band;
        let shorter = train.duration() + quarter < in_force.duration();
        let worse = now - expected > self.settings.dead_band;
        worse || (shorter && expected <= goal.max(now))
    }
}
