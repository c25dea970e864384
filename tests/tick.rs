//! The tick: no allocation, no failure, no jump, whatever arrives.

mod embedded;

use embedded::axis_settings;
use proptest::prelude::*;
use quell::controller::{AxisSettings, Controller, Setpoint};
use quell::estimators::{ESTIMATORS, EstimatorEntry};
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::signal::Measurement;
use quell_shapers::{Mode, SHAPERS, Shaper};
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory};

const PERIOD: f64 = 0.004;
const LIMITS: Limits = Limits {
    velocity: 2.6,
    acceleration: 10.0,
    jerk: 80.0,
};

fn settings(shaper: &'static dyn Shaper, estimator: &'static EstimatorEntry) -> AxisSettings {
    let belief = Mode::from_hertz(10.15, 0.084).expect("a mode");
    AxisSettings {
        limits: LIMITS,
        shaper: Some(shaper),
        estimator,
        ..axis_settings(belief, PERIOD, 0.003)
    }
}

fn plan(from: f64, to: f64) -> SampledTrajectory {
    let ends = [AxisState::at_rest(from), AxisState::at_rest(to)];
    let planner = Planner::new(1).expect("a planner");
    let trajectory = planner.plan(&ends[..1], &ends[1..], &[LIMITS]);
    trajectory.expect("a plan").sample(PERIOD).expect("samples")
}

/// A controller and an arm whose payload changes with each move, so that there is always something
/// to learn.
struct Loop {
    controller: Controller,
    arm: ArmSimulation,
    inbox: Vec<Measurement>,
    moves: usize,
    ticks_of_move: usize,
}

impl Loop {
    fn new(shaper: &'static dyn Shaper, estimator: &'static EstimatorEntry) -> Self {
        let robot = Robot::rx170();
        let arm = ArmSimulation::new(&robot, 0, &SimulationOptions::default());
        let settings = settings(shaper, estimator);
        let mut controller = Controller::new(settings, 0.0).expect("a controller");
        controller.keep_samples(64);
        Self {
            controller,
            arm: arm.expect("an arm"),
            inbox: Vec::with_capacity(64),
            moves: 0,
            ticks_of_move: 0,
        }
    }

    /// Between ticks: a new move every 600 ticks, and the arm moves on.
    fn between(&mut self, setpoint: Setpoint) {
        self.controller.clear_samples();
        self.inbox.clear();
        let command = Command {
            position: setpoint.position,
            velocity: Some(setpoint.velocity),
        };
        let measured = self.arm.step(command, PERIOD);
        self.inbox.extend_from_slice(measured);
        self.ticks_of_move += 1;
        if self.ticks_of_move >= 600 && self.controller.is_settled() {
            let payload = [0.0, 40.0, 15.0, 60.0][self.moves % 4];
            self.arm.set_payload(payload).expect("a payload");
            let target = if self.moves.is_multiple_of(2) {
                0.5
            } else {
                0.0
            };
            let position = self.controller.planned().position;
            let loaded = self.controller.load(plan(position, target));
            loaded.expect("the plan begins where the axis stands");
            self.moves += 1;
            self.ticks_of_move = 0;
        }
    }
}

#[test]
fn a_hundred_thousand_ticks_with_retunes_do_not_allocate() {
    let likelihood = &ESTIMATORS[0];
    let mut running = Loop::new(SHAPERS[2], likelihood);
    let (mut allocations, mut setpoint) = (0, Setpoint::default());
    for _ in 0..100_000 {
        let counted = allocation_counter::measure(|| {
            setpoint = running.controller.tick(&running.inbox);
        });
        allocations += counted.count_total;
        running.between(setpoint);
    }
    let retunes = running.controller.axis().status().retunes;
    println!("{} moves, {retunes} retunes", running.moves);
    assert_eq!(allocations, 0);
    assert!(retunes as usize >= running.moves, "{retunes} retunes");
}

#[test]
fn no_estimator_and_no_shaper_makes_the_tick_allocate() {
    for estimator in ESTIMATORS {
        for &shaper in SHAPERS {
            let mut running = Loop::new(shaper, estimator);
            let mut setpoint = Setpoint::default();
            for tick in 0..2_500 {
                let counted = allocation_counter::measure(|| {
                    setpoint = running.controller.tick(&running.inbox);
                });
                let (shaper, estimator) = (shaper.name(), estimator.name);
                assert_eq!(counted.count_total, 0, "{shaper}, {estimator}, tick {tick}");
                running.between(setpoint);
            }
        }
    }
}

fn measurement() -> impl Strategy<Value = Measurement> {
    let number = prop_oneof![
        8 => -10.0..10.0,
        1 => any::<f64>(),
        1 => Just(f64::NAN),
    ];
    let three = [number.clone(), number.clone(), number.clone()];
    prop_oneof![
        (number.clone(), number.clone())
            .prop_map(|(time, position)| Measurement::MotorPosition { time, position }),
        (number.clone(), number.clone())
            .prop_map(|(time, position)| Measurement::LinkPosition { time, position }),
        (number.clone(), number.clone())
            .prop_map(|(time, deformation)| Measurement::Deformation { time, deformation }),
        (number, three).prop_map(|(time, position)| Measurement::TipPosition { time, position }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Sensors may say anything: the command stays within its limits and ends on its target.
    #[test]
    fn nonsense_from_the_sensors_never_moves_the_command(
        nonsense in prop::collection::vec(prop::collection::vec(measurement(), 0..4), 400),
        estimator in 0..ESTIMATORS.len(),
    ) {
        let settings = settings(SHAPERS[0], &ESTIMATORS[estimator]);
        let mut controller = Controller::new(settings, 0.0).expect("a controller");
        controller.load(plan(0.0, 0.5)).expect("a plan");
        let mut before = Setpoint::default();
        for measured in nonsense.iter().chain(std::iter::repeat_n(&Vec::new(), 2_000)) {
            let now = controller.tick(measured);
            let jerk = (now.acceleration - before.acceleration) / PERIOD;
            let slack = 1.0 + 1e-9;
            prop_assert!(now.velocity.abs() <= LIMITS.velocity * slack);
            prop_assert!(now.acceleration.abs() <= LIMITS.acceleration * slack);
            prop_assert!(jerk.abs() <= LIMITS.jerk * slack, "jerk {jerk}");
            before = now;
        }
        prop_assert_eq!(before.position, 0.5);
    }
}
