//! Sensors that fail in the service: the last good train stays, and moves go on.

use quell::service::contract::{Phase, Snapshot, WatchdogState};

use super::robot::Fault;
use super::{check, go, mislead, phase_is, result, udp, wait};

fn fault(snapshot: &Snapshot) -> Option<&'static str> {
    let sensors = &snapshot.joints[0].sensors;
    let link = sensors.iter().find(|s| s.name == "link_position");
    link.and_then(|sensor| sensor.fault)
}

#[test]
fn a_sensor_that_fails_teaches_nothing_and_the_last_good_train_stays() {
    let data = tempfile::tempdir().expect("a folder");
    let (_service, handle, robot) = udp(data.path());
    mislead(&handle);
    let first = go(&handle, 0.5, None);
    result(&handle, first);
    wait(&handle, "it has learned", |s| s.joints[0].retunes > 0);
    let mut target = 0.5;
    for (kind, name) in [
        (Fault::Stuck, Some("stuck")),
        (Fault::Jumps, Some("jump")),
        (Fault::Dead, None),
    ] {
        wait(&handle, "it rests", phase_is(Phase::Rest));
        let before = handle.snapshot();
        robot.fail(Some(kind));
        target = 0.5 - target;
        let id = go(&handle, target, None);
        if name.is_some() {
            let seen = wait(&handle, "the fault is seen", |s| fault(s) == name);
            assert!(seen.joints[0].adaptation_frozen, "{kind:?}");
        }
        let done = result(&handle, id);
        assert!(!done.interrupted && done.target_rad == target, "{done:?}");
        let after = handle.snapshot();
        assert_eq!(after.joints[0].mode, before.joints[0].mode, "{kind:?}");
        assert_eq!(after.joints[0].train, before.joints[0].train, "{kind:?}");
        // The motor side still speaks: there is no reason to stop.
        assert_eq!(after.joints[0].watchdog, WatchdogState::Fine);
        robot.fail(None);
        wait(&handle, "it is believed again", |s| {
            fault(s).is_none() && !s.joints[0].adaptation_frozen
        });
    }
    let snapshot = handle.snapshot();
    check(&robot.received.lock().expect("no panic"), &snapshot);
}
