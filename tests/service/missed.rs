//! Ticks that are missed: over the time that has really gone by the command keeps its limits, it ends
//! exactly, and the arm hardly rings for it.

use std::sync::{Arc, Mutex};

use proptest::prelude::*;
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::service::between::{between, inexact};
use quell::service::bridged::bridged;
use quell::service::contract::{LinkHealth, Measured};
use quell::service::link::RobotLink;
use quell::service::tick::gate::{Cause, Trip};
use quell::service::tick::{
    EngineRings, Event, JointTick, Plan, Record, Start, Tick, ToTick, Train,
};
use quell_shapers::{GridTrain, Setpoint, Shaper, UncertainMode, shaper_by_name};

use super::tick::{controller, joint, plan};

const PERIOD: f64 = 0.001;

/// The behaviour of a robot while no setpoint comes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Manner {
    /// It holds the last one, which is the worst that it can do.
    Holds,
    /// It goes by the stamps, from one to the next, a setpoint late.
    ByStamps,
}

struct Listener {
    arm: Option<(ArmSimulation, Manner)>,
    setpoints: [(f64, Setpoint); 2],
    time: f64,
    told: Arc<Mutex<Told>>,
}

#[derive(Default)]
struct Told {
    setpoints: Vec<(f64, Setpoint)>,
    deformation: f64,
}

impl Told {
    fn rests(&self) -> bool {
        let last = self.setpoints.last();
        last.is_some_and(|(_, last)| *last == Setpoint::at_rest(0.5))
    }
}

impl RobotLink for Listener {
    fn receive(&mut self, now: f64, _inbox: &mut Vec<Measured>) {
        let Some((arm, manner)) = &mut self.arm else {
            return;
        };
        let [from, to] = self.setpoints;
        let length = match manner {
            Manner::Holds => now - self.time,
            Manner::ByStamps => to.0 - from.0,
        };
        self.time = now;
        let periods = (length / PERIOD).round();
        for period in 1..=periods as usize {
            let setpoint = match manner {
                Manner::Holds => to.1,
                Manner::ByStamps => between([from.1, to.1], period as f64 / periods, length),
            };
            let command = Command {
                position: setpoint.position,
                velocity: Some(setpoint.velocity),
            };
            arm.step(command, PERIOD);
        }
        let deformation = arm.true_link_position() - arm.true_motor_position();
        self.told.lock().expect("no panic").deformation = deformation;
    }

    fn carries_time(&self) -> bool {
        true
    }

    fn send(&mut self, now: f64, _joint: usize, setpoint: &Setpoint) {
        self.setpoints = [self.setpoints[1], (now, *setpoint)];
        let mut told = self.told.lock().expect("no panic");
        told.setpoints.push((now, *setpoint));
    }

    fn counters(&self) -> LinkHealth {
        LinkHealth::default()
    }
}

/// A tick over an arm, if any, a train for the true mode or none, and a move to 0.5 rad ordered.
fn bench(shaped: bool, manner: Option<Manner>) -> (Tick, EngineRings, Arc<Mutex<Told>>) {
    bench_of(joint(&Robot::rx170()), shaped, manner)
}

/// The same of a joint.
fn bench_of(
    joint: JointTick,
    shaped: bool,
    manner: Option<Manner>,
) -> (Tick, EngineRings, Arc<Mutex<Told>>) {
    let robot = Robot::rx170();
    let arm = ArmSimulation::new(&robot, 0, &SimulationOptions::default()).expect("an arm");
    let told: Arc<Mutex<Told>> = Arc::default();
    let mode = robot.joints[0].modes[0].mode;
    let link = Box::new(Listener {
        arm: manner.map(|manner| (arm, manner)),
        setpoints: [(0.0, Setpoint::at_rest(0.0)); 2],
        time: 0.0,
        told: Arc::clone(&told),
    });
    let (tick, mut rings) = Tick::new(vec![joint], link, PERIOD);
    let zvd = shaper_by_name("zvd").expect("a shaper");
    let train = match shaped {
        true => zvd.on_grid(mode, PERIOD).expect("a train"),
        false => GridTrain::identity(PERIOD).expect("a train"),
    };
    let train = Train {
        shaper: shaped.then_some(zvd as &'static dyn Shaper),
        known: UncertainMode::believed(mode),
        train,
        retunes: 0,
        hold: None,
    };
    let move_ = Plan {
        joint: 0,
        id: 1,
        ticket: 1,
        samples: Some(plan(&robot, 0.0, 0.5)),
        start: Start::Rest(Box::new(train)),
        together: None,
        permit: Some(1),
    };
    let begin = ToTick::Begin(0, Box::new(controller(&robot, zvd, mode)));
    let enable = ToTick::Enable {
        permit: 1,
        trips: 0,
    };
    for order in [begin, enable, ToTick::Plan(Box::new(move_))] {
        rings.orders.push(order);
    }
    (tick, rings, told)
}

/// The bounds of one setpoint after the one before it, by the time between them.
fn check(before: (f64, Setpoint), now: (f64, Setpoint)) -> Result<(), TestCaseError> {
    let limits = Robot::rx170().joints[0].limits;
    let slack = 1.0 + 1e-9;
    let gone = now.0 - before.0;
    let (before, now) = (before.1, now.1);
    prop_assert!(now.velocity.abs() <= limits.velocity * slack);
    prop_assert!(now.acceleration.abs() <= limits.acceleration * slack);
    let step = (now.position - before.position).abs();
    prop_assert!(step <= limits.velocity * gone * slack, "{step} in {gone} s");
    if gone > (bridged(PERIOD) as f64 + 1.5) * PERIOD {
        // The robot has stopped: it is led on from where it was, from no velocity.
        prop_assert!(step < limits.jerk * PERIOD.powi(3), "a jump of {step}");
        prop_assert!(now.velocity.abs() < limits.jerk * PERIOD.powi(2));
        return Ok(());
    }
    let change = (now.acceleration - before.acceleration).abs();
    prop_assert!(
        change <= limits.jerk * gone * slack + 1e-9,
        "{change} in {gone} s"
    );
    let mean = 0.5 * (before.velocity + now.velocity);
    let jump = (now.position - before.position - gone * mean).abs();
    // The trapezoidal rule's error where the jerk is bounded, and that of velocities between two samples.
    let bound = limits.jerk * gone.powi(3) * (1.0 / 12.0 + 1.0 / 8.0) * slack + 1e-13;
    prop_assert!(jump <= bound, "a jump of {jump}, {bound} allowed");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_is_missed_the_command_keeps_its_limits_and_ends_exactly(
        gaps in prop::collection::vec((1..150u64, prop_oneof![0..4u64, 0..25u64, 15..200u64]), 1..12),
        shaped in any::<bool>(),
    ) {
        let (mut tick, mut rings, told) = bench(shaped, None);
        let mut due = 0u64;
        let end = std::iter::once((6000, 0));
        'all: for (ticks, missed) in gaps.into_iter().chain(end) {
            for k in 0..ticks {
                let missed = if k == 0 { missed } else { 0 };
                if told.lock().expect("no panic").rests() {
                    break 'all;
                }
                due += missed + 1;
                tick.run(due as f64 * PERIOD, missed);
                while rings.records.pop().is_ok() {}
            }
        }
        let told = told.lock().expect("no panic");
        for pair in told.setpoints.windows(2) {
            check(pair[0], pair[1])?;
        }
        let last = told.setpoints.last().map(|(_, setpoint)| *setpoint);
        prop_assert_eq!(last, Some(Setpoint::at_rest(0.5)));
    }
}

/// The largest deformation over two periods once the motor side has followed. Once, at some tick, so
/// many are missed; they are made up for or, as if nobody had told, not.
fn left((at, missed): (u64, u64), made_up: bool, shaped: bool, manner: Manner) -> f64 {
    let (mut tick, mut rings, told) = bench(shaped, Some(manner));
    let (mut due, mut most, mut settled) = (0u64, 0.0f64, None);
    for count in 0.. {
        let gap = if count == at { missed } else { 0 };
        due += gap + 1;
        tick.run(due as f64 * PERIOD, if made_up { gap } else { 0 });
        while rings.records.pop().is_ok() {}
        let told = told.lock().expect("no panic");
        if told.rests() {
            let since = due - *settled.get_or_insert(due);
            if since >= 350 {
                break;
            }
            if since >= 100 {
                most = most.max(told.deformation.abs());
            }
        }
    }
    most
}

#[test]
fn ticks_that_are_made_up_for_leave_an_arm_far_calmer() {
    let unshaped = left((0, 0), true, false, Manner::Holds);
    for manner in [Manner::Holds, Manner::ByStamps] {
        for missed in [1, 2, 5, 10, 19] {
            // At ten instants of the move: the mean square does not depend on the phase of the mode.
            let left = |made_up| {
                let at = (0..10).map(|k| 150 + 40 * k);
                let squares = at.map(|at| left((at, missed), made_up, true, manner).powi(2));
                (squares.sum::<f64>() / 10.0).sqrt() / unshaped
            };
            let [held, made_up] = [left(false), left(true)];
            println!(
                "{manner:?}, {missed} ticks missed: {:.2} % of the unshaped vibration is left where \
                 the command waits, {:.2} % where it is made up for",
                100.0 * held,
                100.0 * made_up
            );
            let most = match manner {
                // A time h leaves w h / 2 of what a delay by it leaves (8 Hz); the rest is the servo.
                Manner::Holds => held * (51.0 * (missed + 1) as f64 * PERIOD / 2.0) * 1.5,
                Manner::ByStamps => 0.03,
            };
            assert!(made_up <= most, "{manner:?}, {missed}: {made_up} of {held}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the engine has planned: the tick brakes within the limits before the end of the range, closes the gate, and
    /// tells both once. It brakes on where the engine takes its controller, and where ticks are missed.
    #[test]
    fn no_command_beyond_the_range_is_sent(
        end in 0.02..0.48_f64,
        shaped in any::<bool>(),
        (at, missed) in (0..1200_u64, 0..40_u64),
        ceases in any::<bool>(),
    ) {
        let robot = Robot::rx170();
        let joint = joint(&robot).ranging_within([-0.1, end], PERIOD);
        let (mut tick, mut rings, told) = bench_of(joint, shaped, None);
        let (mut due, mut left, mut trips) = (0, 0, Vec::new());
        let mut recorded = Vec::new();
        for k in 0..3000 {
            let gap = if k == at { missed } else { 0 };
            due += gap + 1;
            tick.run(due as f64 * PERIOD, gap);
            while let Ok(event) = rings.events.pop() {
                match event {
                    Event::Tripped(trip) => trips.push(trip),
                    Event::Left(index) => {
                        left += 1;
                        // The reason is there when the move ends.
                        prop_assert_eq!(trips.len(), 1);
                        if ceases {
                            rings.orders.push(ToTick::Cease(index));
                        }
                    }
                    _ => {}
                }
            }
            while let Ok(record) = rings.records.pop() {
                if let Record::Tick(row, _) = record {
                    recorded.push((row.time, row.position));
                }
            }
        }
        let told = told.lock().expect("no panic");
        // Each setpoint is in the records, those of the brake, too.
        let mut sent = told.setpoints.iter().map(|(time, sent)| (*time, sent.position));
        let missing = sent.find(|one| !recorded.contains(one));
        prop_assert_eq!(missing, None);
        let most = end + inexact(robot.joints[0].limits, PERIOD);
        for pair in told.setpoints.windows(2) {
            check(pair[0], pair[1])?;
            prop_assert!(pair[1].1.position <= most, "{:?}", pair[1]);
        }
        let last = told.setpoints.last().expect("setpoints").1;
        prop_assert_eq!(last, Setpoint::at_rest(last.position));
        prop_assert_eq!(left, 1);
        let [Trip { joint: Some(0), cause: Cause::Range(beyond) }] = trips[..] else {
            return Err(TestCaseError::fail(format!("{trips:?}")));
        };
        prop_assert!(beyond > most, "{beyond}");
    }

    /// A command within the range is sent as it is planned, to the very end of the range.
    #[test]
    fn a_command_up_to_the_end_of_the_range_is_sent_as_it_is(
        shaped in any::<bool>(),
        (at, missed) in (0..1200_u64, 0..40_u64),
    ) {
        let sent = [0.5, f64::INFINITY].map(|end| {
            let joint = joint(&Robot::rx170()).ranging_within([0.0, end], PERIOD);
            let (mut tick, mut rings, told) = bench_of(joint, shaped, None);
            let mut due = 0;
            for k in 0..3000 {
                let gap = if k == at { missed } else { 0 };
                due += gap + 1;
                tick.run(due as f64 * PERIOD, gap);
                while rings.records.pop().is_ok() {}
            }
            let told = told.lock().expect("no panic");
            told.setpoints.clone()
        });
        prop_assert_eq!(&sent[0], &sent[1]);
        prop_assert_eq!(sent[0].last().map(|last| last.1), Some(Setpoint::at_rest(0.5)));
    }
}
