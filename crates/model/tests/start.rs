//! The start of a link on a prescribed motor side that rests.

use proptest::prelude::*;
use quell_model::effects::{Effect, Place};
use quell_model::{Departure, Experiment, Model, StartComponent, Term, Trace, simulate};
use quell_recording::{Channel, Recording, Role};

/// Rounding step of the encoder, rad.
const STEP: f64 = 1e-5;

/// A motor side at rest whose encoder may alternate between two steps, and its link.
fn experiment(model: &Model, position: f64, alternates: bool) -> Experiment {
    let time: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.001).collect();
    let side = |k: u32| f64::from(u8::from(alternates && k * k % 3 == 1));
    let motor = (0..600).map(|k| position + STEP * side(k)).collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        columns: vec![values],
        time: time.clone(),
    };
    let channels = vec![
        channel(Role::MotorPosition, motor),
        channel(Role::LinkPosition, vec![position; time.len()]),
    ];
    let recording = Recording {
        name: "joint".into(),
        payload: None,
        channels,
    };
    Experiment::of(model, recording).unwrap()
}

fn joint() -> Model {
    let text = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8\ndamping_ratio = 0.05\n";
    Model::from_toml(text, "model.toml").unwrap()
}

fn term(name: &str, place: Place, values: &[f64]) -> Term {
    Term::new(Effect::from_name(name).unwrap(), place, values.to_vec())
}

fn run(model: &Model, terms: &[Term], experiment: &Experiment, deformation: f64) -> Trace {
    let mut start = Departure::default();
    start[StartComponent::Deformation] = deformation;
    let simulated = simulate(model.kind, &model.keys(), terms, experiment, &start);
    simulated.trace.as_ref().clone()
}

fn moved(trace: &Trace) -> f64 {
    let first = trace.link[0][0];
    let way = trace.link.iter().map(|link| (link[0] - first).abs());
    way.fold(0.0, f64::max)
}

/// A link that friction holds: forces as deformations of the linear spring.
#[derive(Clone, Debug)]
struct Stuck {
    position: f64,
    friction: f64,
    deformation: f64,
    gap: f64,
    k3: f64,
    phase: f64,
    /// Force that friction bears, as a share of what it can.
    share: f64,
}

impl Stuck {
    fn spring(&self) -> f64 {
        let x = self.deformation;
        let beyond = (x.abs() - 0.5 * self.gap).max(0.0) * x.signum();
        beyond + self.k3 * x.powi(3)
    }

    /// The weight that leaves the friction its share.
    fn terms(&self, place: Place) -> Vec<Term> {
        let link = self.position + self.deformation;
        let weight = (self.share * self.friction - self.spring()) / (link + self.phase).cos();
        vec![
            term("coulomb_friction", place, &[self.friction]),
            term("gravity_load", Place::Link, &[weight, self.phase]),
            term("backlash", Place::Transmission, &[self.gap, 0.0]),
            term("cubic_stiffness", Place::Transmission, &[self.k3]),
        ]
    }
}

fn stuck() -> impl Strategy<Value = Stuck> {
    let small = prop_oneof![Just(0.0), 1e-4..2e-3];
    let cubic = prop_oneof![Just(0.0), 0.0..2e4];
    let any = (-0.5..0.5, 1e-4..2e-3, -5e-3..5e-3, small, cubic, -0.5..0.5);
    (any, -0.98..0.98).prop_map(|(any, share)| {
        let (position, friction, deformation, gap, k3, phase) = any;
        Stuck {
            position,
            friction,
            deformation,
            gap,
            k3,
            phase,
            share,
        }
    })
}

proptest! {
    /// Anywhere in the band of friction the link stays where it is, to the bit; so it does in the middle.
    #[test]
    fn a_link_that_friction_holds_does_not_move(own in stuck(), across: bool) {
        let (model, place) = (joint(), if across { Place::Transmission } else { Place::Link });
        let (experiment, terms) = (experiment(&model, own.position, false), own.terms(place));
        let middle = run(&model, &terms, &experiment, 0.0);
        prop_assert_eq!(moved(&middle), 0.0);
        let start = middle.link[0][0] - own.position;
        let held = run(&model, &terms, &experiment, own.deformation - start);
        prop_assert!((held.link[0][0] - own.position - own.deformation).abs() < 1e-12);
        prop_assert_eq!(moved(&held), 0.0);
    }

    /// Beyond the band it slides.
    #[test]
    fn a_link_beyond_the_band_moves(own in stuck(), across: bool, up: bool) {
        let (model, place) = (joint(), if across { Place::Transmission } else { Place::Link });
        let own = Stuck { share: if up { 1.05 } else { -1.05 }, ..own };
        let (experiment, terms) = (experiment(&model, own.position, false), own.terms(place));
        let start = run(&model, &terms, &experiment, 0.0).link[0][0] - own.position;
        prop_assert!(moved(&run(&model, &terms, &experiment, own.deformation - start)) > 0.0);
    }

    /// An encoder that alternates between two steps does not move a link that friction to ground holds.
    #[test]
    fn the_rounding_of_an_encoder_at_rest_moves_nothing(own in stuck()) {
        let own = Stuck { share: 0.5 * own.share, friction: own.friction.max(20.0 * STEP), ..own };
        let model = joint();
        let (experiment, terms) = (experiment(&model, own.position, true), own.terms(Place::Link));
        let start = run(&model, &terms, &experiment, 0.0).link[0][0] - own.position;
        let held = run(&model, &terms, &experiment, own.deformation - start);
        prop_assert_eq!(moved(&held), 0.0);
    }
}

/// Without friction, on a gap, the weight lies on the flank where the force of the spring is the weight.
#[test]
fn a_weight_lies_on_its_flank() {
    let model = joint();
    let experiment = experiment(&model, 0.2, false);
    for weight in [-4e-3, -1e-5, 3e-4, 6e-3] {
        let terms = [
            term("backlash", Place::Transmission, &[1e-3, 0.0]),
            term("force_offset", Place::Link, &[weight]),
        ];
        let trace = run(&model, &terms, &experiment, 0.0);
        let expected = 0.2 - weight - 0.5e-3 * weight.signum();
        assert!((trace.link[0][0] - expected).abs() < 1e-15, "{weight}");
        assert!(moved(&trace) < 1e-12, "{weight}: {}", moved(&trace));
    }
}

/// A link that goes with its motor side does so from the start, however slow: where nothing jitters any motion is
/// seen, and motion through the steps of an encoder, too.
#[test]
fn a_link_in_motion_goes_on() {
    let model = joint();
    let rest = experiment(&model, 0.0, false);
    let start = |speed: f64, step: f64| {
        let encoder = |t: &f64| match step > 0.0 {
            true => (speed * t / step).round() * step,
            false => speed * t,
        };
        let moving = rest.with_input(rest.input_time.iter().map(encoder).collect());
        let terms = [term("coulomb_friction", Place::Link, &[1e-3])];
        run(&model, &terms, &moving, 0.0).link[0][1]
    };
    for speed in [1e-6, 1e-3, 0.5] {
        assert!((start(speed, 0.0) / speed - 1.0).abs() < 1e-6, "{speed}");
    }
    assert!(start(0.1, STEP) > 0.01);
}

/// The rounding of an encoder at rest is no motion, with friction or without.
#[test]
fn a_link_does_not_start_with_the_rate_of_rounding() {
    let model = joint();
    let own = experiment(&model, 0.3, true);
    assert_eq!(run(&model, &[], &own, 0.0).link[0][1], 0.0);
}
