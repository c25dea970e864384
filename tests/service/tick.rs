//! The body of the tick: no allocation, whatever is ordered and measured.

use super::embedded::axis_settings;
use quell::controller::{AxisSettings, Controller};
use quell::plant::{ArmSimulation, Robot, SimulationOptions};
use quell::service::contract::TickStatistics;
use quell::service::guard::Bounds;
use quell::service::link::EmbeddedLink;
use quell::service::tick::{
    EngineRings, Event, JointTick, Plan, Start, Tick, ToTick, Train, TrainOrder, Watchdog,
};
use quell_shapers::{Mode, Shaper, UncertainMode, shaper_by_name};
use quell_trajectories::{AxisState, Planner, SampledTrajectory};

const PERIOD: f64 = 0.001;

pub fn controller(robot: &Robot, shaper: &'static dyn Shaper, belief: Mode) -> Controller {
    let settings = AxisSettings {
        limits: robot.joints[0].limits,
        shaper: Some(shaper),
        ..axis_settings(belief, PERIOD, 0.003)
    };
    let controller = Controller::new(settings, 0.0);
    controller.expect("a controller")
}

pub fn plan(robot: &Robot, from: f64, to: f64) -> SampledTrajectory {
    let ends = [AxisState::at_rest(from), AxisState::at_rest(to)];
    let planner = Planner::new(1).expect("a planner");
    let plan = planner.plan(&ends[..1], &ends[1..], &[robot.joints[0].limits]);
    plan.expect("a plan").sample(PERIOD).expect("samples")
}

/// A joint whose sensor's frame is known.
pub fn joint(robot: &Robot) -> JointTick {
    let bounds = Bounds {
        limits: robot.joints[0].limits,
        radius: f64::INFINITY,
        deformation: f64::MAX,
        resolution: robot.encoder.resolution,
    };
    let watchdog = Watchdog {
        timeout: 0.2,
        stops: false,
    };
    JointTick::new(0, bounds, watchdog, true, true)
}

/// Empties the rings as the engine does; says how many plans were taken and refused.
fn drain(rings: &mut EngineRings) -> [usize; 2] {
    let mut counted = [0, 0];
    while let Ok(event) = rings.events.pop() {
        match event {
            Event::Taken(_) => counted[0] += 1,
            Event::NotTaken(..) => counted[1] += 1,
            _ => {}
        }
    }
    while rings.records.pop().is_ok() {}
    while rings.joints.pop().is_ok() {}
    while rings.whole.pop().is_ok() {}
    counted
}

#[test]
fn twenty_thousand_ticks_with_orders_do_not_allocate() {
    let robot = Robot::rx170();
    let arm = ArmSimulation::new(&robot, 0, &SimulationOptions::default()).expect("an arm");
    let loads = [0.0, 40.0].map(|payload| arm.load(payload).expect("a load"));
    let link = Box::new(EmbeddedLink::new(arm, PERIOD));
    let (mut tick, mut rings) = Tick::new(vec![joint(&robot)], link, PERIOD);
    let zvd = shaper_by_name("zvd").expect("a shaper");
    let belief = Mode::from_hertz(10.15, 0.084).expect("a mode");
    let begin = ToTick::Begin(0, Box::new(controller(&robot, zvd, belief)));
    let enable = ToTick::Enable {
        permit: 1,
        trips: 0,
    };
    for order in [begin, enable] {
        rings.orders.push(order);
    }
    let (mut allocations, mut counted) = (0, [0, 0]);
    for k in 0..20_000u64 {
        // Each second: a load, a train that may be out of date, and a plan from where the last ended.
        if k % 2000 == 500 {
            let mode = Mode::from_hertz(9.0, 0.08).expect("a mode");
            let train = Train {
                shaper: Some(zvd),
                known: UncertainMode::believed(mode),
                train: zvd.on_grid(mode, PERIOD).expect("a train"),
                retunes: 0,
                hold: None,
            };
            let index = (k / 2000) as usize;
            let order = Box::new(TrainOrder {
                joint: 0,
                train: train.clone(),
            });
            let from = if index.is_multiple_of(2) { 0.0 } else { 0.5 };
            let plan = Plan {
                joint: 0,
                id: k,
                ticket: k,
                samples: Some(plan(&robot, from, 0.5 - from)),
                start: Start::Rest(Box::new(train)),
                together: None,
                permit: Some(1),
            };
            let orders = [
                ToTick::Carry(loads[index % 2].clone()),
                ToTick::Train(order),
                ToTick::Plan(Box::new(plan)),
            ];
            for order in orders {
                rings.orders.push(order);
            }
        }
        let now = k as f64 * PERIOD;
        let measured = allocation_counter::measure(|| {
            tick.run(now, 0);
            tick.report(now, TickStatistics::default());
        });
        allocations += measured.count_total;
        let [taken, refused] = drain(&mut rings);
        counted = [counted[0] + taken, counted[1] + refused];
    }
    assert_eq!(allocations, 0);
    // The first is taken; once an estimate has changed the train, those made before it are not.
    assert!(counted[0] >= 1 && counted[1] >= 1, "{counted:?}");
}
