//! The choice of a train: that in force, that of no adaptation, or one that is solved for the way.

use quell_shapers::GridTrain;

use super::Learner;
use super::forecast::{Expected, Forecast};

/// Lengths of the trains that are tried, quarters of the slowest mode's period.
const QUARTERS: std::ops::RangeInclusive<usize> = 2..=8;
/// Part of the dead band that is expected to be left, so that two standard deviations stay within it.
const GOAL: f64 = 0.5;

impl Learner {
    /// A train that is expected to leave less than that in force, or none; and what is left then.
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
            // Longer must be worth it: a tenth less.
            if best.as_ref().is_none_or(|best| expected < 0.9 * best.1) {
                best = Some((train, expected));
            }
            if expected <= goal {
                break;
            }
        }
        // That of no adaptation is there, too: it does for what is hardly known.
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

    /// Whether another train leaves less than that in force by more than is not worth a change, or as little with less delay.
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
