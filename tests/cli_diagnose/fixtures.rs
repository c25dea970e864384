//! A diagnosis of each verdict, made by hand: a joint with dry friction under three moves.

use quell::diagnosis::{
    Candidate, CoordinateTrace, Diagnosis, Finding, Fit, FittedParameter, Location, NextMove,
    OutputTrace, ProposedMove, Quality, SpectrumTrace, Traces, Verdict,
};
use quell::recording::{Channel, Recording, Role};
use std::f64::consts::TAU;

const RATE: f64 = 333.0;
const DURATION: f64 = 13.0;
pub const NOISE: f64 = 6e-6;
const FREQUENCY: f64 = TAU * 8.12;
pub const FRICTION: f64 = 2.4e-4;

/// What a joint of one mode does under three moves.
#[derive(Default)]
struct Axis {
    time: Vec<f64>,
    deformation: Vec<f64>,
    rate: Vec<f64>,
    friction: Vec<f64>,
    motor: Vec<f64>,
}

/// Acceleration of the motor side: three moves, each a period of a sine.
fn acceleration(time: f64) -> f64 {
    let moves = [(1.0, 0.5, 1.0), (4.5, 0.35, -1.0), (8.5, 0.3, 0.7)];
    let of = |(start, length, size): (f64, f64, f64)| {
        let phase = (time - start) / length;
        match (0.0..1.0).contains(&phase) {
            true => 4.5 * size * (TAU * phase).sin(),
            false => 0.0,
        }
    };
    moves.into_iter().map(of).sum()
}

/// Small steps, so that Euler's rule errs by less than the noise: half a step's phase of 2 mrad.
const STEPS: u32 = 200;

fn axis(friction: f64, frequency: f64) -> Axis {
    let h = 1.0 / (RATE * f64::from(STEPS));
    let [mut x, mut v, mut u, mut speed] = [0.0_f64; 4];
    let mut holding = 0.0;
    let mut axis = Axis::default();
    for k in 0..(DURATION * RATE) as usize {
        let t = k as f64 / RATE;
        axis.time.push(t);
        axis.deformation.push(x);
        axis.rate.push(v);
        axis.motor.push(u);
        axis.friction.push(holding);
        for i in 0..STEPS {
            let input = acceleration(t + f64::from(i) * h);
            let force = x + 2.0 * 0.05 * v / frequency + input / frequency.powi(2);
            // It sticks until the force exceeds the friction, and stops where the rate changes sign.
            let sliding = if v == 0.0 { -force } else { v }.signum();
            holding = match v == 0.0 && force.abs() <= friction {
                true => force,
                false => -friction * sliding,
            };
            let next = v - h * frequency.powi(2) * (force - holding);
            v = if next * v < 0.0 { 0.0 } else { next };
            x += h * v;
            speed += h * input;
            u += h * speed;
        }
    }
    axis
}

/// Noise of unit deviation, the same at each run.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut uniform = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // The sum of twelve uniform numbers has the variance 1.
    (0..count)
        .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
        .collect()
}

/// What an encoder and a sensor at the link see of the joint with this friction, rad.
pub fn recording(name: &str, friction: f64) -> Recording {
    let axis = axis(friction, FREQUENCY);
    let noise = noise(axis.time.len());
    let deformation = axis
        .deformation
        .iter()
        .zip(noise)
        .map(|(x, noise)| x + NOISE * noise);
    let deformation = deformation.collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: axis.time.clone(),
        columns: vec![values],
    };
    let channels = vec![
        channel(Role::MotorPosition, axis.motor.clone()),
        channel(Role::Deformation, deformation),
    ];
    Recording {
        name: name.into(),
        payload: None,
        channels,
    }
}

fn amplitudes(values: &[f64], frequencies: &[f64]) -> Vec<f64> {
    let at = |frequency: &f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let angle = TAU * frequency * k as f64 / RATE;
            re += value * angle.cos();
            im += value * angle.sin();
        }
        2.0 * f64::hypot(re, im) / values.len() as f64
    };
    frequencies.iter().map(at).collect()
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn named_shares(shares: &[(&str, f64)]) -> Vec<(String, f64)> {
    shares
        .iter()
        .map(|(name, share)| (name.to_string(), *share))
        .collect()
}

/// The series behind a diagnosis whose second model has this friction.
pub fn traces(after: f64) -> Traces {
    let truth = axis(FRICTION, FREQUENCY);
    let noise = noise(truth.time.len());
    let recorded: Vec<_> = truth
        .deformation
        .iter()
        .zip(&noise)
        .map(|(x, noise)| x + NOISE * noise)
        .collect();
    let before = axis(0.0, 1.01 * FREQUENCY).deformation;
    let after = axis(after, FREQUENCY).deformation;
    let frequency: Vec<_> = (1..200)
        .map(|k| 0.5 * 1.03_f64.powi(k))
        .filter(|f| *f < 160.0)
        .collect();
    let rough = |k: usize| truth.friction[k] + 3e-5 * noise[(7 * k + 3) % noise.len()];
    let missing: Vec<_> = (0..truth.time.len()).map(rough).collect();
    Traces {
        spectrum: SpectrumTrace {
            before: amplitudes(&less(&recorded, &before), &frequency),
            after: amplitudes(&less(&recorded, &after), &frequency),
            frequency,
        },
        outputs: vec![OutputTrace {
            name: "joint 1 deformation".into(),
            unit: "rad".into(),
            time: truth.time.clone(),
            recorded,
            before,
            after,
            noise_std: NOISE,
            held_out: vec![[8.5, 13.0]],
        }],
        missing_time: truth.time,
        missing_std: vec![3e-5; missing.len()],
        coordinate: Some(CoordinateTrace {
            coordinate: "deformation rate".into(),
            coordinate_unit: "rad/s".into(),
            unit: "rad".into(),
            x: truth.rate,
            missing: missing.clone(),
            explained: named_shares(&[
                ("deformation rate", 0.86),
                ("velocity", 0.12),
                ("deformation", 0.09),
                ("acceleration", 0.08),
                ("position", 0.03),
                ("time", 0.02),
            ]),
        }),
        missing,
        missing_unit: "rad".into(),
        phases: named_shares(&[
            ("settling", 0.61),
            ("acceleration", 0.27),
            ("reversal", 0.06),
            ("cruise", 0.04),
            ("rest", 0.02),
        ]),
    }
}

fn quality(over_noise: f64) -> Quality {
    Quality {
        train_rms: 1.02 * over_noise * NOISE,
        held_out_rms: over_noise * NOISE,
        held_out_over_noise: over_noise,
    }
}

fn fit(before: f64, after: f64) -> Fit {
    Fit {
        noise_std: NOISE,
        unit: "rad".into(),
        before: quality(before),
        after: quality(after),
    }
}

fn coulomb(probability: f64, alternatives: &[&str]) -> Finding {
    Finding {
        effect: "coulomb_friction".into(),
        place: "transmission".into(),
        probability,
        parameters: vec![FittedParameter {
            name: "friction".into(),
            value: 2.413e-4,
            unit: "rad".into(),
            ci95: [2.361e-4, 2.468e-4],
        }],
        evidence: "The missing force keeps one size and changes sign with the deformation rate."
            .into(),
        alternatives: alternatives.iter().map(|name| name.to_string()).collect(),
    }
}

fn candidates(rows: &[(&str, &str, f64, f64)]) -> Vec<Candidate> {
    let of = |&(effect, place, delta_bic, held_out_ratio): &(&str, &str, f64, f64)| Candidate {
        effect: effect.into(),
        place: place.into(),
        delta_bic,
        held_out_ratio,
    };
    rows.iter().map(of).collect()
}

fn ranking() -> Vec<Candidate> {
    candidates(&[
        ("coulomb_friction", "transmission", -2841.0, 0.0302),
        ("stribeck_friction", "transmission", -2829.4, 0.0305),
        ("presliding_hysteresis", "transmission", -2796.0, 0.034),
        ("hysteretic_stiffness", "transmission", -1702.0, 0.31),
        ("backlash", "transmission", -811.0, 0.64),
        ("cubic_stiffness", "transmission", -377.0, 0.81),
        ("quadratic_damping", "transmission", -120.0, 0.93),
        ("second_mode", "link", -41.0, 1.02),
        ("sensor_lag", "sensor", -6.1, 0.999),
        ("viscous_drag", "link", 6.8, 1.0),
        ("sensor_gain", "sensor", 8.1, 1.0),
        ("clock_skew", "sensor", 8.3, 1.001),
    ])
}

fn location() -> Location {
    Location {
        place: Some("transmission".into()),
        phases: vec!["settling".into(), "acceleration".into()],
        times_s: vec![[1.0, 2.4], [4.5, 5.6], [8.5, 9.6]],
        coordinate: Some("deformation rate".into()),
        frequency_hz: Some(8.12),
    }
}

fn diagnosis(verdict: Verdict, summary: &str, findings: Vec<Finding>, fit: Fit) -> Diagnosis {
    let nuisances = [
        ("clock_offset_s", -1.32e-3),
        ("natural_frequency_hz", 8.124),
        ("damping_ratio", 0.0503),
    ];
    Diagnosis {
        verdict,
        summary: summary.into(),
        findings,
        location: location(),
        fit,
        nuisances: nuisances
            .map(|(name, value)| (name.to_string(), value))
            .into(),
        next_move: None,
        candidates: ranking(),
        remarks: vec!["4 of 4329 samples are missing; the stamps are used as they are.".into()],
    }
}

/// A diagnosis of this verdict, and the series behind it.
pub fn of(verdict: Verdict) -> (Diagnosis, Traces) {
    match verdict {
        Verdict::NoMismatch => nothing(),
        Verdict::Named => named(),
        Verdict::Ambiguous => ambiguous(),
        Verdict::PartlyExplained => partly(),
        Verdict::Unexplained => unexplained(),
        Verdict::NotExcited => untold(),
    }
}

/// A rest: what is drawn is noise.
fn untold() -> (Diagnosis, Traces) {
    let (mut one, series) = nothing();
    one.verdict = Verdict::NotExcited;
    one.summary =
        "The recording does not excite the model. Record a move of at least 6e-4 rad.".into();
    one.candidates.clear();
    (one, series)
}

fn nothing() -> (Diagnosis, Traces) {
    let summary = "Nothing is missing: with its frequency corrected to 8.12 Hz the model explains the \
                   recording down to the noise.";
    let mut one = diagnosis(Verdict::NoMismatch, summary, Vec::new(), fit(1.01, 1.01));
    one.location = Location::default();
    one.candidates = candidates(&[
        ("clock_skew", "sensor", -4.2, 0.9991),
        ("viscous_drag", "link", 3.8, 1.0),
    ]);
    let mut series = traces(FRICTION);
    let output = &mut series.outputs[0];
    output.before = output.after.clone();
    let spectrum = series.spectrum;
    series.spectrum = SpectrumTrace {
        before: spectrum.after.clone(),
        ..spectrum
    };
    series.coordinate = None;
    (one, series)
}

fn named() -> (Diagnosis, Traces) {
    let summary = "Coulomb friction of 0.241 mrad in the transmission is missing from the model: with \
                   it the error on moves not fitted to falls from 5.84 to 1.02 times the noise.";
    let one = diagnosis(
        Verdict::Named,
        summary,
        vec![coulomb(0.991, &[])],
        fit(5.84, 1.02),
    );
    (one, traces(FRICTION))
}

fn ambiguous() -> (Diagnosis, Traces) {
    let summary = "Dry friction in the transmission is missing; whether it is Coulomb or Stribeck friction \
                   these moves cannot tell, a slow move would.";
    let findings = vec![coulomb(0.62, &["stribeck_friction"])];
    let mut one = diagnosis(Verdict::Ambiguous, summary, findings, fit(5.84, 1.02));
    one.next_move = Some(NextMove {
        why: "Stribeck friction differs from Coulomb friction at low speed: make a slow move."
            .into(),
        separates: ["coulomb_friction".into(), "stribeck_friction".into()],
        expected_score: 64.2,
        moves: vec![ProposedMove {
            distance: 0.0873,
            speed: 0.0175,
            acceleration: 0.52,
            jerk: 12.0,
            pause_s: 1.5,
            unit: "rad".into(),
        }],
    });
    (one, traces(FRICTION))
}

fn partly() -> (Diagnosis, Traces) {
    let summary = "Coulomb friction in the transmission explains most of the error, from 5.84 to 1.72 times \
                   the noise, but something besides it is missing.";
    let findings = vec![coulomb(0.93, &[])];
    let one = diagnosis(Verdict::PartlyExplained, summary, findings, fit(5.84, 1.72));
    (one, traces(0.8 * FRICTION))
}

fn unexplained() -> (Diagnosis, Traces) {
    let summary = "Something in the transmission that the catalogue does not know is missing: it acts while the \
                   joint settles, at 8.1 Hz, and leaves 5.84 times the noise.";
    let mut one = diagnosis(Verdict::Unexplained, summary, Vec::new(), fit(5.84, 5.84));
    one.candidates.drain(..3);
    one.next_move = Some(NextMove {
        why: "Repeat the second move at half its acceleration: whether the misfit halves with it says \
              whether what is missing is linear."
            .into(),
        separates: ["backlash".into(), "cubic_stiffness".into()],
        expected_score: 22.0,
        moves: Vec::new(),
    });
    let mut series = traces(FRICTION);
    let output = &mut series.outputs[0];
    output.after = output.before.clone();
    (one, series)
}
