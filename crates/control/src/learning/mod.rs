//! What moves teach of a joint: its modes, how many they are, and how they follow pose and payload; and the train for
//! the next move. Off the tick: it allocates, and takes milliseconds.
//!
//! After each move [`Learner::learn`] fits a sum of modes to it ([`fit`]), as many as there is evidence for ([`order`]), and keeps
//! what it says in a map of each mode ([`mode_map`]). Before a move [`Learner::prescribe`] forecasts what trains leave of it
//! ([`forecast`]): that in force, that of the belief, and the one solved for the way. The train in force is kept unless another
//! is expected to leave less; [`monitor`] holds the expectation against what moves have left.

pub mod fit;
pub mod forecast;
pub mod map;
mod mode_map;
mod monitor;
mod order;
mod path;
mod response;
mod simplex;

use nalgebra::{SMatrix, SVector};
use quell_shapers::{GridTrain, Mode, UncertainMode};
use quell_trajectories::SampledTrajectory;

use self::fit::{Fit, OF_A_MODE, Point, Prior, Problem};
use self::forecast::{Expected, Forecast, Left};
use self::map::Place;
use self::mode_map::ModeMap;
use self::monitor::{Monitor, Outcome};
use self::path::{NODES, Way};
use crate::estimators::Sample;

pub use self::order::MOST;

/// Samples of a move from which something is learned: more than twice the unknowns of three modes.
const FEWEST: usize = 64;
/// Lengths of the trains that are tried, quarters of the slowest mode's period.
const QUARTERS: std::ops::RangeInclusive<usize> = 2..=8;
/// Part of the dead band that is expected to be left, so that two standard deviations stay within it.
const GOAL: f64 = 0.5;

/// Dead bands that a train may be expected to leave where adaptation in motion follows: it is expected by two standard
/// deviations, and adaptation retunes beyond one dead band.
const FOLLOWED: f64 = 2.0;

/// What a move left unexplained counts by half as much with each move after it.
const FORGETS: f64 = 0.5;
/// Inflation by the residual's colour up to which it is as good as white: a correlation of neighbours of 0.2.
const COLOURED: f64 = 1.5;
/// Two standard deviations of a belief: a quarter of the frequency, the whole of the damping ratio.
const BELIEF: (f64, f64) = (0.125, 0.5);

/// Settings of a learner.
#[derive(Clone, Debug)]
pub struct LearnerSettings {
    /// The mode that the engineer believes in.
    pub belief: Mode,
    /// Natural frequencies that are looked for, rad/s.
    pub natural_frequency: [f64; 2],
    /// Share of the unshaped vibration that is not worth a change.
    pub dead_band: f64,
    /// Longest train, s.
    pub longest_train: f64,
    /// The train that is in force without any adaptation.
    pub base: GridTrain,
}

/// Why the train is not followed in motion as that of one mode that stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// The joint has several modes.
    SeveralModes,
    /// The mode changes along the way by more than the dead band.
    Pose,
    /// What was learned left more than no adaptation would have.
    Worse,
    /// The modes leave more of the vibration unexplained than the dead band.
    Unexplained,
}

impl Hold {
    /// A short stable name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::SeveralModes => "several_modes",
            Self::Pose => "pose",
            Self::Worse => "worse",
            Self::Unexplained => "unexplained",
        }
    }

    /// What the train is solved for in place of one mode that stays.
    pub fn reason(self) -> &'static str {
        match self {
            Self::SeveralModes => "several modes",
            Self::Pose => "a mode that follows the pose",
            Self::Worse => "the belief, because what was learned left more",
            Self::Unexplained => "what the modes explain, and for the belief in what they do not",
        }
    }
}

/// A mode on the way of the next move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeOnWay {
    /// From start to end, evenly.
    pub modes: [Mode; NODES],
    /// How well the one in the middle is known.
    pub known: UncertainMode,
    /// Its part of what the move leaves unshaped.
    pub contribution: f64,
    /// Whether it is shaped for: not where shaping excites less of it than is worth a change.
    pub shaped: bool,
}

/// What is in force for a move.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescription {
    /// A train to be set; none keeps that in force.
    pub train: Option<GridTrain>,
    /// The mode that contributes most.
    pub known: Option<UncertainMode>,
    /// All modes.
    pub modes: Vec<ModeOnWay>,
    /// Share of the unshaped vibration that is expected to be left; none where nothing is known.
    pub expected: Option<f64>,
    /// Why the train is not followed in motion.
    pub hold: Option<Hold>,
}

/// What was prescribed for the move under way.
#[derive(Clone, Debug)]
struct Pending {
    plan: SampledTrajectory,
    /// The train that adaptation would have, in force or not.
    adapted: GridTrain,
    is_base: bool,
}

/// Learns the modes of a joint from move to move.
#[derive(Clone, Debug)]
pub struct Learner {
    settings: LearnerSettings,
    modes: Vec<ModeMap>,
    monitor: Monitor,
    /// Part of the unshaped vibration that the modes leave unexplained, squared, over the last moves.
    unexplained: f64,
    pending: Option<Pending>,
}

impl Learner {
    /// A learner that knows nothing yet.
    pub fn new(settings: LearnerSettings) -> Self {
        Self {
            settings,
            modes: Vec::new(),
            monitor: Monitor::default(),
            unexplained: 0.0,
            pending: None,
        }
    }

    /// Modes that it knows.
    pub fn modes(&self) -> usize {
        self.modes.len()
    }

    /// Forgets all that it has learned.
    pub fn forget(&mut self) {
        self.modes.clear();
        self.monitor = Monitor::default();
        self.unexplained = 0.0;
        self.pending = None;
    }

    fn places(way: &Way, payload: f64) -> [Place; NODES] {
        way.nodes().map(|position| Place {
            position,
            others: Vec::new(),
            payload,
        })
    }

    /// Takes the samples of a move, from its start until it has rung out; `payload` is what was carried, over the largest.
    /// Says nothing where too little vibrates.
    pub fn learn(&mut self, heard: &[Sample], payload: f64) {
        let pending = self.pending.take();
        let samples = in_order(heard);
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return;
        };
        let way = Way::new(first.motor_position, last.motor_position);
        if samples.len() < FEWEST {
            return;
        }
        let places = Self::places(&way, payload);
        let fit = match self.explain(&samples, way, &places) {
            Some((fit, true)) => fit,
            Some((fit, false)) => {
                // The arm is another one than the map's, or was never one of modes: what was learned is of no use.
                self.modes.clear();
                fit
            }
            None => {
                self.modes.clear();
                self.unexplained = 1.0;
                return;
            }
        };
        for (k, fitted) in fit.modes.iter().enumerate() {
            if k == self.modes.len() {
                self.modes.push(ModeMap::new(fitted.point.log_w[1]));
            }
            self.modes[k].learn(fitted, &places);
        }
        if let Some(pending) = pending {
            self.watch(&pending, &fit, way, &samples);
        }
    }

    /// The fit of a move, and whether it is one of the modes that are known.
    fn explain(
        &self,
        samples: &[Sample],
        way: Way,
        places: &[Place; NODES],
    ) -> Option<(Fit, bool)> {
        let range = self.settings.natural_frequency.map(f64::ln);
        let range = (range[0], range[1]);
        let priors: Vec<Prior> = self.modes.iter().map(|mode| mode.prior(places)).collect();
        let fit = |priors: &[Prior]| {
            let mut problem = Problem::new(samples, way, range);
            order::explain(samples, &mut problem, priors)
        };
        let known = match priors.as_slice() {
            [] => None,
            priors => fit(priors).filter(|found| self.is_theirs(found)),
        };
        // White noise is all that is left, and no mode had to be added: nothing else can explain it better.
        let is_enough = |fit: &Fit| fit.inflation <= COLOURED && fit.modes.len() == priors.len();
        if known.as_ref().is_some_and(is_enough) {
            return known.map(|fit| (fit, true));
        }
        let anew = fit(&[]);
        match (known, anew) {
            // The map stays unless the samples exclude it, or fewer modes say the same: one that has moved is not another one.
            (Some(known), Some(anew)) => {
                let fewer = anew.modes.len() < known.modes.len();
                let as_good = fewer && !order::excludes(&known, &anew, samples);
                match as_good || order::excludes(&anew, &known, samples) {
                    true => Some((anew, false)),
                    false => Some((known, true)),
                }
            }
            (Some(known), None) => Some((known, true)),
            (None, anew) => anew.map(|fit| (fit, false)),
        }
    }

    /// Whether the modes of a fit are those of the map, and still modes.
    fn is_theirs(&self, fit: &Fit) -> bool {
        let theirs = self.modes.iter().zip(&fit.modes);
        (0..fit.modes.len()).all(|k| order::rings(fit, k))
            && !theirs
                .into_iter()
                .any(|(map, fitted)| map.is_surprised(fitted))
    }

    /// Holds what the move left against what it would have left otherwise.
    fn watch(&mut self, pending: &Pending, fit: &Fit, way: Way, samples: &[Sample]) {
        let modes: Vec<Expected> = fit
            .modes
            .iter()
            .map(|mode| Expected {
                point: mode.point,
                covariance: mode.covariance,
                share: mode.share,
            })
            .collect();
        let forecast = Forecast::new(&pending.plan, way, &modes).whole();
        let base = &self.settings.base;
        let longest = pending
            .adapted
            .duration_in_ticks()
            .max(base.duration_in_ticks());
        let left = forecast.left(longest);
        let unshaped = left.unshaped().max(f64::MIN_POSITIVE);
        let measured = monitor::ringing(samples, fit) / unshaped;
        let unexplained = 2.0 * fit.unexplained() / (unshaped * unshaped);
        self.unexplained = (FORGETS * self.unexplained).max(unexplained).min(1.0);
        if pending.adapted == *base {
            return;
        }
        let outcome = match pending.is_base {
            true => Outcome {
                base: measured,
                adapted: left.by(&pending.adapted),
            },
            false => Outcome {
                base: left.by(base),
                adapted: measured,
            },
        };
        self.monitor.take(outcome);
    }

    /// The train for a plan of the joint, beside that in force.
    pub fn prescribe(
        &mut self,
        plan: &SampledTrajectory,
        payload: f64,
        in_force: &GridTrain,
    ) -> Prescription {
        let positions = plan.positions(0);
        let (from, to) = (positions.first(), positions.last());
        let way = Way::new(
            from.copied().unwrap_or_default(),
            to.copied().unwrap_or_default(),
        );
        let places = Self::places(&way, payload);
        let expected: Vec<Expected> = self.modes.iter().map(|m| m.expected(&places)).collect();
        let known = self.modes_on_way(plan, way, &expected);
        let mut shaped: Vec<Expected> = expected
            .iter()
            .zip(&known)
            .filter(|(_, on_way)| on_way.shaped)
            .map(|(mode, _)| *mode)
            .collect();
        let hold = self.hold(&known);
        let mut prescription = Prescription {
            train: None,
            known: known
                .iter()
                .max_by(|a, b| a.contribution.total_cmp(&b.contribution))
                .map(|mode| mode.known),
            modes: known,
            expected: None,
            hold,
        };
        let mut adapted = in_force.clone();
        if !shaped.is_empty() {
            shaped.push(self.unknown(&shaped));
            let forecast = Forecast::new(plan, way, &shaped);
            // Where nothing holds the train, adaptation in motion makes up for what is little.
            let band = self.settings.dead_band * if hold.is_none() { FOLLOWED } else { 1.0 };
            let given = (in_force, band);
            let (train, expected) = self.choose(&forecast, &shaped, given, plan.period());
            prescription.expected = Some(expected);
            if let Some(train) = &train {
                adapted = train.clone();
            }
            prescription.train = train;
        }
        let is_base = hold == Some(Hold::Worse) || (shaped.is_empty() && hold.is_some());
        if is_base {
            prescription.train = Some(self.settings.base.clone());
            let believed = UncertainMode::believed(self.settings.belief);
            prescription.known = Some(believed);
        }
        self.pending = Some(Pending {
            plan: plan.clone(),
            adapted,
            is_base,
        });
        prescription
    }

    /// What the modes leave unexplained: as large as it was, of a mode of which nothing but the belief is known. A train that
    /// does well for the modes, but gives up the belief, is taken only for what they do explain.
    fn unknown(&self, modes: &[Expected]) -> Expected {
        let belief = self.settings.belief;
        let (xi, square) = (belief.damping_ratio(), |x: f64| x * x);
        let spread = SVector::<f64, OF_A_MODE>::from_fn(|n, _| match n {
            NODES => square(BELIEF.1 * xi.max(0.01)),
            _ => 0.0,
        });
        let mut covariance = SMatrix::from_diagonal(&spread);
        covariance
            .fixed_view_mut::<NODES, NODES>(0, 0)
            .fill(square(BELIEF.0));
        let shares: f64 = modes.iter().map(|mode| square(mode.share)).sum();
        Expected {
            point: Point {
                log_w: [belief.natural_frequency().ln(); NODES],
                xi,
            },
            covariance,
            share: (self.unexplained * shares).sqrt(),
        }
    }

    fn modes_on_way(
        &self,
        plan: &SampledTrajectory,
        way: Way,
        expected: &[Expected],
    ) -> Vec<ModeOnWay> {
        let contributions = Forecast::new(plan, way, expected).contributions();
        let on_way = expected.iter().zip(contributions);
        on_way
            .filter_map(|(mode, contribution)| {
                let at = |n: usize| Mode::new(mode.point.log_w[n].exp(), mode.point.xi).ok();
                let at: Option<Vec<Mode>> = (0..NODES).map(at).collect();
                let modes: [Mode; NODES] = at?.try_into().ok()?;
                let std = |n: usize| mode.covariance[(n, n)].sqrt();
                Some(ModeOnWay {
                    modes,
                    known: UncertainMode {
                        mode: modes[1],
                        natural_frequency_std: std(1) * modes[1].natural_frequency(),
                        damping_ratio_std: std(NODES),
                    },
                    contribution,
                    shaped: contribution > self.settings.dead_band,
                })
            })
            .collect()
    }

    fn hold(&self, modes: &[ModeOnWay]) -> Option<Hold> {
        if self.monitor.prefers_base(self.settings.dead_band) {
            return Some(Hold::Worse);
        }
        let unexplained = self.unexplained.sqrt() > self.settings.dead_band;
        let unexplained = unexplained.then_some(Hold::Unexplained);
        let mut shaped = modes.iter().filter(|mode| mode.shaped);
        let Some(first) = shaped.next() else {
            return unexplained;
        };
        if shaped.next().is_some() {
            return Some(Hold::SeveralModes);
        }
        let logs = first.modes.map(|mode| mode.natural_frequency().ln());
        let range = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - logs.iter().copied().fold(f64::INFINITY, f64::min);
        // A train for the middle is off by half of it, and leaves pi/2 of that at most.
        let left = std::f64::consts::FRAC_PI_4 * range;
        let pose = (left > self.settings.dead_band).then_some(Hold::Pose);
        pose.or(unexplained)
    }

    /// A train that is expected to leave less than that in force, or none; and what is left then.
    fn choose(
        &self,
        forecast: &Forecast<'_>,
        modes: &[Expected],
        (in_force, band): (&GridTrain, f64),
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
                if self.is_worth([now, expected], (in_force, band), &train, quarter) =>
            {
                (Some(train), expected)
            }
            _ => (None, now),
        }
    }

    fn left_by(&self, forecast: &Forecast<'_>, train: &GridTrain) -> f64 {
        let left: Left = forecast.left(train.duration_in_ticks());
        left.by(train)
    }

    /// Whether that in force leaves more than a dead band and another less, or another as little with less delay.
    fn is_worth(
        &self,
        [now, expected]: [f64; 2],
        (in_force, band): (&GridTrain, f64),
        train: &GridTrain,
        quarter: f64,
    ) -> bool {
        let goal = GOAL * self.settings.dead_band;
        let shorter = train.duration() + quarter < in_force.duration();
        let worse = now > band && expected < 0.9 * now;
        worse || (shorter && expected <= goal.max(now))
    }
}

/// The finite samples that advance in time.
fn in_order(heard: &[Sample]) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::with_capacity(heard.len());
    for sample in heard.iter().filter(|sample| sample.is_finite()) {
        if samples.last().is_none_or(|last| sample.time > last.time) {
            samples.push(*sample);
        }
    }
    samples
}
