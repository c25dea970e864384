//! The next move: it tells apart what a recording cannot, stays within what was recorded, and says so
//! where no motion helps.

use quell::diagnosis::{Diagnosis, Options, ProposedMove, Verdict, diagnose};
use quell::effects::{Effect, Place};
use quell::model::{Departure, Experiment, Model, Term, simulate};
use quell::recording::{Channel, Recording, Role};
use quell_trajectories::{AxisState, Limits, Planner};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Sampling period, s.
const PERIOD: f64 = 0.004;

fn joint() -> Model {
    let text = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.06\n";
    Model::from_toml(text, "model.toml").unwrap()
}

fn term(name: &str, place: Place, values: &[f64]) -> Term {
    Term::new(Effect::from_name(name).unwrap(), place, values.to_vec())
}

/// Positions of the motor side under moves from rest to rest, a rest before them.
fn positions(moves: &[ProposedMove]) -> Vec<f64> {
    let mut all = vec![0.0; 100];
    for one in moves {
        let from = all[all.len() - 1];
        let limits = Limits {
            velocity: one.speed,
            acceleration: one.acceleration,
            jerk: one.jerk,
        };
        let ends = [from, from + one.distance].map(AxisState::at_rest);
        let planned = Planner::new(1).unwrap();
        let planned = planned.plan(&ends[..1], &ends[1..], &[limits]).unwrap();
        all.extend(planned.sample(PERIOD).unwrap().positions(0));
        all.extend(vec![
            from + one.distance;
            (one.pause_s / PERIOD).ceil() as usize
        ]);
    }
    all
}

fn step(distance: f64, share: f64, pause_s: f64) -> ProposedMove {
    ProposedMove {
        distance,
        speed: share,
        acceleration: 8.0 * share,
        jerk: 200.0 * share,
        pause_s,
        unit: "rad".into(),
    }
}

/// The recording of a joint with these effects under these moves, with white noise.
fn recorded(truth: &[Term], moves: &[ProposedMove], noise: f64, seed: u64) -> Recording {
    let values = positions(moves);
    let time: Vec<f64> = (0..values.len()).map(|k| k as f64 * PERIOD).collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    let zeros = vec![0.0; values.len()];
    let mut recording = Recording {
        payload: None,
        name: format!("recording {seed}"),
        channels: vec![
            channel(Role::MotorPosition, values),
            channel(Role::LinkPosition, zeros),
        ],
    };
    let model = joint();
    let experiment = Experiment::new(&model, &recording).unwrap();
    let simulated = simulate(
        model.kind,
        &model.keys(),
        truth,
        &experiment,
        &Departure::default(),
    );
    let mut shown = simulated.predict(&experiment.outputs[0], 0.0).values;
    let (mut random, normal) = (ChaCha8Rng::seed_from_u64(seed), Normal::new(0.0, noise));
    let normal = normal.unwrap();
    shown
        .iter_mut()
        .for_each(|value| *value += normal.sample(&mut random));
    recording.channels[1].columns = vec![shown];
    recording
}

fn diagnosed(recordings: &[Recording]) -> Diagnosis {
    let outcome = diagnose(&joint(), recordings, &[], &Options::default(), &|_, _| {});
    outcome.unwrap().diagnosis
}

/// The effects that a diagnosis leaves in doubt: what it names and what it cannot tell from that.
fn doubtful(diagnosis: &Diagnosis) -> Vec<String> {
    let names = diagnosis.findings.iter().flat_map(|finding| {
        let alternatives = finding.alternatives.iter();
        std::iter::once(&finding.effect).chain(alternatives)
    });
    names.cloned().collect()
}

/// Chi-squared that the diagnosis sees nine times in ten.
const ENOUGH: f64 = 30.0;

/// Makes the proposed moves as often as it takes, where a recording leaves the truth in doubt and moves
/// are proposed; the explanations that are left must be fewer, and the truth among them. Says whether
/// this came to pass.
fn is_told_apart(truth: &Term, moves: &[ProposedMove], noise: f64, seed: u64) -> bool {
    let truth = std::slice::from_ref(truth);
    let mut recordings = vec![recorded(truth, moves, noise, seed)];
    let first = diagnosed(&recordings);
    let Some(next) = first
        .next_move
        .as_ref()
        .filter(|next| !next.moves.is_empty())
    else {
        return false;
    };
    println!("{} {}", next.expected_score, next.why);
    assert_eq!(first.verdict, Verdict::Ambiguous);
    assert!(next.expected_score >= 10.0 && next.separates[0] != next.separates[1]);
    for one in &next.moves {
        // The recorded moves are 0.5 rad at up to 1 rad/s, 8 rad/s^2 and 200 rad/s^3.
        assert!(one.unit == "rad" && one.distance.abs() <= 0.5 && one.pause_s > 0.0);
        assert!(one.speed <= 1.001 && one.acceleration <= 8.01 && one.jerk <= 200.2);
    }
    let times = (ENOUGH / next.expected_score).ceil() as u64;
    recordings.extend((0..times).map(|k| recorded(truth, &next.moves, noise, 1000 * seed + k)));
    let second = diagnosed(&recordings);
    println!("{:?} then {:?}", doubtful(&first), doubtful(&second));
    assert!(doubtful(&second).len() < doubtful(&first).len());
    assert!(doubtful(&second).contains(&truth[0].effect.name.to_string()));
    true
}

/// One quick move leaves in doubt whether friction creeps before it slides; the proposed ones settle it.
#[test]
fn val_the_proposed_moves_tell_laws_of_friction_apart() {
    let truth = term(
        "presliding_hysteresis",
        Place::Transmission,
        &[2e-4, 1e-4, 0.0, 0.0, 0.0],
    );
    let moves = [step(0.5, 1.0, 0.3)];
    let told = [2.2e-4, 2.5e-4].map(|noise| is_told_apart(&truth, &moves, noise, 1));
    assert!(told.contains(&true));
}

/// A lag of 2 ms and a delay differ by the square of it only.
#[test]
fn val_the_proposed_moves_tell_a_lag_from_a_delay() {
    let truth = term("sensor_lag", Place::Sensor, &[2e-3]);
    let moves = [step(0.5, 1.0, 3.0)];
    let told = [2e-5, 3e-5, 4e-5, 5e-5].map(|noise| is_told_apart(&truth, &moves, noise, 1));
    assert!(told.contains(&true));
}

/// A static error of the pose looks like a load that hangs: only another mounting tells.
#[test]
fn what_no_motion_separates_is_said() {
    let truth = term("gravity_load", Place::Link, &[1e-3, 0.3]);
    let diagnosis = diagnosed(&[recorded(&[truth], &[step(0.5, 1.0, 0.3)], 1e-4, 1)]);
    assert_eq!(diagnosis.verdict, Verdict::Ambiguous);
    let next = diagnosis.next_move.unwrap();
    println!("{}", next.why);
    assert!(next.moves.is_empty() && next.expected_score < 10.0);
    assert!(next.why.starts_with("No motion") && next.why.contains("mounting"));
}

/// A link that touched a stop once may have been hit by somebody. The same moves again tell.
#[test]
fn an_end_stop_that_was_touched_once_is_not_told_as_an_impact() {
    let moves = [step(0.5, 1.0, 0.6), step(-0.5, 0.5, 0.6)];
    for (position, noise) in [(0.5004, 5e-5), (0.5005, 3e-5), (0.50055, 5e-5)] {
        let stop = term("end_stop", Place::Link, &[10.0, position, 0.0, 0.0, 1.0]);
        let truth = std::slice::from_ref(&stop);
        let once = recorded(truth, &moves, noise, 1);
        let first = diagnosed(std::slice::from_ref(&once));
        println!("{position} {} {:?}", first.summary, first.next_move);
        assert!(doubtful(&first).contains(&"end_stop".to_string()));
        let second = diagnosed(&[once, recorded(truth, &moves, noise, 2)]);
        println!("{:?} then {:?}", doubtful(&first), doubtful(&second));
        assert_eq!(doubtful(&second), ["end_stop"]);
    }
}

/// Where nothing is in doubt, nothing is to be done.
#[test]
fn nothing_is_proposed_where_nothing_is_in_doubt() {
    let moves = [step(0.5, 1.0, 0.5), step(-0.5, 1.0, 0.5)];
    for truth in [
        vec![],
        vec![term("coulomb_friction", Place::Transmission, &[3e-4])],
    ] {
        let diagnosis = diagnosed(&[recorded(&truth, &moves, 1e-5, 1)]);
        assert!(matches!(
            diagnosis.verdict,
            Verdict::NoMismatch | Verdict::Named
        ));
        assert_eq!(diagnosis.next_move, None);
    }
}
