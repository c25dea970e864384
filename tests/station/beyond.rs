//! Readings that are no position of any robot: what is no number in JSON, and what no arithmetic bears.

use quell::service::contract::{FaultKind, ModeValue, Phase, Request};

use super::modes::{go, world as arm_world};
use super::plant::PlantMode;
use super::world::{STANDSTILL, World, config, first_beyond_limits};

/// No number, as various languages write it, or beyond what a datagram may say: no reading.
const NO_READING: [&str; 8] = [
    "NaN",
    "nan",
    "-nan",
    "-Infinity",
    "inf",
    "1e999",
    "1.7976931348623157e308",
    "-1e13",
];
/// What is not said.
const ABSENT: &str = "null";
/// The largest that a datagram may say.
const LARGEST: [&str; 2] = ["1e12", "-1e12"];
const TARGET: f64 = 1.5;

/// Each reading in the place of each quantity.
fn cases(
    readings: &[&'static str],
    quantities: [&'static str; 2],
) -> Vec<(&'static str, &'static str)> {
    let of = |&reading: &&'static str| quantities.map(|quantity| (reading, quantity));
    readings.iter().flat_map(of).collect()
}

/// At full speed on its way to the target.
fn moving(data: &std::path::Path) -> World {
    let mut world = World::commanded(config(data), true);
    world.go(TARGET);
    world.steps(60);
    assert_eq!(world.joint().phase, Phase::Moving);
    world
}

/// Steps with datagrams that have this reading; the motor side's is true unless it is the one.
fn says(world: &mut World, quantity: &str, reading: &str, steps: usize) {
    world.robot.silent = true;
    for _ in 0..steps {
        let [stamp, motor] = match quantity {
            "t" => [reading.to_string(), world.robot.position.to_string()],
            "motor_position" => [stamp(world), reading.to_string()],
            _ => [stamp(world), world.robot.position.to_string()],
        };
        let more = match quantity {
            "t" | "motor_position" => String::new(),
            _ => format!(",\"{quantity}\":{reading}"),
        };
        let datagram =
            format!("{{\"t\":{stamp},\"joint\":\"joint_1\",\"motor_position\":{motor}{more}}}");
        world.hear(datagram.as_bytes());
        world.step();
    }
    world.robot.silent = false;
}

fn stamp(world: &World) -> String {
    format!("{:.6}", world.clock.now() + world.robot.ahead)
}

/// Braked within the limits before the target, for this reason.
fn is_stopped(world: &World, before: usize, case: &str) -> (FaultKind, String) {
    let sent = world.sent().split_off(before);
    assert_eq!(first_beyond_limits(&sent, true), None, "{case}");
    let last = sent.last().expect("setpoints").1;
    assert!(
        last.velocity == 0.0 && last.position < TARGET - 0.1,
        "{case}: {last:?}"
    );
    let view = world.snapshot().enable.clone();
    (view.fault.expect("a fault"), view.reason)
}

#[test]
fn a_motor_side_without_a_believable_reading_stops_the_robot_and_says_why() {
    let readings = [&NO_READING[..], &[ABSENT], &LARGEST].concat();
    for (reading, quantity) in cases(&readings, ["motor_position", "t"]) {
        let case = format!("{quantity} {reading}");
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        let before = world.sent().len();
        says(&mut world, quantity, reading, 150);
        let (fault, reason) = is_stopped(&world, before, &case);
        let malformed = world.snapshot().link.malformed;
        match (malformed, fault) {
            (0, FaultKind::Sensor) => {
                let why = if LARGEST.contains(&reading) {
                    "jump"
                } else {
                    "not finite"
                };
                assert!(reason.ends_with(&format!("({why})")), "{case}: {reason}");
                let joint = world.snapshot().enable.joint.clone();
                assert_eq!(joint.as_deref(), Some("joint_1"), "{case}");
            }
            // Stamps that stand still are no time that goes by.
            (0, FaultKind::LinkLost) => assert_eq!(quantity, "t"),
            (_, FaultKind::LinkLost) => {
                assert!(quantity == "t" || reading == ABSENT, "{case}");
                assert!(reason.ends_with("were malformed"), "{case}: {reason}");
            }
            other => panic!("{case}: {other:?} {reason}"),
        }
    }
}

#[test]
fn one_reading_that_is_lost_among_good_ones_stops_nothing() {
    let readings = [&NO_READING[..], &[ABSENT]].concat();
    for (reading, quantity) in cases(&readings, ["motor_position", "t"]) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        says(&mut world, quantity, reading, 1);
        world.steps(400);
        let at = world.last().map(|(_, sent)| sent.position);
        assert_eq!(at, Some(TARGET), "{quantity} {reading}");
        assert_eq!(first_beyond_limits(&world.sent(), true), None);
    }
}

/// The second sensor is not needed for a move, and nothing is learned from what it cannot have measured. Whatever it says,
/// the reading of the encoder in the same datagram is taken.
#[test]
fn a_second_sensor_beyond_all_reason_neither_moves_nor_teaches() {
    let readings = [&NO_READING[..], &[ABSENT], &LARGEST].concat();
    for (reading, quantity) in cases(&readings, ["deformation", "link_position"]) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        let believed: Option<ModeValue> = world.joint().mode;
        says(&mut world, quantity, reading, 600);
        let case = format!("{quantity} {reading}");
        assert_eq!(first_beyond_limits(&world.sent(), true), None, "{case}");
        let at = world.last().map(|(_, sent)| sent.position);
        assert_eq!(at, Some(TARGET), "{case}");
        let joint = world.joint();
        assert_eq!(
            (joint.mode, joint.learning.modes.len()),
            (believed, 0),
            "{case}"
        );
        assert_eq!(world.snapshot().link.malformed, 0, "{case}");
        let sensor = joint.sensors.iter().find(|sensor| sensor.name == quantity);
        if NO_READING.contains(&reading) {
            let sensor = sensor.expect("its samples are counted");
            assert_eq!(sensor.fault, Some("not_finite"), "{case}");
            // All that had come when the state was told.
            let [("not_finite", refused)] = sensor.refused[..] else {
                panic!("{case}: {sensor:?}");
            };
            assert!(refused == sensor.samples && refused > 500, "{case}");
        }
        // The next move is as if nothing had been.
        world.go(0.0);
        world.steps(600);
        assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.0));
        assert_eq!(world.joint().mode, believed, "{case}");
    }
}

/// Commanded where it says that it stands, it goes nowhere from there.
#[test]
fn a_joint_that_says_that_it_stands_where_no_joint_is_gets_no_move() {
    for reading in [1e12, -1e12, 1e6] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = World::start(config(data.path()), 1e9, reading, true);
        world.steps(STANDSTILL);
        world.enable();
        world.steps(10);
        for target in [0.0, 6.0, -6.0] {
            world.go(target);
            let answered = world.steps(60);
            let refused = answered[0].answer.clone().expect_err("no plan").to_string();
            let why = refused.strip_prefix("the move cannot be planned: ");
            let says = |why: &str| why.contains("start position") || why.contains("longer than");
            assert!(why.is_some_and(says), "{reading}: {refused}");
        }
        assert!(
            world
                .sent()
                .iter()
                .all(|(_, sent)| sent.position == reading)
        );
    }
}

/// A tracker that sees its marker every third time says so: what it does see teaches.
#[test]
fn a_second_sensor_with_gaps_teaches_what_it_sees() {
    let data = tempfile::tempdir().expect("a folder");
    let arm = [PlantMode::new(8.0, 0.03, 1.0)];
    let mut world = arm_world(data.path(), 10.0, &arm);
    world.robot.sees_every = 3;
    for target in [0.8, 0.0] {
        go(&mut world, target, None);
    }
    let joint = world.joint();
    let learned = joint.mode.expect("a mode").frequency_hz;
    assert!((learned / 8.0 - 1.0).abs() < 0.01, "{learned} Hz");
    let sensor = joint.sensors.iter().find(|one| one.name == "deformation");
    let sensor = sensor.expect("a sensor");
    let (reason, without) = sensor.refused[0];
    assert!(
        reason == "not_finite" && 2 * without > sensor.samples && sensor.fault.is_none(),
        "{sensor:?}"
    );
    assert_eq!(world.snapshot().enable.faults, 0);
    assert_eq!(world.snapshot().link.malformed, 0);
}

/// An encoder that has never sent a number is what the refusal names.
#[test]
fn a_joint_whose_encoder_sends_no_number_is_not_enabled() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::start(config(data.path()), 1e9, 0.0, true);
    says(&mut world, "motor_position", "NaN", 2 * STANDSTILL);
    world.ask(Request::Enable);
    let answered = world.step();
    let refused = answered[0].answer.clone().expect_err("nothing is known");
    assert!(refused.to_string().contains("not finite"), "{refused}");
    assert!(world.sent().is_empty());
    // Its first numbers are believed.
    world.steps(2 * STANDSTILL);
    world.enable();
    assert!(world.step().iter().all(|one| one.answer.is_ok()));
}
