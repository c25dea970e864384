//! Several modes, and modes that follow pose and payload: what is left of the vibration from move to move, of arms whose
//! dynamics share nothing with what is tested.

mod plant;
mod programme;
mod random;

use plant::{Faults, PlantMode};
use programme::{Left, Policy, Programme, median, percent, worst};
use quell::controller::Controller;
use quell::learning::{Inertia, Learner, Surroundings};
use rayon::prelude::*;

fn arm(modes: &[PlantMode], belief_hz: f64, degrees: &[f64]) -> Programme {
    let moves = degrees.iter().map(|target| (target.to_radians(), 0.0));
    Programme {
        name: String::new(),
        modes: modes.to_vec(),
        faults: Faults::USUAL,
        belief_hz,
        shaper: "zvd",
        start: 0.0,
        moves: moves.collect(),
        declared: 1.0,
        inertia: None,
        seed: 1,
    }
}

/// Each move's share of what it leaves unshaped, %.
fn left(programme: &Programme) -> Vec<f64> {
    let [unshaped, learned] = [Policy::Unshaped, Policy::Learned].map(|p| programme.run(p));
    let all = percent(&learned, &unshaped);
    println!("{} {all:.2?}", programme.name);
    for left in &learned {
        println!(
            "{:.3} s, {} retunes, {}",
            left.delay, left.retunes, left.said
        );
    }
    all
}

/// One mode that stays needs no more than adaptation in motion, and is left to it.
#[test]
fn one_mode_is_left_to_adaptation_in_motion() {
    let programme = arm(&[PlantMode::new(8.0, 0.03, 1.0)], 10.0, &TARGETS);
    let learned = left(&programme);
    let [unshaped, adaptive] = [Policy::Unshaped, Policy::Adaptive].map(|p| programme.run(p));
    let adaptive = percent(&adaptive, &unshaped);
    assert!(
        worst(&learned) <= worst(&adaptive) + 0.2,
        "{learned:?} {adaptive:?}"
    );
}

const TARGETS: [f64; 8] = [60.0, 0.0, 30.0, 55.0, 10.0, 45.0, 5.0, 60.0];

#[test]
fn two_modes_are_shaped_for_after_a_move() {
    for (share, belief) in [(1.0 / 3.0, 8.0), (1.0 / 3.0, 10.0), (1.0, 8.5)] {
        let modes = [
            PlantMode::new(8.0, 0.03, 1.0),
            PlantMode::new(19.0, 0.03, share),
        ];
        let all = left(&arm(&modes, belief, &TARGETS));
        let late = &all[2..];
        assert!(
            median(late) <= 1.0 && worst(late) <= 2.0,
            "{share} {belief}: {all:?}"
        );
    }
}

#[test]
fn three_modes_are_shaped_for_after_a_move() {
    let modes = [(8.0, 1.0), (19.0, 1.0), (31.0, 1.5)];
    let modes = modes.map(|(hertz, share)| PlantMode::new(hertz, 0.03, share));
    let all = left(&arm(&modes, 9.0, &TARGETS));
    let late = &all[2..];
    assert!(median(late) <= 1.0 && worst(late) <= 2.0, "{all:?}");
}

fn posed() -> PlantMode {
    // 8 Hz at 0 degrees, 11 Hz at 60.
    PlantMode {
        slope: 3.0 / 8.0 / 60f64.to_radians(),
        ..PlantMode::new(8.0, 0.03, 1.0)
    }
}

#[test]
fn a_mode_that_follows_the_pose_is_shaped_for_along_the_way() {
    for belief in [8.0, 10.0] {
        let all = left(&arm(&[posed()], belief, &TARGETS));
        let late = &all[2..];
        assert!(
            median(late) <= 1.0 && worst(late) <= 3.0,
            "{belief}: {all:?}"
        );
    }
}

/// Ten moves in half of the range, then one into the other half.
#[test]
fn a_pose_never_visited_is_shaped_for_what_the_map_predicts() {
    let degrees = [
        30.0, 0.0, 20.0, 5.0, 25.0, 10.0, 30.0, 0.0, 15.0, 30.0, 60.0,
    ];
    let all = left(&arm(&[posed()], 9.0, &degrees));
    assert!(all[10] <= 4.0, "{all:?}");
}

/// `w^2 = k / J` follows the pose alike, but an inertia that changes pushes, too. Odds of twenty to one are usual for a finding.
#[test]
fn moves_tell_an_inertia_that_changes_from_a_stiffness() {
    for (folds, belief) in [(false, 8.0), (false, 10.0), (true, 8.0), (true, 10.0)] {
        let mode = PlantMode { folds, ..posed() };
        let programme = arm(&[mode], belief, &TARGETS);
        let (left, learner) = programme.run_and_learn(Policy::Learned);
        let all = percent(&left, &programme.run(Policy::Unshaped));
        let odds = learner.memory().odds;
        println!("folds {folds}, belief {belief} Hz: {odds:.1}, {all:.2?}");
        let certain = 20f64.ln();
        assert!(
            if folds {
                odds > certain
            } else {
                odds < -certain
            },
            "{odds}"
        );
        assert!(
            median(&all[2..]) <= 1.0 && worst(&all[2..]) <= 3.0,
            "{all:?}"
        );
    }
}

/// The first move with a payload between two that were carried, of a small arm and of a large one: kg that it carries at most.
#[test]
fn a_declared_payload_is_shaped_for_from_its_first_move() {
    let all = [0.5, 60.0, 500.0].map(declared_in);
    let late = all.iter().flat_map(|left| &left[2..]);
    assert!(late.clone().all(|left| *left <= 2.0), "{all:?}");
    // Nothing of it has a unit.
    for one in &all[1..] {
        assert_eq!(one.len(), all[0].len());
        assert!(one.iter().zip(&all[0]).all(|(a, b)| (a - b).abs() < 0.1));
    }
}

/// A gripper that no one tells of, on an arm whose first shaper fits it well. What was seen once may come again: from the
/// second change on no move leaves more than without adaptation, and all together leave a fifth of it.
#[test]
fn a_load_that_nobody_declares_may_change_again() {
    let modes = [(5.8, 0.045, 1.0), (13.3, 0.055, 0.5), (20.6, 0.06, 0.9)];
    let modes = modes.map(|(hertz, damping, share)| PlantMode {
        payload: 0.3,
        ..PlantMode::new(hertz, damping, share)
    });
    let mut programme = arm(&modes, 5.75, &TARGETS);
    programme.declared = 0.0;
    let payloads = [0.0, 0.0, 0.85, 0.85, 0.1, 0.1, 0.9, 0.9];
    for (entry, payload) in programme.moves.iter_mut().zip(payloads) {
        entry.1 = payload;
    }
    let [fixed, learned] = [Policy::Fixed, Policy::Learned].map(|policy| programme.run(policy));
    let over = percent(&learned, &fixed);
    assert!(worst(&over[3..]) <= 105.0, "{over:.0?} % of none");
    let square = |left: &[Left]| left[3..].iter().map(|l| l.residual.powi(2)).sum::<f64>();
    let all = (square(&learned) / square(&fixed)).sqrt();
    assert!(all <= 0.2, "{over:.0?} %, in all {all:.2} of none");
}

/// Payloads that nobody declares, learned in motion: what the arm did with the last one is none of the next one's vibration.
#[test]
fn a_payload_that_changes_between_moves_leaves_nothing_behind() {
    let loaded = PlantMode {
        payload: 0.8,
        ..PlantMode::new(8.0, 0.03, 1.0)
    };
    let mut programme = arm(&[loaded], 8.0, &TARGETS);
    let payloads = [0.0, 1.0, 0.5, 0.25, 0.75, 0.0, 0.9, 0.1];
    for (entry, payload) in programme.moves.iter_mut().zip(payloads) {
        entry.1 = payload;
    }
    let [unshaped, adaptive] = [Policy::Unshaped, Policy::Adaptive].map(|p| programme.run(p));
    let all = percent(&adaptive, &unshaped);
    assert!(worst(&all) <= 1.0, "{all:?}");
}

fn declared_in(most: f64) -> Vec<f64> {
    let loaded = PlantMode {
        payload: 0.8,
        ..PlantMode::new(8.0, 0.03, 1.0)
    };
    let mut programme = arm(&[loaded], 9.0, &[40.0, 0.0, 40.0, 0.0, 40.0, 0.0]);
    let payloads = [0.0, 1.0, 0.5, 0.25, 0.75, 0.1];
    for (entry, payload) in programme.moves.iter_mut().zip(payloads) {
        entry.1 = payload;
    }
    programme.declared = most;
    left(&programme)
}

/// Random arms with the faults of joints and sensors, in which the first moves teach; `cargo bench --bench modes -- --campaign 60` makes more of them.
#[test]
fn adaptation_hardly_ever_leaves_more_than_none() {
    let size = |left: &[Left]| left.iter().map(|l| l.residual.powi(2)).sum::<f64>().sqrt();
    let ratio = |seed: u64| {
        let programme = random::programme(seed);
        let [fixed, learned] = [Policy::Fixed, Policy::Learned].map(|policy| programme.run(policy));
        size(&learned) / size(&fixed)
    };
    let ratios: Vec<f64> = (2000..2004).into_par_iter().map(ratio).collect();
    println!("{ratios:.3?}");
    // The aim is 1.05 in 99 of 100: of these four and 120 others one, that with backlash here, is above, at 1.15.
    assert!(worst(&ratios) <= 1.25, "{ratios:?}");
    assert!(median(&ratios) < 1.0, "{ratios:?}");
}

/// One move over a third of the range, then to its other end: the map alone knows nothing of that pose, the description of the arm does, though
/// its bodies are not quite what it says.
#[test]
fn a_description_says_what_no_move_has_shown() {
    let pose = |position: f64| 1.0 + posed().slope * position;
    let described = Inertia::new(move |position, _: &[f64], _| {
        // A hundredth of the inertia that somebody believes, and a tenth more where the arm is stretched.
        0.01 * (1.0 + 0.1 * position) / pose(position).powi(2)
    });
    let mut programme = arm(&[posed()], 9.0, &[20.0, 0.0, 60.0, 20.0]);
    let without = left(&programme);
    programme.inertia = Some(described);
    let with = left(&programme);
    assert!(with[2] <= 1.0, "{without:?} {with:?}");
    assert!(with[2] <= without[2], "{without:?} {with:?}");
    // One that is wrong costs little: moves say what the inertia is.
    let wrong = move |position: f64, _: &[f64], _: f64| 5.0 * pose(position);
    programme.inertia = Some(Inertia::new(wrong));
    programme.moves = arm(&[posed()], 9.0, &TARGETS).moves;
    let wrong = left(&programme);
    assert!(
        median(&wrong[2..]) <= 1.0 && worst(&wrong[2..]) <= 3.0,
        "{wrong:?}"
    );
}

/// What is kept is what moves have said, whatever the description says by now: where they were, the frequencies stay.
#[test]
fn what_moves_have_said_outlives_the_description() {
    let heavy = |factor: f64, slope: f64| {
        Inertia::new(move |position, _: &[f64], payload| {
            factor * (1.0 + slope * position) + payload
        })
    };
    let positions = [0.0, 15.0, 30.0, 45.0].map(f64::to_radians);
    let curve = |learner: &Learner| {
        let charts = learner.chart(&positions, &Surroundings::default());
        let curve = charts[0].curve.iter().map(|at| at.natural_frequency);
        curve.collect::<Vec<_>>()
    };
    for before in [None, Some(heavy(1.0, -0.3))] {
        let mut programme = arm(&[posed()], 9.0, &[45.0, 0.0, 30.0, 0.0]);
        programme.inertia = before;
        let (_, taught) = programme.run_and_learn(Policy::Learned);
        for now in [None, Some(heavy(100.0, -0.3)), Some(heavy(0.5, 0.4))] {
            programme.inertia = now;
            let settings = programme.settings(Policy::Learned);
            let controller = Controller::new(settings, 0.0).expect("a controller");
            let mut other = programme.learner(&controller);
            assert!(other.remember(&taught.memory()));
            let pairs = curve(&taught).into_iter().zip(curve(&other));
            for (one, two) in pairs {
                assert!((one / two - 1.0).abs() < 2e-3, "{one} {two}");
            }
        }
    }
}
