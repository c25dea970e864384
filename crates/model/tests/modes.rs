//! The further mode of a chain against the exact transfer function of two bodies whose dampers are in no proportion
//! to the springs.

mod shown;

use nalgebra::{Complex, Matrix4, Vector4};
use quell_model::chain::Chain;
use quell_model::effects::{Effect, Place, Resonance};
use quell_model::{Experiment, FurtherModes, Kind, Model, Term, Trace};
use quell_recording::{Channel, Recording, Role};
use shown::shown;
use std::f64::consts::TAU;

/// Inertia, stiffness, damping of the first and the second body: 8 Hz and 0.05 of the first alone.
const FIRST: [f64; 3] = [2.0, 5053.24, 10.053];
const SECOND: [f64; 3] = [0.416, 2878.0, 1.018];

/// The link's deformation for a unit acceleration of the motor side, at `s`.
fn exact(s: Complex<f64>) -> Complex<f64> {
    let [[m, k, c], [m2, k2, c2]] = [FIRST, SECOND];
    let (joint, own) = (s * c + k, s * c2 + k2);
    let tail = s * s * m2 + own;
    // The second body on its spring carries the inertia `m2 own / tail`.
    let inertia = own / tail * m2 + m;
    -inertia / (s * s * inertia + joint)
}

/// The poles with a positive imaginary part, the lower one first.
fn poles() -> [Complex<f64>; 2] {
    let [[m, k, c], [m2, k2, c2]] = [FIRST, SECOND];
    #[rustfmt::skip]
    let system = Matrix4::new(
        0.0, 1.0, 0.0, 0.0,
        -(k + k2) / m, -(c + c2) / m, k2 / m, c2 / m,
        0.0, 0.0, 0.0, 1.0,
        k2 / m2, c2 / m2, -k2 / m2, -c2 / m2,
    );
    let all = system.complex_eigenvalues();
    let mut upper: Vec<_> = all.iter().copied().filter(|p| p.im > 0.0).collect();
    upper.sort_by(|a, b| a.im.total_cmp(&b.im));
    [upper[0], upper[1]]
}

/// Frequency (rad/s) and damping ratio of a pole.
fn mode(pole: Complex<f64>) -> [f64; 2] {
    [pole.norm(), -pole.re / pole.norm()]
}

/// Deformation of the first mode and of the further one, from the accelerations of the chain at unit states.
fn of_chain(damping_coupling: f64, s: Complex<f64>) -> [Complex<f64>; 2] {
    let ([w, xi], [natural_frequency, damping_ratio]) = (mode(poles()[0]), mode(poles()[1]));
    let joint = Kind::from_name("flexible_joint").unwrap();
    let chain = Chain::new((joint.linear)(&[w / TAU, xi], Role::MotorPosition));
    let law = Resonance {
        natural_frequency,
        damping_ratio,
        share: 1.0,
        damping_coupling,
    };
    let modes = FurtherModes {
        laws: vec![law],
        ..FurtherModes::default()
    };
    // State: position and velocity of the first mode, then of the further one.
    let accelerations = |k: usize| {
        let mut unit = [0.0; 4];
        unit[k] = 1.0;
        let [y, v, x, rate] = unit;
        let link = chain.instant(0.0, &[0.0, 0.0, y, v], [0.0; 3]).link;
        let standing = Trace {
            time: vec![0.0, 1.0],
            motor: vec![[0.0; 3]; 2],
            link: vec![[y, v, 0.0], [y + v, v, 0.0]],
            ..Trace::default()
        };
        let still = [[0.0; 2]; 2];
        let seen = modes.seen(&standing, 0..=1, (&still, 1), &mut [[x, rate]]);
        [link, seen.curve[0][1]]
    };
    let mut system = Matrix4::zeros();
    (system[(0, 1)], system[(2, 3)]) = (1.0, 1.0);
    for k in 0..4 {
        [system[(1, k)], system[(3, k)]] = accelerations(k);
    }
    let unknown = Matrix4::from_diagonal_element(s) - system.map(Complex::from);
    let driven = Vector4::new(0.0, -1.0, 0.0, -1.0).map(Complex::from);
    let found = unknown.lu().solve(&driven).unwrap();
    [found[0], found[2]]
}

/// The largest error of the first mode, `1 - share` of it, and a share of the further one, relative to the latter.
fn error(share: f64, coupling: f64) -> f64 {
    let frequencies = (20..250).map(|k| Complex::new(0.0, TAU * 0.1 * f64::from(k)));
    let each = frequencies.map(|s| {
        let [first, further] = of_chain(coupling, s);
        let told = first * (1.0 - share) + further * share;
        (told - exact(s)).norm()
    });
    let top = Complex::new(0.0, poles()[1].norm());
    each.fold(0.0, f64::max) / (of_chain(0.0, top)[1] * share).norm()
}

/// A coupling `g` turns the residue of the further mode by `2 g w_2^2 / (w_2^2 - w_1^2)` in quadrature.
#[test]
fn val_dampers_in_no_proportion_couple_the_modes() {
    let [first, second] = poles();
    // Residue of the second pole: share and quadrature.
    let near = Complex::new(1e-6, 0.0);
    let residue = exact(second + near) * near;
    let (w1, w2) = (first.norm(), second.norm());
    let share = 2.0 * (residue * second.conj()).re;
    let turned = -2.0 * residue.re * w2 / share;
    let coupling = turned * (w2 * w2 - w1 * w1) / (2.0 * w2 * w2);
    println!("share {share} turned by {turned}: coupling {coupling}");
    let (without, with) = (error(share, 0.0), error(share, coupling));
    println!("largest error: {without} of the further mode without coupling, {with} with it");
    assert!(without > 0.15 && with < 0.1 * without, "{without} {with}");
}

/// A joint, a move of it, and what its sensor shows with some modes.
fn shown_with(modes: &[(f64, f64)]) -> Vec<f64> {
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let time: Vec<f64> = (0..800).map(|k| 0.004 * f64::from(k)).collect();
    let values = |f: fn(f64) -> f64| vec![time.iter().map(|&t| f(t)).collect::<Vec<f64>>()];
    let channel = |role, columns| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns,
    };
    let recording = Recording {
        name: "move".into(),
        payload: None,
        channels: vec![
            channel(
                Role::MotorPosition,
                values(|t| 0.3 * (2.0 * t).sin().powi(3)),
            ),
            channel(Role::LinkPosition, values(|t| 0.1 * t)),
        ],
    };
    let experiment = Experiment::new(&model, &recording).unwrap();
    let effect = Effect::from_name("second_mode").unwrap();
    let mode = |&(share, hz): &(f64, f64)| {
        Term::new(effect, Place::Link, vec![share, hz * TAU, 0.03, 0.0])
    };
    let terms: Vec<Term> = modes.iter().map(mode).collect();
    shown(&model, &terms, &experiment)
}

/// Modes do not act on each other: the change that any number of them makes is the sum of the changes that each makes.
#[test]
fn any_number_of_modes_add_up() {
    let modes = [(0.1, 3.0), (-0.05, 21.0), (0.02, 95.0)];
    let (bare, all) = (shown_with(&[]), shown_with(&modes));
    let each = modes.map(|mode| shown_with(&[mode]));
    for k in 0..bare.len() {
        let sum: f64 = each.iter().map(|own| own[k] - bare[k]).sum();
        assert!(
            (all[k] - bare[k] - sum).abs() < 1e-12,
            "{k}: {} {sum}",
            all[k] - bare[k]
        );
    }
}

/// A mode far above the samples moves as the motor side does, however fast it is.
#[test]
fn a_mode_that_is_too_fast_rests_on_its_motor_side() {
    let fast = [1e4, 1e6, 1e12].map(|hz| shown_with(&[(1.0, hz)]));
    for (k, own) in fast[0].iter().enumerate() {
        let u = 0.3 * (2.0 * 0.004 * k as f64).sin().powi(3);
        assert!((own - u).abs() < 1e-6, "{k}: {own} {u}");
        assert!(
            (fast[1][k] - u).abs() < 1e-6 && (fast[2][k] - u).abs() < 1e-6,
            "{k}"
        );
    }
}
