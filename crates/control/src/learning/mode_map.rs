//! A mode over pose and payload: its frequency as an inertia (for the lowest mode relative to that of a robot's
//! description), its damping, its share.

use nalgebra::{SMatrix, SVector};

use super::described::Inertia;
use super::fit::Fitted;
use super::forecast::Expected;
use super::map::{Block, Map, Place, Predicted, Spread};
use super::path::NODES;
use super::point::{OF_A_MODE, Prior};

/// Inertia relative to that of the first move, which fixes its level. An arm that folds over a radian changes
/// it by half. The largest payload adds, within two standard deviations, between nothing and as much as the arm
/// has.
const INERTIA: Spread = Spread {
    mean: 1.0,
    level: 0.5,
    pose: 0.4,
    load: (0.5, 0.25),
};
/// Inertia relative to that of a description: the same, except for the payload, which the description already
/// includes.
const DESCRIBED: Spread = Spread {
    load: (0.0, 0.25),
    ..INERTIA
};
/// Damping ratios: a few hundredths; they vary little with pose and payload.
const DAMPING: Spread = Spread {
    mean: 0.05,
    level: 0.1,
    pose: 0.01,
    load: (0.0, 0.01),
};
/// Least inertia relative to that of the first move: a frequency 4.5 times as high.
const LEAST: f64 = 0.05;
/// Errors of `ln w` and `xi` by the interpolation between nodes and by a slightly nonlinear mode: a train then
/// leaves less than a third of the dead band of 1 %.
const UNSEEN: f64 = 0.002;
/// Standard deviations that chance exceeds on one side once in a thousand times.
const CERTAIN: f64 = 3.09;
/// Chi-squared of four unknowns that chance exceeds once in a thousand times.
const SURPRISE: f64 = 18.5;

/// A mode that was seen in moves.
#[derive(Clone, Debug)]
pub struct ModeMap {
    /// `ln w` at an inertia of 1.
    pub(super) reference: f64,
    /// Whether the inertia is relative to a description's.
    pub(super) is_described: bool,
    pub(super) inertia: Map,
    pub(super) damping: Map,
    /// Its share: precision, and precision times mean.
    pub(super) share: [f64; 2],
}

impl ModeMap {
    /// A mode that was found at this `ln w`.
    pub fn new(reference: f64) -> Self {
        Self {
            reference,
            is_described: false,
            inertia: Map::new(INERTIA),
            damping: Map::new(DAMPING),
            share: [0.0; 2],
        }
    }

    /// A mode that was found at this `ln w` at a place, and follows a description.
    pub fn described(log_w: f64, place: &Place) -> Self {
        Self::of_described(log_w + 0.5 * place.described)
    }

    /// The same; `reference` is its `ln w` where the relative inertia is 1 and the description's is 1 kg m^2.
    pub fn of_described(reference: f64) -> Self {
        Self {
            is_described: true,
            inertia: Map::new(DESCRIBED),
            ..Self::new(reference)
        }
    }

    /// The map relative to the present description, which may be another one than before, or none.
    ///
    /// `c d` stays what it was, times one factor, with which `c` stays near 1: `c' = c exp(ln d - ln d' + s)`, `s` the mean of
    /// `ln d' - ln d`, and `ln w_ref' = ln w_ref + s / 2`.
    pub fn under(self, inertia: Option<&Inertia>) -> Self {
        let now = |place: &Place| {
            let others = place.others.clone();
            Place::new(place.position, others, place.payload, inertia).with_load(place.load)
        };
        let blocks = self.inertia.blocks();
        let known: Vec<[Place; NODES]> = blocks
            .iter()
            .map(|b| b.places.each_ref().map(now))
            .collect();
        let pairs = blocks
            .iter()
            .zip(&known)
            .flat_map(|(b, now)| b.places.iter().zip(now));
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (then, now)| {
            (sum + now.described - then.described, count + 1.0)
        });
        let shift = if count > 0.0 { sum / count } else { 0.0 };
        let mut map = Self::of_described(self.reference + 0.5 * shift);
        for (block, places) in blocks.iter().zip(known) {
            let less = SMatrix::from_diagonal(&SVector::<f64, NODES>::from_fn(|n, _| {
                (places[n].described - block.places[n].described - shift).exp()
            }));
            map.inertia.add(Block {
                places,
                precision: less * block.precision * less,
                vector: less * block.vector,
            });
        }
        Self {
            damping: self.damping,
            share: self.share,
            ..map
        }
    }

    /// `ln J` of the description; 0 if the mode does not follow it.
    pub fn described_at(&self, places: &[Place; NODES]) -> SVector<f64, NODES> {
        SVector::from_fn(|n, _| match self.is_described {
            true => places[n].described,
            false => 0.0,
        })
    }

    /// Number of moves with this mode.
    pub fn moves(&self) -> usize {
        self.inertia.moves()
    }

    /// Its prior on a way.
    pub fn prior(&self, places: &[Place; NODES]) -> Prior {
        let damping = self.damping.predict(places);
        Prior {
            log_w: self.log_w(&self.inertia.predict(places), places),
            xi: (
                damping.mean[1].clamp(1e-3, 0.4),
                damping.covariance[(1, 1)].max(1e-8),
            ),
        }
    }

    /// The natural frequency from an inertia `c` of mean `m` and variance `v`, relative to that of a
    /// description `d`: `ln w = ln w_ref - ln(c d) / 2`.
    ///
    /// An inertia is positive: it is taken for log-normal, `var ln c = ln(1 + v / m^2)`, with a mean of at
    /// least its standard deviation. Far from the data, where the map tends to 0, the frequency is then almost
    /// unknown.
    fn log_w(&self, c: &Predicted, places: &[Place; NODES]) -> Predicted {
        let std = c.covariance.diagonal().map(|v| v.max(0.0).sqrt());
        let mean = c.mean.zip_map(&std, |m, std| m.max(std).max(LEAST));
        let relative = std.component_div(&mean).map(|x| x * x);
        let variance = relative.map(f64::ln_1p);
        let scale = SVector::<f64, NODES>::from_fn(|n, _| match std[n] > 0.0 {
            true => -0.5 * variance[n].sqrt() / std[n],
            false => 0.0,
        });
        let scale = SMatrix::from_diagonal(&scale);
        Predicted {
            mean: mean.zip_map(&variance, |m, v| self.reference - 0.5 * (m.ln() - 0.5 * v))
                - 0.5 * self.described_at(places),
            covariance: scale * c.covariance * scale,
        }
    }

    /// The same for a forecast, with the errors of the map itself.
    pub fn expected(&self, places: &[Place; NODES]) -> Expected {
        let prior = self.prior(places);
        let mut covariance = SMatrix::<f64, OF_A_MODE, OF_A_MODE>::zeros();
        covariance
            .fixed_view_mut::<NODES, NODES>(0, 0)
            .copy_from(&prior.log_w.covariance);
        covariance[(NODES, NODES)] = prior.xi.1;
        Expected {
            point: prior.point(),
            covariance: covariance + SMatrix::from_diagonal_element(UNSEEN * UNSEEN),
            share: self.share[1] / self.share[0].max(f64::MIN_POSITIVE),
        }
    }

    /// Why no arm has this mode, if none has: on the way of each of its moves `w < highest` (rad/s), an inertia above 0 and
    /// `0 <= xi < 1` hold, or are missed by chance.
    pub fn impossible(&self, highest: f64) -> Option<String> {
        let hertz = |w: f64| w / core::f64::consts::TAU;
        let too_high = |w: f64| {
            let (f, most) = (hertz(w), hertz(highest));
            (w >= highest)
                .then(|| format!("{f:.4} Hz is not below {most:.4} Hz, half of the control rate"))
        };
        let mut ways = self.inertia.blocks().iter().map(|block| &block.places);
        let on_way = ways.find_map(|places| {
            let (inertia, damping) = (self.inertia.predict(places), self.damping.predict(places));
            let frequency = self.log_w(&inertia, places).mean.max().exp();
            let [c, xi] = [&inertia, &damping]
                .map(|map| (map.mean[1], map.covariance[(1, 1)].max(0.0).sqrt()));
            let below_zero = |(mean, std): (f64, f64)| mean + CERTAIN * std < 0.0;
            if below_zero(c) {
                return Some(format!(
                    "an inertia of {:.4} times that of its first move is not above 0",
                    c.0
                ));
            }
            if below_zero(xi) || xi.0 >= 1.0 {
                return Some(format!(
                    "a damping ratio of {:.4} is not from 0 to below 1",
                    xi.0
                ));
            }
            too_high(frequency)
        });
        // Where a description has the inertia, the reference is the frequency of 1 kg m^2, which nothing may have.
        on_way.or_else(|| too_high(self.reference.exp()).filter(|_| !self.is_described))
    }

    /// Adds the result of a move.
    pub fn learn(&mut self, fitted: &Fitted, places: &[Place; NODES]) {
        let mean = fitted.point.vector();
        let information = fitted.information;
        // At the optimum the gradients of data and prior cancel.
        let pull = fitted.prior.precision() * (mean - fitted.prior.mean());
        let coarse = (SMatrix::<f64, OF_A_MODE, OF_A_MODE>::identity()
            + information * (UNSEEN * UNSEEN))
            .try_inverse()
            .unwrap_or_else(SMatrix::zeros);
        let precision = coarse * information;
        let precision = 0.5 * (precision + precision.transpose());
        let pull = coarse * pull;
        self.learn_frequency(&mean, &precision, &pull, places);
        let xi = precision[(NODES, NODES)];
        let only =
            |value: f64| SVector::<f64, NODES>::from_fn(|n, _| if n == 1 { value } else { 0.0 });
        let vector = only(xi * mean[NODES] + pull[NODES]);
        self.damping.add(Block {
            places: places.clone(),
            precision: SMatrix::from_diagonal(&only(xi)),
            vector,
        });
        let share = fitted.share_std.powi(-2);
        if share.is_finite() {
            // The newest move counts as much as all before: the share changes with the pose, too.
            let [sum, weighed] = self.share;
            let before = sum.min(share);
            let factor = if sum > 0.0 { before / sum } else { 0.0 };
            self.share = [before + share, factor * weighed + share * fitted.share];
        }
    }

    fn learn_frequency(
        &mut self,
        mean: &SVector<f64, OF_A_MODE>,
        precision: &SMatrix<f64, OF_A_MODE, OF_A_MODE>,
        pull: &SVector<f64, OF_A_MODE>,
        places: &[Place; NODES],
    ) {
        let described = self.described_at(places);
        let c = SVector::<f64, NODES>::from_fn(|n, _| {
            (-2.0 * (mean[n] - self.reference) - described[n]).exp()
        });
        let slope = SMatrix::from_diagonal(&c.map(|c| -0.5 / c));
        let own = slope * precision.fixed_view::<NODES, NODES>(0, 0) * slope;
        let vector = own * c + slope * pull.fixed_rows::<NODES>(0);
        self.inertia.add(Block {
            places: places.clone(),
            precision: own,
            vector,
        });
    }

    /// Whether a fit contradicts the map: the arm has changed.
    pub fn is_surprised(&self, fitted: &Fitted) -> bool {
        if self.moves() == 0 {
            return false;
        }
        let view = |m: &SMatrix<f64, OF_A_MODE, OF_A_MODE>| {
            m.fixed_view::<NODES, NODES>(0, 0).into_owned()
        };
        let shift = fitted.point.vector() - fitted.prior.mean();
        let shift = shift.fixed_rows::<NODES>(0).into_owned();
        let slack = SMatrix::<f64, NODES, NODES>::from_diagonal_element(UNSEEN * UNSEEN);
        let spread = fitted.prior.log_w.covariance - view(&fitted.covariance) + slack;
        let inverse = spread.try_inverse();
        inverse.is_some_and(|inverse| (shift.transpose() * inverse * shift)[0] > SURPRISE)
    }
}
