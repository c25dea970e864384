//! Axes that move together, and the recommended shaper.

use quell_shapers::{
    Criterion, GridTrain, Mode, Reason, Requirements, Setpoint, Shaper, ShaperError, ShapingFilter,
    Standing, UncertainMode, Zv, Zvd, common_train, recommend,
};

const TICK: f64 = 0.001;

/// Largest distance from the straight line `y = 2 x` of two axes that run two trains.
fn departure(trains: [&GridTrain; 2]) -> f64 {
    let mut axes = trains.map(|train| {
        let mut filter = ShapingFilter::new(TICK, 1000);
        filter.install(train).unwrap();
        filter
    });
    let smooth = |k: usize| {
        let x = (k as f64 / 400.0).min(1.0);
        x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    };
    (0..1200)
        .map(|k| {
            let [x, y] = [1.0, 2.0].map(|scale| Setpoint::at_rest(scale * smooth(k)));
            (2.0 * axes[0].step(x).position - axes[1].step(y).position).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn val_a_common_train_keeps_the_path() {
    let slow = Zvd
        .on_grid(Mode::from_hertz(5.0, 0.05).unwrap(), TICK)
        .unwrap();
    let fast = Zv
        .on_grid(Mode::from_hertz(12.0, 0.02).unwrap(), TICK)
        .unwrap();
    let own = departure([&slow, &fast]);
    let common = common_train(&[slow, fast]).unwrap();
    let strict = departure([&common, &common]);
    println!("off the path: own trains {own:.3}, common {strict:.1e}");
    assert!(strict < 1e-14, "{strict}");
    assert!(own > 0.1, "{own}");
}

fn wanted(longest_delay: f64) -> Requirements {
    Requirements {
        longest_delay,
        criterion: Criterion::Worst95,
        acceptable: 0.0,
        tolerance: 0.01,
        allow_negative: false,
    }
}

#[test]
fn val_recommendation_follows_uncertainty_and_delay() {
    let mode = Mode::from_hertz(8.12, 0.084).unwrap();
    let known = |relative: f64| UncertainMode {
        mode,
        natural_frequency_std: relative * mode.natural_frequency(),
        damping_ratio_std: 0.005,
    };
    let mut last = 0.0;
    for relative in [0.0, 0.002, 0.01, 0.02, 0.05, 0.1, 0.2] {
        let found = recommend(&[known(relative)], &wanted(f64::INFINITY)).unwrap();
        println!("{relative}: {:?} because {:?}", found.best, found.reason);
        // Shapers of the same nominal length differ by a few percent with damping.
        assert!(found.best.delay >= 0.97 * last, "less certain, yet shorter");
        last = found.best.delay;
    }
    // Less than a period allowed: ZV and MZV are left, whatever they leave.
    let found = recommend(&[known(0.05)], &wanted(0.8 / 8.12)).unwrap();
    assert_eq!(found.best.shaper.name(), "mzv");
    assert!(matches!(found.reason, Reason::LeavesLeast));
    let zvd = found
        .candidates
        .iter()
        .find(|c| c.shaper.name() == "zvd")
        .unwrap();
    assert_eq!(zvd.standing, Standing::TooLong);
    let none = recommend(&[known(0.05)], &wanted(0.01));
    assert!(matches!(none, Err(ShaperError::NoneFits { .. })));
}

/// ZV without damping leaves `|sin(pi e / 2)|` for a relative error `e` of standard deviation `s`:
/// the mean is `s sqrt(pi / 2)`, the 95 % quantile `1.95996 s pi / 2`.
#[test]
fn val_expected_residual_in_closed_form() {
    let mode = Mode::from_hertz(1.0, 0.0).unwrap();
    let s = 0.01;
    let estimate = UncertainMode {
        mode,
        natural_frequency_std: s * mode.natural_frequency(),
        damping_ratio_std: 0.0,
    };
    let found = recommend(&[estimate], &wanted(f64::INFINITY)).unwrap();
    let zv = found
        .candidates
        .iter()
        .find(|c| c.shaper.name() == "zv")
        .unwrap();
    let pi = std::f64::consts::PI;
    // The quadrature ends at 3 standard deviations and has steps of 0.1 of one.
    assert!(
        (zv.expected / (s * (pi / 2.0).sqrt()) - 1.0).abs() < 0.02,
        "{}",
        zv.expected
    );
    assert!(
        (zv.worst_95 / (1.95996 * s * pi / 2.0) - 1.0).abs() < 0.06,
        "{}",
        zv.worst_95
    );
}
