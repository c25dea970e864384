//! The train for the next way, from the known modes.

use nalgebra::{SMatrix, SVector};
use quell_shapers::{GridTrain, Mode, UncertainMode};
use quell_trajectories::SampledTrajectory;

use super::forecast::{Expected, Forecast};
use super::path::{NODES, Way};
use super::point::{OF_A_MODE, Point};
use super::prescription::{Hold, ModeOnWay, Prescription};
use super::{Learner, Pending, Surroundings};

/// Two standard deviations of a belief: a quarter of the frequency, the whole of the damping ratio.
const BELIEF: (f64, f64) = (0.125, 0.5);

impl Learner {
    /// The train for a plan of the joint, compared with the one in force.
    pub fn prescribe(
        &mut self,
        plan: &SampledTrajectory,
        surroundings: &Surroundings,
        in_force: &GridTrain,
    ) -> Prescription {
        let expected = self.expected(plan, surroundings);
        let another = self.with_another_load(plan, surroundings);
        self.prescribe_for(plan, [&expected, &another], in_force)
    }

    /// The same for a plan that may be stopped anywhere on its way, such as a jog: the train suits the modes at
    /// any place of the way.
    pub fn prescribe_anywhere(
        &mut self,
        plan: &SampledTrajectory,
        surroundings: &Surroundings,
        in_force: &GridTrain,
    ) -> Prescription {
        let anywhere = |modes: Vec<Expected>| modes.iter().map(Expected::anywhere).collect();
        let expected: Vec<Expected> = anywhere(self.expected(plan, surroundings));
        let another: Vec<Expected> = anywhere(self.with_another_load(plan, surroundings));
        self.prescribe_for(plan, [&expected, &another], in_force)
    }

    fn expected(&self, plan: &SampledTrajectory, surroundings: &Surroundings) -> Vec<Expected> {
        let places = self.places(&Way::of(plan), surroundings);
        self.modes.iter().map(|m| m.expected(&places)).collect()
    }

    /// The modes as they are where the load is another one by then.
    fn with_another_load(
        &self,
        plan: &SampledTrajectory,
        surroundings: &Surroundings,
    ) -> Vec<Expected> {
        let places = self
            .loads
            .another(&self.places(&Way::of(plan), surroundings));
        self.modes.iter().map(|m| m.expected(&places)).collect()
    }

    fn prescribe_for(
        &mut self,
        plan: &SampledTrajectory,
        [expected, another]: [&[Expected]; 2],
        in_force: &GridTrain,
    ) -> Prescription {
        let way = Way::of(plan);
        let known = self.modes_on_way(plan, way, expected);
        let shaped = |modes: &[Expected]| {
            let on_way = modes.iter().zip(&known).filter(|(_, on_way)| on_way.shaped);
            on_way.map(|(mode, _)| *mode).collect::<Vec<_>>()
        };
        let mut shaped = self.loads.mixture(&shaped(expected), &shaped(another));
        let hold = self.hold(&known);
        let mut prescription = Prescription {
            train: None,
            known: ModeOnWay::strongest(&known).map(|mode| mode.known),
            modes: known,
            expected: None,
            hold,
        };
        let mut adapted = in_force.clone();
        if !shaped.is_empty() {
            shaped.push(self.unknown(&shaped));
            let forecast = Forecast::new(plan, way, &shaped);
            let (train, expected) = self.choose(&forecast, &shaped, in_force, plan.period());
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
        self.pending = Some(Pending { adapted, is_base });
        prescription
    }

    /// The known modes on the way of a plan.
    pub fn on_way(&self, plan: &SampledTrajectory, surroundings: &Surroundings) -> Vec<ModeOnWay> {
        let expected = self.expected(plan, surroundings);
        self.modes_on_way(plan, Way::of(plan), &expected)
    }

    /// The unexplained vibration as a pseudo-mode: of the same size, with only the belief as knowledge. A train
    /// that suits the modes but not the belief is thus chosen only for the part that the modes do explain. Of a map that fails,
    /// with probability `p`, that is nothing: the expected unexplained part over the explained one is `u + p / (1 - p)`.
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
        let fails = self.loads.failures.probability();
        let unexplained = self.unexplained + fails / (1.0 - fails);
        Expected {
            point: Point {
                log_w: [belief.natural_frequency().ln(); NODES],
                xi,
            },
            covariance,
            share: (unexplained * shares).sqrt(),
        }
    }

    pub(super) fn modes_on_way(
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

    pub(super) fn hold(&self, modes: &[ModeOnWay]) -> Option<Hold> {
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
        // A train for the middle is off by half of the range at the ends, and leaves at most pi/2 of that.
        let left = std::f64::consts::FRAC_PI_4 * range;
        let pose = (left > self.settings.dead_band).then_some(Hold::Pose);
        pose.or(unexplained)
    }
}
