//! Readings that are no position of any robot: what is no number in JSON, and what no arithmetic bears.

use quell::service::contract::{FaultKind, ModeValue, Phase};

use super::world::{STANDSTILL, World, config, first_beyond_limits};

/// Not JSON, or beyond what a datagram may say: nothing of the datagram is taken.
const UNREADABLE: [&str; 6] = [
    "NaN",
    "-Infinity",
    "1e999",
    "1.7976931348623157e308",
    "-1e13",
    "null",
];
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
    let readings = [&UNREADABLE[..], &LARGEST].concat();
    for (reading, quantity) in cases(&readings, ["motor_position", "t"]) {
        let case = format!("{quantity} {reading}");
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        let before = world.sent().len();
        says(&mut world, quantity, reading, 150);
        let (fault, reason) = is_stopped(&world, before, &case);
        let malformed = world.snapshot().link.malformed;
        match (malformed, fault) {
            (0, FaultKind::Sensor) => assert!(reason.ends_with("(jump)"), "{case}: {reason}"),
            // Stamps that stand still are no time that goes by.
            (0, FaultKind::LinkLost) => assert_eq!(quantity, "t"),
            (_, FaultKind::LinkLost) => {
                assert!(reason.ends_with("were malformed"), "{case}: {reason}");
            }
            other => panic!("{case}: {other:?} {reason}"),
        }
    }
}

#[test]
fn one_reading_that_is_lost_among_good_ones_stops_nothing() {
    for (reading, quantity) in cases(&UNREADABLE, ["motor_position", "t"]) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        says(&mut world, quantity, reading, 1);
        world.steps(400);
        let at = world.last().map(|(_, sent)| sent.position);
        assert_eq!(at, Some(TARGET), "{quantity} {reading}");
        assert_eq!(first_beyond_limits(&world.sent(), true), None);
    }
}

/// The second sensor is not needed for a move, and nothing is learned from what it cannot have measured.
#[test]
fn a_second_sensor_beyond_all_reason_neither_moves_nor_teaches() {
    for (reading, quantity) in cases(&LARGEST, ["deformation", "link_position"]) {
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
