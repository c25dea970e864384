//! One joint of the rig: its arm, its tick, and what it left.

use quell::adaptation::AdaptationSettings;
use quell::closed_loop::{ClosedLoopError, commission};
use quell::controller::{AxisSettings, Controller, RetunePolicy, motion_limits, plan_shaped};
use quell::estimators::Settings;
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::service::contract::{Measured, Quantity};
use quell::service::guard::{Bounds, SensorReport};
use quell::service::tick::gate::Gate;
use quell::service::tick::pace::Stride;
use quell::service::tick::{AxisReport, Event, JointTick, Plan, Start, Train, Watchdog};
use quell::signal::{Clock, DeformationSensor, Measurement, RestRule};
use quell_shapers::{GridTrain, Setpoint, peak_ratios};
use quell_trajectories::Planner;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::rig::{JointCase, Moved, Ran};

/// A tick that was not missed.
const WHOLE: Stride = Stride {
    periods: 1,
    behind: 0.0,
    rate: 1.0,
    slope: 0.0,
};
/// As in the simulated cell: nearer to the target than this at the tip, the motor side has followed, m.
const FOLLOWED: f64 = 1e-6;
/// The service's default.
const WATCHDOG: f64 = 0.2;

/// A move that takes longer than this has not come to rest, s.
const LONGEST: f64 = 40.0;

/// A joint on its way through its moves.
pub struct Joint {
    case: JointCase,
    shaped: bool,
    pub arm: ArmSimulation,
    pub tick: JointTick,
    random: ChaCha8Rng,
    start: f64,
    setpoint: Setpoint,
    frozen: bool,
    silent: bool,
    /// Whether the plan that was asked for has not begun.
    asks: bool,
    /// When the present move was asked for, if one was, and when its command moved last, s.
    began: Option<f64>,
    moved: f64,
    samples: Vec<Sample>,
    /// The first sample of the present move.
    first: usize,
    moves: Vec<Moved>,
}

/// One tick of a move.
#[derive(Clone, Copy)]
struct Sample {
    sent: Setpoint,
    motor: f64,
    deformation: f64,
}

impl Joint {
    pub fn new(
        robot: &Robot,
        index: usize,
        case: &JointCase,
        shaped: bool,
    ) -> Result<Self, ClosedLoopError> {
        let mut robot = robot.clone();
        robot.tracker.noise = case.sensor.noise * case.sensor.radius;
        let options = SimulationOptions {
            seed: case.seed,
            damping: Some(case.damping),
            mode: Some(case.truth),
            ..SimulationOptions::default()
        };
        let mut arm = ArmSimulation::new(&robot, 0, &options)?;
        let limits = robot.joints[0].limits;
        let registration = commission(&mut arm, 0.25, limits)?;
        let sensor = match case.sensor.quantity {
            Quantity::TipPosition => {
                DeformationSensor::new(*arm.arc(), registration.sensor_to_base, registration.clock)
            }
            _ => DeformationSensor::new(*arm.arc(), Default::default(), Clock::REFERENCE),
        };
        let start = arm.true_motor_position();
        let bounds = Bounds {
            limits,
            radius: arm.arc().radius(),
            deformation: f64::MAX,
            resolution: robot.encoder.resolution,
        };
        let watchdog = Watchdog {
            timeout: WATCHDOG,
            stops: false,
        };
        let mut tick = JointTick::new(index, bounds, watchdog, shaped, true);
        let settings = axis(&robot, case, shaped, sensor);
        let controller = Controller::new(settings, start)?;
        tick.begin(Box::new(controller), 0.0);
        Ok(Self {
            case: case.clone(),
            shaped,
            arm,
            tick,
            random: ChaCha8Rng::seed_from_u64(case.seed ^ 0x5eed),
            setpoint: Setpoint::at_rest(start),
            start,
            frozen: false,
            silent: false,
            asks: false,
            began: None,
            moved: 0.0,
            samples: Vec::new(),
            first: 0,
            moves: Vec::new(),
        })
    }

    pub fn is_done(&self) -> bool {
        self.moves.len() == self.case.targets.len()
    }

    /// Whether the present move has come to rest and rung out, or does not come to rest.
    fn is_over(&mut self, time: f64) -> bool {
        if self.tick.is_moving() || self.asks {
            self.moved = time;
        }
        match self.began {
            Some(began) => time - self.moved >= self.case.rest || time - began > LONGEST,
            None => true,
        }
    }

    /// The arm goes on by a period and is measured.
    pub fn advance(
        &mut self,
        joint: usize,
        received: f64,
        period: f64,
        measured: &mut Vec<Measured>,
    ) {
        let command = Command {
            position: self.setpoint.position,
            velocity: Some(self.setpoint.velocity),
        };
        let quantity = self.case.sensor.quantity;
        let mut say = |quantity, stamp, value| {
            measured.push(Measured {
                received,
                stamp,
                joint,
                quantity,
                value,
                refused: false,
            });
        };
        for measurement in self.arm.step(command, period) {
            match *measurement {
                Measurement::MotorPosition { time, position } => {
                    say(Quantity::MotorPosition, time, [position, 0.0, 0.0]);
                }
                Measurement::TipPosition { time, position }
                    if quantity == Quantity::TipPosition =>
                {
                    say(quantity, time, position);
                }
                _ => {}
            }
        }
        let z: f64 = self.random.sample(StandardNormal);
        let noise = self.case.sensor.noise * z;
        match quantity {
            Quantity::LinkPosition => {
                let link = self.arm.true_link_position() + noise;
                say(quantity, self.arm.time(), [link, 0.0, 0.0]);
            }
            Quantity::Deformation => {
                let deformation = self.arm.true_deformation() + noise;
                say(quantity, self.arm.time(), [deformation, 0.0, 0.0]);
            }
            _ => {}
        }
        self.samples.push(Sample {
            sent: self.setpoint,
            motor: self.arm.true_motor_position(),
            deformation: self.arm.true_tip_deformation(),
        });
    }

    /// The joint as the tick runs it, and the orders of the engine.
    pub fn command(
        &mut self,
        planner: &Planner,
        tick: u64,
        time: f64,
        period: f64,
    ) -> Result<(), ClosedLoopError> {
        self.tick.listen(time);
        if !self.is_done() && self.is_over(time) {
            if self.began.replace(time).is_some() {
                self.end_move(time);
            }
            if !self.is_done() {
                self.asks = true;
                self.expect(planner, time, period)?;
            }
        }
        while self.asks {
            match self.tick.take_plan(tick, time, &Gate::default()) {
                Some(Event::NotTaken(..)) => self.expect(planner, time, period)?,
                Some(_) => self.asks = false,
                None => break,
            }
        }
        self.tick.step();
        self.setpoint = self
            .tick
            .setpoint(&WHOLE, period, time)
            .unwrap_or(self.setpoint);
        let report = self.tick.report(time);
        let silent = |sensor: &SensorReport| time - sensor.heard > WATCHDOG;
        self.frozen |= report.axis.is_some_and(|axis| axis.frozen);
        self.silent |= report.guard.sensors().any(|(_, sensor)| silent(sensor));
        Ok(())
    }

    fn status(&self, time: f64) -> AxisReport {
        self.tick.report(time).axis.expect("the joint is commanded")
    }

    /// Hands the next plan over, shaped as the engine would.
    fn expect(&mut self, planner: &Planner, time: f64, period: f64) -> Result<(), ClosedLoopError> {
        let status = self.status(time).status;
        let shaper = self.shaped.then_some(self.case.shaper);
        let train = match shaper {
            Some(shaper) => shaper.on_grid_for(&status.shaped_for, period)?,
            None => GridTrain::identity(period)?,
        };
        let limits = self.arm.robot().joints[0].limits;
        let number = self.moves.len();
        let ends = [self.target(number), self.target(number + 1)];
        let slowed = plan_shaped(planner, ends, limits, &train)?;
        let order = Train {
            shaper,
            known: status.shaped_for,
            train,
            retunes: status.retunes,
            hold: None,
        };
        self.tick.expect(Box::new(Plan {
            joint: 0,
            id: number as u64,
            ticket: 0,
            samples: Some(slowed.plan),
            start: Start::Rest(Box::new(order)),
            together: None,
            permit: None,
        }));
        Ok(())
    }

    /// Where the joint stands after so many moves.
    fn target(&self, moves: usize) -> f64 {
        match moves.checked_sub(1) {
            Some(last) => self.case.targets[last],
            None => self.start,
        }
    }

    /// The outcome of the move that ends at `time`.
    fn end_move(&mut self, time: f64) {
        let samples = &self.samples[self.first..];
        let target = self.target(self.moves.len() + 1);
        let near = FOLLOWED / self.arm.arc().radius();
        let away = |sample: &Sample| (sample.motor - target).abs() > near;
        let followed = samples.iter().rposition(away).map_or(0, |last| last + 1);
        let left = samples[followed..]
            .iter()
            .map(|sample| sample.deformation.abs());
        let last = samples
            .last()
            .map(|last| (last.sent.position - target).abs());
        self.moves.push(Moved {
            residual: left.fold(0.0, f64::max),
            end: time,
            missed: last.unwrap_or(f64::INFINITY),
        });
        self.first = self.samples.len();
    }

    pub fn finish(self, time: f64, period: f64) -> Ran {
        let status = self.status(time).status;
        let report = self.tick.report(time).guard;
        let refused = |sensor: &SensorReport| sensor.refused.iter().sum::<u64>();
        let limits = motion_limits(self.arm.robot().joints[0].limits);
        let sent = self.samples.iter().map(|sample| sample.sent);
        Ran {
            moves: self.moves,
            peak: peak_ratios(sent, &limits, period).worst(),
            refused: report.sensors().map(|(_, sensor)| refused(sensor)).sum(),
            frozen: self.frozen,
            silent: self.silent,
            mode: status.shaped_for.mode,
            retunes: status.retunes,
        }
    }

    /// Stands still.
    pub fn wait_until(&mut self, time: f64, period: f64) {
        let command = Command {
            position: self.start,
            velocity: Some(0.0),
        };
        while self.arm.time() < time {
            self.arm.step(command, period);
        }
    }
}

fn axis(robot: &Robot, case: &JointCase, shaped: bool, sensor: DeformationSensor) -> AxisSettings {
    let belief = case.belief;
    let period = 1.0 / robot.control_rate;
    let adaptation = AdaptationSettings::around(belief);
    let [low, high] = adaptation.natural_frequency;
    let sampled = match case.sensor.quantity {
        Quantity::TipPosition => 1.0 / robot.tracker.rate,
        _ => period,
    };
    AxisSettings {
        sample_time: period,
        limits: robot.joints[0].limits,
        shaper: shaped.then_some(case.shaper),
        belief,
        adaptive: shaped,
        retune: RetunePolicy::InMotion,
        estimator: case.estimator,
        estimation: Settings {
            frequency_range: (low, high),
            ..Settings::around(belief, sampled)
        },
        adaptation,
        rest: RestRule::new(0.0, robot.encoder.resolution),
        sensor,
        longest_train: 4.0 * belief.damped_period(),
        longest_move: 20.0,
    }
}
