//! Registration and clocks against their statistical accuracy.

use std::f64::consts::{FRAC_PI_6, PI};

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use quell::estimators::Sample;
use quell::identification::{Prior, identify};
use quell::plant::{ArmSimulation, Command, Damping, MeasurementLog, Robot, SimulationOptions};
use quell::recording::{Recording, Role};
use quell::signal::{
    Clock, CubicSpline, End, IcpOptions, JointArc, Motion, RestRule, SignalError, TipRegistration,
    Window, fit_clock_offset, free_decays, icp, initial_guess, kabsch, noise_floor, phases,
    quantisation_step, recorded_deformation, spectrum,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

fn noisy(points: &[Point3<f64>], sigma: f64, random: &mut ChaCha8Rng) -> Vec<Point3<f64>> {
    let mut noise = || sigma * random.sample::<f64, _>(StandardNormal);
    points
        .iter()
        .map(|p| p + Vector3::new(noise(), noise(), noise()))
        .collect()
}

fn frame(values: [f64; 6]) -> Isometry3<f64> {
    let [x, y, z, roll, pitch, yaw] = values;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}

/// 30 degrees at 0, 60 degrees at 4 s and back to 10 degrees, by fifth-order steps of 0.6 s.
fn two_moves(t: f64) -> (f64, f64) {
    let step = |s: f64| {
        let s = (s / 0.6).clamp(0.0, 1.0);
        let x = s * s * s * (10.0 + s * (6.0 * s - 15.0));
        (x, 30.0 * (s * (1.0 - s)).powi(2) / 0.6)
    };
    let [(a, va), (b, vb)] = [step(t - 0.3), step(t - 2.0)];
    (FRAC_PI_6 * a - 0.35 * b, FRAC_PI_6 * va - 0.35 * vb)
}

fn recorded(robot: &Robot, options: &SimulationOptions, seconds: f64) -> Recording {
    let mut arm = ArmSimulation::new(robot, 0, options).unwrap();
    let mut log = MeasurementLog::new();
    let period = 1.0 / robot.control_rate;
    while arm.time() < seconds {
        let (position, velocity) = two_moves(arm.time() + period);
        log.step(
            &mut arm,
            Command {
                position,
                velocity: Some(velocity),
            },
            period,
        );
    }
    log.into_recording("two moves")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Frames over all rotations, points on an arc of 30 degrees, 10 um: error of the rotation within
    /// its own covariance (chi-squared of 3 degrees of freedom, 1e-10 beyond 50).
    #[test]
    fn kabsch_has_the_accuracy_that_it_states(
        values in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64, -3.1..3.1f64, -1.5..1.5f64, -3.1..3.1f64],
        seed in any::<u64>(),
    ) {
        let truth = frame(values);
        let arc = JointArc::from_lever_arm(1.8, 0.9).unwrap();
        let source: Vec<_> = (0..300).map(|k| arc.tip(FRAC_PI_6 * f64::from(k) / 299.0)).collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let exact: Vec<_> = source.iter().map(|p| truth * p).collect();
        let target = noisy(&exact, 1e-5, &mut random);
        let found = kabsch(&source, &target).unwrap();
        let error = (found.transform.rotation * truth.rotation.inverse()).scaled_axis();
        let inverse = found.rotation_covariance.try_inverse().unwrap();
        let chi = error.dot(&(inverse * error));
        prop_assert!(chi < 50.0, "chi^2 = {}", chi);
        // Residual of 900 coordinates, 6 fitted: 10 um sqrt(3) within seven standard deviations.
        prop_assert!((found.rms / (3f64.sqrt() * 1e-5) - 1.0).abs() < 7.0 / (2.0 * 894f64).sqrt());
        prop_assert!((found.transform.rotation.to_rotation_matrix().matrix().determinant() - 1.0).abs() < 1e-12);
        // Noise-free it is exact.
        let clean = kabsch(&source, &exact).unwrap();
        // Rounding of coordinates of some metres, and of the singular vectors.
        prop_assert!(clean.rms < 1e-12, "{} m", clean.rms);
    }

    /// Points on a line leave the rotation about it free, and the error names the line.
    #[test]
    fn points_on_a_line_are_refused(
        direction in [-1.0..1.0f64, -1.0..1.0f64, 0.1..1.0f64], sigma in 0.0..1e-4f64, seed in any::<u64>(),
    ) {
        let line = Vector3::from(direction).normalize();
        let source: Vec<_> = (0..100).map(|k| Point3::from(line * f64::from(k) * 0.01)).collect();
        let target = noisy(&source, sigma, &mut ChaCha8Rng::seed_from_u64(seed));
        let error = kabsch(&source, &target).unwrap_err();
        let SignalError::Degenerate { direction } = error else { panic!("{error}") };
        prop_assert!(Vector3::from(direction).cross(&line).norm() < 1e-9);
    }

    /// A path of several joints in space, correspondence unknown, a fifth of the points spurious.
    #[test]
    fn icp_finds_the_frame_without_correspondence(
        values in [-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64, -3.1..3.1f64, -1.5..1.5f64, -3.1..3.1f64],
        seed in any::<u64>(),
    ) {
        let robot = Robot::rx170();
        let path = |s: f64| robot.chain.tip(&[
            0.6 * s, 0.8 + 0.3 * (5.0 * s).sin(), 0.8 - 0.4 * s * s, 0.5 * s, 0.3, 0.0,
        ]);
        let target: Vec<_> = (0..=800).map(|k| path(f64::from(k) / 800.0)).collect();
        let truth = frame(values);
        let seen: Vec<_> =
            (0..=500).map(|k| truth.inverse() * path((f64::from(k) + 0.37) / 501.0)).collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut source = noisy(&seen, 1e-5, &mut random);
        for k in (0..source.len()).step_by(5) {
            source[k] += Vector3::new(0.02, -0.01, 0.03);
        }
        let start = initial_guess(&source, &target).unwrap();
        let options = IcpOptions { kept: 0.75, ..Default::default() };
        let found = icp(&source, &target, &start, options).unwrap();
        prop_assert!(found.converged);
        let worst = seen
            .iter()
            .zip(0..)
            .map(|(p, k)| {
                let truth = path((f64::from(k) + 0.37) / 501.0);
                (found.registration.transform * p - truth).norm()
            })
            .fold(0.0, f64::max);
        // 376 points of 10 um: 0.5 um a coordinate at the centroid, some times that at the ends and
        // along the path, where only its bends hold it.
        prop_assert!(worst < 1e-5, "{} um", worst * 1e6);
    }

    /// The spline reproduces a cubic, value and derivatives, on any knots.
    #[test]
    fn not_a_knot_spline_reproduces_cubics(
        c in [-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64],
        steps in prop::collection::vec(0.2..1.0f64, 5..30), at in 0.0..1.0f64,
    ) {
        let t: Vec<f64> = steps.iter().scan(0.0, |sum, s| { *sum += s; Some(*sum) }).collect();
        let cubic = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let x: Vec<f64> = t.iter().map(|&t| cubic(t)).collect();
        let spline = CubicSpline::new(&t, &x, End::NotAKnot).unwrap();
        let (first, last) = spline.span();
        let s = first + at * (last - first);
        let scale = 1.0 + x.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        prop_assert!((spline.value(s) - cubic(s)).abs() < 1e-10 * scale);
        let slope = c[1] + s * (2.0 * c[2] + 3.0 * c[3] * s);
        prop_assert!((spline.derivative(s) - slope).abs() < 1e-9 * scale);
    }
}

/// Whole chain on the simulated arm: unknown frame, clock offset of either sign, both damping
/// conventions. The clock comes out within its standard deviation, the deformation within noise.
#[test]
fn val_clock_frame_and_deformation_come_out_of_a_simulated_recording() {
    for (seed, (damping, offset)) in [
        (Damping::AcrossJoint, 0.0017),
        (Damping::AcrossJoint, -0.0012),
        (Damping::AcrossJoint, 0.1234),
        (Damping::ToGround, 0.0009),
        (Damping::ToGround, -0.0019),
    ]
    .into_iter()
    .enumerate()
    {
        let mut robot = Robot::rx170();
        robot.tracker.clock = Clock::with_offset(offset);
        let options = SimulationOptions {
            seed: seed as u64,
            damping: Some(damping),
            ..Default::default()
        };
        let recording = recorded(&robot, &options, 3.5);
        let arc = robot.arc(&robot.home(), 0).unwrap();
        let found =
            recorded_deformation(&recording, Some(&arc), None, TipRegistration::Arc).unwrap();
        let registration = found.registration.unwrap();
        let error = registration.clock.offset - offset;
        println!(
            "{damping:?} {offset}: {:.2} +- {:.2} us, tangential {:.2} um, {:?}",
            error * 1e6,
            registration.clock_offset_std * 1e6,
            registration.tangential_rms * 1e6,
            registration.mode.map(|m| (m.hertz(), m.damping_ratio())),
        );
        assert_eq!(registration.damper_to_ground, damping == Damping::ToGround);
        assert!(registration.clock_offset_std < 10e-6);
        assert!(
            error.abs() < 4.0 * registration.clock_offset_std,
            "{error} s"
        );
        let to_base = registration.sensor_to_base * robot.tracker.pose.inverse();
        let tip = arc.tip(0.2);
        // 1165 samples of 10 um on the plane and circle: some um where the arc's shortness magnifies.
        assert!(
            (to_base * tip - tip).norm() < 1e-5,
            "{}",
            (to_base * tip - tip).norm()
        );
        let mode = registration.mode.unwrap();
        assert!(
            (mode.hertz() / 8.12 - 1.0).abs() < 2e-3 && (mode.damping_ratio() - 0.084).abs() < 2e-3
        );
        let rest = found
            .samples
            .iter()
            .filter(|s| s.time < 0.25)
            .map(|s| s.tip_deformation);
        let n = rest.clone().count() as f64;
        let mean = rest.sum::<f64>() / n;
        assert!(
            mean.abs() < 4.0 * 1e-5 / n.sqrt() + 2e-6,
            "{mean} m at rest"
        );
    }
}

/// Both registrations of the simulated arm's single joint, whose frame is known: by plane and circle it is as good as
/// the noise. The paper's, by closest points, is off by what the vibration at the ends of the path pulls; along the
/// arc it says by how much. Frequency and damping do not suffer.
#[test]
fn val_both_registrations_find_the_known_frame_and_the_mode() {
    for seed in 0..3 {
        let mut robot = Robot::rx170();
        robot.tracker.clock = Clock::with_offset(0.0017);
        let options = SimulationOptions {
            seed,
            ..Default::default()
        };
        let recording = recorded(&robot, &options, 3.5);
        let arc = robot.arc(&robot.home(), 0).unwrap();
        let middle = arc.tip(0.25);
        let ahead = arc.tangent(0.25).normalize();
        let errors = TipRegistration::ALL.iter().map(|&way| {
            let recorded = recorded_deformation(&recording, Some(&arc), None, way).unwrap();
            let found = recorded.registration.unwrap();
            let shift = found.sensor_to_base * robot.tracker.pose.inverse() * middle - middle;
            let along = shift.dot(&ahead);
            let across = (shift - ahead * along).norm();
            let angle = along / arc.radius();
            println!(
                "{}: across {:.1} um, ahead {:.4} mrad, said {:.4} mrad, residual {:.2} um, clock {:.1} us off",
                way.name(),
                across * 1e6,
                angle * 1e3,
                found.angle_error * 1e3,
                found.normal_rms.hypot(found.radial_rms) * 1e6,
                (found.clock.offset - 0.0017) * 1e6,
            );
            let residual = found.normal_rms.hypot(found.radial_rms);
            // Two coordinates of 10 um, 1165 times; where the vibration reaches beyond the ends, the closest points
            // pull the whole path by some 1 / 25 of it, too.
            let (shifted, least, most) = match way {
                TipRegistration::Arc => (2e-6, 1.3e-5, 1.5e-5),
                TipRegistration::Icp => (2e-5, 1.3e-5, 2.5e-5),
            };
            assert!(across < shifted, "{across} m");
            assert!((least..most).contains(&residual), "{residual} m");
            assert!((found.angle_error - angle).abs() < 5e-6, "{angle} rad");
            assert!((found.clock.offset - 0.0017).abs() < 4.0 * found.clock_offset_std);
            let samples: Vec<_> = recorded
                .samples
                .iter()
                .map(|sample| Sample {
                    time: sample.time,
                    motor_position: sample.motor_position,
                    deformation: sample.deformation,
                })
                .collect();
            let found = identify(&samples, Prior::default()).unwrap();
            let mode = found.reference().batch().unwrap().mode;
            assert!((mode.hertz() / 8.12 - 1.0).abs() < 2e-3, "{mode:?}");
            assert!((mode.damping_ratio() - 0.084).abs() < 2e-3, "{mode:?}");
            angle.abs()
        });
        let errors: Vec<_> = errors.collect();
        // The vibration reaches 0.4 mm beyond the ends.
        assert!(errors[1] * arc.radius() < 4e-4, "{errors:?}");
        assert!(errors[0] < errors[1], "{errors:?}");
    }
}

#[test]
fn clock_offset_needs_a_move() {
    let time: Vec<f64> = (0..200).map(|k| 0.004 * f64::from(k)).collect();
    let still = CubicSpline::new(&time, &vec![0.3; 200], End::NotAKnot).unwrap();
    let error = fit_clock_offset(&still, &time, &vec![0.3; 200], None).unwrap_err();
    assert!(matches!(error, SignalError::NotExcited { .. }), "{error}");
    let backwards: Vec<f64> = time.iter().map(|t| -t).collect();
    let error = fit_clock_offset(&still, &backwards, &vec![0.3; 200], None).unwrap_err();
    assert!(
        matches!(error, SignalError::TimeOrder { index: 1, .. }),
        "{error}"
    );
}

#[test]
fn rest_begins_when_the_servo_has_arrived() {
    let robot = Robot::rx170();
    let recording = recorded(&robot, &SimulationOptions::default(), 3.5);
    let encoder = recording.channel(Role::MotorPosition).unwrap();
    let rule = RestRule::new(0.0, robot.encoder.resolution);
    let found = phases(&encoder.time, &encoder.columns[0], rule).unwrap();
    let kinds: Vec<Motion> = found.iter().map(|phase| phase.motion).collect();
    use Motion::{Moving, Rest};
    assert_eq!(kinds, [Rest, Moving, Rest, Moving, Rest], "{found:?}");
    let decays = free_decays(&encoder.time, &encoder.columns[0], rule, 0.3).unwrap();
    // The commands end at 0.9 and 2.6 s, where the speed has long been below 1 % of its peak; the
    // servo (30 Hz) follows within 20 ms and the window shows it.
    for (decay, end) in decays.iter().zip([0.9, 2.6]) {
        assert!((-0.06..0.05).contains(&(decay.start - end)), "{decay:?}");
    }
    // Traces of arithmetic in a position without noise are no motion.
    let traces: Vec<f64> = (0..3500)
        .map(|k| two_moves(1e-3 * f64::from(k)).0 + 1e-15 * f64::from(k % 7))
        .collect();
    let stamps: Vec<f64> = (0..3500).map(|k| 1e-3 * f64::from(k)).collect();
    let rule = RestRule::from_values(&traces).above(1e-6, &traces);
    let clean = phases(&stamps, &traces, rule).unwrap();
    assert!(clean.len() == 5 && clean[1].start > 0.3, "{clean:?}");
    // With the noise read off the record itself the same.
    let own = RestRule::from_values(&encoder.columns[0]);
    assert!(
        (own.quantisation / robot.encoder.resolution - 1.0).abs() < 0.01,
        "{own:?}"
    );
    assert_eq!(
        phases(&encoder.time, &encoder.columns[0], own)
            .unwrap()
            .len(),
        5
    );
}

#[test]
fn val_noise_floor_reads_noise_and_not_motion() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let values: Vec<f64> = (0..3000)
        .map(|k| {
            let motion = (0.003 * f64::from(k)).sin() + (51.0 * 0.003 * f64::from(k)).sin() * 1e-3;
            motion + 1e-5 * random.sample::<f64, _>(StandardNormal)
        })
        .collect();
    let noise = noise_floor(&values);
    // Median absolute deviation: 1.17 / sqrt(n) relative, more for the correlation of differences.
    // The 8 Hz motion of 1 mm adds (w h)^3 of itself over sqrt 20: 0.8 um.
    assert!(
        (noise.standard_deviation / 1e-5 - 1.0).abs() < 0.08,
        "{noise:?}"
    );
    assert_eq!(noise.quantisation, None);
    let rounded: Vec<f64> = values.iter().map(|x| (x / 1e-4).round() * 1e-4).collect();
    assert!((quantisation_step(&rounded).unwrap() / 1e-4 - 1.0).abs() < 1e-6);
}

#[test]
fn val_spectrum_of_a_damped_wave_peaks_at_its_frequency() {
    let (w, xi) = (2.0 * PI * 8.12, 0.02);
    let wave: Vec<f64> = (0..2000)
        .map(|k| 0.003 * f64::from(k))
        .map(|t| (-xi * w * t).exp() * (w * t).cos())
        .collect();
    let found = spectrum(&wave, 0.003, Window::Rectangular, 4).unwrap();
    let peak = found.peak(2.0 * PI * 4.0, 2.0 * PI * 16.0).unwrap();
    // The amplitude spectrum of a damped cosine peaks near w sqrt(1 - 2 xi^2); within 0.1 %.
    assert!(
        (peak.frequency / w - 1.0).abs() < 1e-3,
        "{}",
        peak.frequency / w
    );
    assert!(spectrum(&wave, 0.0, Window::Hann, 1).is_err());
    assert!(spectrum(&wave[..3], 0.003, Window::Hann, 1).is_err());
}
