//! One tick of 1 to 1000 joints in one process: time and memory a joint, and their exponents.
//!
//! `cargo bench --bench axes`: the service's tick without its clock. Every joint has a controller of its
//! own, the likelihood estimator and two sensors, and all make the same move of 30 degrees, again and
//! again. What is measured is made before, on one simulated arm.

#[path = "../tests/embedded/mod.rs"]
mod embedded;

use std::sync::Arc;

use embedded::axis_settings;
use quell::controller::Controller;
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::service::contract::{LinkHealth, Measured, Quantity};
use quell::service::guard::Bounds;
use quell::service::link::RobotLink;
use quell::service::tick::{EngineRings, JointTick, Tick, ToTick, Watchdog};
use quell_shapers::{Mode, Setpoint};
use quell_trajectories::{AxisState, Planner};
use rustix::time::{ClockId, clock_gettime};

const PERIOD: f64 = 0.004;
const WATCHDOG: Watchdog = Watchdog {
    timeout: 0.2,
    stops: false,
};
const JOINTS: [usize; 4] = [1, 10, 100, 1000];
/// Ticks of a move and its ringing out.
const TICKS: usize = 500;

/// Says for every joint what the one arm measured.
struct Echo {
    joints: usize,
    measured: Arc<Vec<[f64; 2]>>,
    tick: usize,
    counters: LinkHealth,
}

impl RobotLink for Echo {
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>) {
        let [motor, deformation] = self.measured[self.tick % self.measured.len()];
        let sensors = [
            (Quantity::MotorPosition, motor),
            (Quantity::Deformation, deformation),
        ];
        for joint in 0..self.joints {
            for (quantity, value) in sensors {
                if inbox.len() == inbox.capacity() {
                    self.counters.overflowed += 1;
                    continue;
                }
                inbox.push(Measured {
                    received: now,
                    stamp: now,
                    joint,
                    quantity,
                    value: [value, 0.0, 0.0],
                    refused: false,
                });
            }
        }
        self.tick += 1;
    }

    fn carries_time(&self) -> bool {
        true
    }

    fn send(&mut self, _: f64, _: usize, _: &Setpoint) {
        self.counters.sent += 1;
    }

    fn counters(&self) -> LinkHealth {
        self.counters
    }
}

/// Motor position and deformation at each tick of an unshaped move.
fn measured(robot: &Robot) -> Vec<[f64; 2]> {
    let mut arm = ArmSimulation::new(robot, 0, &SimulationOptions::default()).expect("an arm");
    let ends = [0.0, 0.5].map(AxisState::at_rest);
    let planner = Planner::new(1).expect("a planner");
    let plan = planner.plan(&ends[..1], &ends[1..], &[robot.joints[0].limits]);
    let plan = plan.expect("a plan");
    let at = |tick: usize| {
        let state = plan.state_at((tick as f64 * PERIOD).min(plan.duration()))[0];
        let command = Command {
            position: state.position,
            velocity: Some(state.velocity),
        };
        arm.step(command, PERIOD);
        [arm.true_motor_position(), arm.true_deformation()]
    };
    (0..TICKS).map(at).collect()
}

fn controller() -> Controller {
    let belief = Mode::from_hertz(9.0, 0.084).expect("a mode");
    let settings = axis_settings(belief, PERIOD, PERIOD);
    Controller::new(settings, 0.0).expect("a controller")
}

fn made(robot: &Robot, joints: usize, measured: &Arc<Vec<[f64; 2]>>) -> (Tick, EngineRings) {
    let bounds = Bounds {
        limits: robot.joints[0].limits,
        radius: f64::INFINITY,
        deformation: f64::MAX,
        resolution: robot.encoder.resolution,
    };
    let ticks = (0..joints).map(|joint| JointTick::new(joint, bounds, WATCHDOG, true, true));
    let link = Echo {
        joints,
        measured: Arc::clone(measured),
        tick: 0,
        counters: LinkHealth::default(),
    };
    let (tick, mut rings) = Tick::new(ticks.collect(), Box::new(link), PERIOD);
    for joint in 0..joints {
        let begin = ToTick::Begin(joint, Box::new(controller()));
        rings.orders.push(begin);
    }
    (tick, rings)
}

/// Of this thread's processor: the machine may be busy.
fn microseconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    1e6 * time.tv_sec as f64 + 1e-3 * time.tv_nsec as f64
}

/// Memory held, MB.
fn held() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|text| text.trim().strip_suffix("kB")?.trim().parse().ok());
    kilobytes.unwrap_or(f64::NAN) / 1024.0
}

fn main() {
    let robot = Robot::rx170();
    let measured = Arc::new(measured(&robot));
    println!(
        "| joints | us a tick | exponent | MB | exponent | us a tick, 99 % |\n|---|---|---|---|---|---|"
    );
    let mut before: Option<[f64; 3]> = None;
    for joints in JOINTS {
        let empty = held();
        let (mut tick, mut rings) = made(&robot, joints, &measured);
        let mut took: Vec<f64> = Vec::with_capacity(TICKS);
        for k in 0..TICKS {
            let since = microseconds();
            tick.run(k as f64 * PERIOD, 0);
            took.push(microseconds() - since);
            while rings.records.pop().is_ok() {}
            while rings.events.pop().is_ok() {}
        }
        let now = [
            joints as f64,
            took.iter().sum::<f64>() / TICKS as f64,
            held() - empty,
        ];
        took.sort_by(f64::total_cmp);
        let exponent = |k: usize| match before {
            Some(before) => format!(
                "{:.2}",
                (now[k] / before[k]).ln() / (now[0] / before[0]).ln()
            ),
            None => String::new(),
        };
        let (time, memory, late) = (exponent(1), exponent(2), took[TICKS * 99 / 100]);
        println!(
            "| {joints} | {:.1} | {time} | {:.1} | {memory} | {late:.1} |",
            now[1], now[2]
        );
        before = Some(now);
    }
}
