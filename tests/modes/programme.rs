//! Programmes of moves: what each leaves at the tip, unshaped, without adaptation and with it.

use super::plant::{Faults, Plant, PlantMode};
use quell::adaptation::AdaptationSettings;
use quell::controller::{AxisSettings, Controller, RetunePolicy};
use quell::estimators::{Settings, estimator};
use quell::learning::{Inertia, Learner, LearnerSettings, ModeOnWay, Prescription, Surroundings};
use quell::signal::{Clock, DeformationSensor, Measurement, RestRule};
use quell_shapers::{CORRECTED_MODES, Mode, Shaper, shaper_by_name};
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory};

pub const PERIOD: f64 = 0.001;
const LIMITS: Limits = Limits {
    velocity: 2.6,
    acceleration: 10.0,
    jerk: 1000.0,
};
/// The motor side has followed from here on, rad.
const FOLLOWED: f64 = 1e-6;
/// So often a move of which nothing is known is looked at along its way, and so late its answer comes, s.
const LOOKED: f64 = 0.1;
/// The arm is left alone for so many periods of the belief.
const WATCHED: f64 = 12.0;

/// An arm and what it does.
#[derive(Clone)]
pub struct Programme {
    pub name: String,
    pub modes: Vec<PlantMode>,
    pub faults: Faults,
    pub belief_hz: f64,
    pub shaper: &'static str,
    pub start: f64,
    /// Targets, rad, and payloads.
    pub moves: Vec<(f64, f64)>,
    /// A payload of 1 as the controller is told it, kg; 0 where it is not told.
    pub declared: f64,
    /// What a description of the arm says.
    pub inertia: Option<Inertia>,
    pub seed: u64,
}

/// How a programme is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    Unshaped,
    Fixed,
    Adaptive,
    Learned,
}

/// What a move left, rad, and the length of its train, s.
#[derive(Clone, Debug)]
pub struct Left {
    pub residual: f64,
    pub delay: f64,
    pub retunes: u32,
    pub said: String,
}

impl Programme {
    fn belief(&self) -> Mode {
        Mode::from_hertz(self.belief_hz, 0.05).expect("a mode")
    }

    pub fn settings(&self, policy: Policy) -> AxisSettings {
        let belief = self.belief();
        let adaptation = AdaptationSettings::around(belief);
        let [low, high] = adaptation.natural_frequency;
        let shaper: Option<&'static dyn Shaper> = match policy {
            Policy::Unshaped => None,
            _ => shaper_by_name(self.shaper),
        };
        AxisSettings {
            sample_time: PERIOD,
            limits: LIMITS,
            shaper,
            belief,
            adaptive: matches!(policy, Policy::Adaptive | Policy::Learned),
            retune: RetunePolicy::InMotion,
            estimator: estimator("likelihood").expect("an estimator"),
            estimation: Settings {
                frequency_range: (low, high),
                ..Settings::around(belief, PERIOD)
            },
            adaptation,
            rest: RestRule::new(0.0, self.faults.resolution),
            sensor: DeformationSensor::without_arc(Clock::with_offset(0.0)),
            longest_train: 4.0 * belief.damped_period(),
            longest_move: 20.0,
        }
    }

    /// A learner that has heard nothing.
    pub fn learner(&self, controller: &Controller) -> Learner {
        let settings = self.settings(Policy::Learned);
        Learner::new(LearnerSettings {
            belief: self.belief(),
            natural_frequency: settings.adaptation.natural_frequency,
            dead_band: settings.adaptation.dead_band,
            longest_train: settings.longest_train,
            base: controller.axis().next_train().clone(),
            inertia: self.inertia.clone(),
        })
    }

    /// What each move leaves.
    pub fn run(&self, policy: Policy) -> Vec<Left> {
        self.run_and_learn(policy).0
    }

    /// What each move leaves, and who has learned from them.
    pub fn run_and_learn(&self, policy: Policy) -> (Vec<Left>, Learner) {
        let settings = self.settings(policy);
        let mut controller = Controller::new(settings, self.start).expect("a controller");
        let mut plant = Plant::new(&self.modes, self.faults, PERIOD, self.start, self.seed);
        let mut inbox = Vec::new();
        controller.keep_samples(20_000);
        let mut learner = self.learner(&controller);
        let moves = self.moves.iter();
        let left = moves
            .map(|&(target, payload)| {
                plant.payload = payload;
                let around = Surroundings::carrying(self.declared * payload);
                let from = controller.planned().position;
                let plan = plan(from, target);
                let mut said = String::new();
                if policy == Policy::Learned {
                    let in_force = controller.axis().next_train().clone();
                    let start = std::time::Instant::now();
                    let prescribed = learner.prescribe(&plan, &around, &in_force);
                    let took = start.elapsed().as_secs_f64() * 1e3;
                    said = format!(
                        "{took:.0} ms, {:?} {:?} ",
                        prescribed.hold, prescribed.expected
                    );
                    for mode in &prescribed.modes {
                        let hertz = mode.modes.map(|m| (m.hertz() * 100.0).round() / 100.0);
                        let std =
                            mode.known.natural_frequency_std / mode.known.mode.natural_frequency();
                        said += &format!(
                            "{hertz:?} +-{:.2} % xi {:.3}; ",
                            100.0 * std,
                            mode.known.mode.damping_ratio()
                        );
                    }
                    controller.hold(prescribed.hold);
                    if let (Some(train), Some(known)) = (&prescribed.train, &prescribed.known) {
                        let shaper = shaper_by_name(self.shaper);
                        controller.set_train(shaper, known, train).expect("a train");
                    }
                }
                let delay = controller.axis().next_train().duration();
                controller.load(plan.clone()).expect("a plan");
                let before = controller.axis().status().retunes;
                let is_new = policy == Policy::Learned && learner.modes() == 0;
                let along = is_new.then_some((&learner, &plan, &around));
                let residual = self.one(&mut controller, &mut plant, &mut inbox, target, along);
                let retunes = controller.axis().status().retunes - before;
                let start = std::time::Instant::now();
                if policy == Policy::Learned {
                    learner.learn(controller.axis().heard(), &plan, &around);
                }
                said += &format!("{:.0} ms", start.elapsed().as_secs_f64() * 1e3);
                Left {
                    residual,
                    delay,
                    retunes,
                    said,
                }
            })
            .collect();
        (left, learner)
    }

    /// Runs a move to its end and until the arm has been left alone: the peak of the deformation once command and
    /// motor side stand still.
    fn one(
        &self,
        controller: &mut Controller,
        plant: &mut Plant,
        inbox: &mut Vec<Measurement>,
        target: f64,
        along: Option<(&Learner, &SampledTrajectory, &Surroundings)>,
    ) -> f64 {
        let (mut quiet, mut trace) = (0.0, Vec::new());
        let (looked, mut found) = ((LOOKED / PERIOD) as usize, None);
        while quiet < WATCHED / self.belief_hz && trace.len() < 20_000 {
            let setpoint = controller.tick(inbox);
            let measured = plant.step(setpoint.position, setpoint.velocity);
            inbox.clear();
            inbox.push(Measurement::MotorPosition {
                time: measured.time,
                position: measured.motor,
            });
            inbox.extend(
                measured
                    .deformation
                    .map(|deformation| Measurement::Deformation {
                        time: measured.time,
                        deformation,
                    }),
            );
            if let Some((learner, plan, around)) = along
                && trace.len() % looked == looked - 1
            {
                if let Some(prescribed) = found.take() {
                    go_on_with(controller, &prescribed);
                }
                let in_force = controller.axis().next_train();
                let heard = controller.axis().heard();
                found = learner.along(heard, plan, around, in_force);
            }
            trace.push((plant.motor(), plant.deformation()));
            quiet = match controller.is_settled() {
                true => quiet + PERIOD,
                false => 0.0,
            };
        }
        let away = |(motor, _): &(f64, f64)| (motor - target).abs() > FOLLOWED;
        let end = trace.iter().rposition(away).map_or(0, |last| last + 1);
        trace[end..]
            .iter()
            .fold(0.0, |peak, (_, deformation)| deformation.abs().max(peak))
    }
}

/// Goes over to what was found along the way of a move.
fn go_on_with(controller: &mut Controller, prescribed: &Prescription) {
    let shaped = prescribed.modes.iter().filter(|mode| mode.shaped);
    let modes = shaped.map(ModeOnWay::anywhere).take(CORRECTED_MODES);
    let modes: Vec<_> = modes.collect();
    if let (Some(train), Some(known)) = (&prescribed.train, &prescribed.known) {
        controller.retune(train, known, &modes);
        controller.hold(prescribed.hold);
    }
}

pub fn plan(from: f64, to: f64) -> SampledTrajectory {
    let ends = [AxisState::at_rest(from), AxisState::at_rest(to)];
    let planner = Planner::new(1).expect("a planner");
    let trajectory = planner.plan(&ends[..1], &ends[1..], &[LIMITS]);
    trajectory.expect("a plan").sample(PERIOD).expect("samples")
}

/// Each move's share of what the same move leaves unshaped, %.
pub fn percent(left: &[Left], unshaped: &[Left]) -> Vec<f64> {
    let pairs = left.iter().zip(unshaped);
    pairs
        .map(|(a, b)| 100.0 * a.residual / b.residual)
        .collect()
}

pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}

pub fn worst(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}
