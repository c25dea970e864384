//! Moves of several joints go with the trains of their ways, and a stop holds for one that waits for its trains.

use quell::service::contract::{Accepted, Phase, Request, ServiceError, Target};

use super::modes::{go, of_together, posed, world};

/// A mode that goes from 8 to 11 Hz over the pose: the train that stands is one for another way.
#[test]
fn a_move_of_several_joints_has_the_train_of_its_way() {
    let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let mut shaped = world(data.path(), 9.0, &[posed()]);
    let mut unshaped = world(other.path(), 9.0, &[posed()]);
    for degrees in [60.0_f64, 0.0, 30.0, 60.0, 0.0] {
        go(&mut shaped, degrees.to_radians(), None);
    }
    let (mut sum, mut sum_unshaped) = (0.0, 0.0);
    // The train that stands is that of the way from 60 to 0 degrees.
    for degrees in [12.0_f64, 0.0, 60.0, 48.0] {
        let target = degrees.to_radians();
        let (_, all) = go(&mut unshaped, target, Some("none"));
        let (_, left) = of_together(&mut shaped, target);
        println!("to {degrees}: {:.2} % of {all:e}", 100.0 * left / all);
        (sum, sum_unshaped) = (sum + left, sum_unshaped + all);
    }
    assert!(sum < 0.02 * sum_unshaped, "{sum} of {sum_unshaped} rad");
}

#[test]
fn a_stop_holds_for_a_move_that_waits_for_its_trains() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = world(data.path(), 9.0, &[posed()]);
    for degrees in [40.0_f64, 0.0] {
        go(&mut world, degrees.to_radians(), None);
    }
    let stood = world.joint().phase;
    assert_eq!(stood, Phase::Rest);
    let joint = "joint_1".to_owned();
    let targets = vec![Target { joint, target: 0.5 }];
    world.ask(Request::MoveTogether {
        targets,
        shaper: None,
        tolerance: None,
    });
    world.ask(Request::Stop);
    let mut answers = Vec::new();
    for _ in 0..500 {
        answers.extend(world.step().into_iter().map(|one| one.answer));
        assert_eq!(world.joint().phase, Phase::Rest);
    }
    assert!(answers.contains(&Err(ServiceError::Stopped)), "{answers:?}");
    let begun = answers
        .iter()
        .any(|one| matches!(one, Ok(Accepted::Together { .. })));
    assert!(!begun, "{answers:?}");
}
