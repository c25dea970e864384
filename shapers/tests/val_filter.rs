//! The filter: exact ends, installation at rest, limits kept.

use quell_shapers::{GridTrain, Mode, Setpoint, Shaper, ShaperError, ShapingFilter, Zv, Zvd};

const TICK: f64 = 0.004;

fn train(hertz: f64) -> GridTrain {
    Zvd.on_grid(Mode::from_hertz(hertz, 0.084).unwrap(), TICK)
        .unwrap()
}

#[test]
fn val_a_step_comes_out_as_the_train_and_ends_on_the_target_to_the_bit() {
    let train = train(8.12);
    let mut filter = ShapingFilter::new(TICK, 64);
    filter.install(&train).unwrap();
    let target = 0.1 + 0.2; // not a round binary number
    let mut sum = 0.0;
    for k in 0..=train.duration_in_ticks() {
        let taps = train.taps().iter().filter(|tap| tap.delay as usize == k);
        sum += taps.map(|tap| tap.amplitude).sum::<f64>();
        let out = filter.step(Setpoint::at_rest(target));
        assert!((out.position - target * sum).abs() < 1e-15);
        assert_eq!(filter.is_settled(), k == train.duration_in_ticks());
    }
    assert_eq!(
        filter.step(Setpoint::at_rest(target)),
        Setpoint::at_rest(target)
    );
}

#[test]
fn val_a_train_waits_for_rest() {
    let (slow, fast) = (train(3.0), train(12.0));
    let mut filter = ShapingFilter::new(TICK, 128);
    filter.install(&fast).unwrap();
    filter.step(Setpoint::at_rest(1.0));
    filter.install(&slow).unwrap();
    assert_eq!(filter.pending(), Some(&slow));
    // The longer train must not reach back to before the step when it takes over.
    for _ in 0..slow.duration_in_ticks() {
        filter.step(Setpoint::at_rest(1.0));
        assert_eq!(filter.train(), &fast);
    }
    assert_eq!(filter.step(Setpoint::at_rest(1.0)).position, 1.0);
    assert_eq!(filter.train(), &slow);
}

#[test]
fn val_what_a_filter_refuses() {
    let mut filter = ShapingFilter::new(TICK, 8);
    let long = train(8.12);
    let ticks = long.duration_in_ticks();
    assert_eq!(
        filter.install(&long),
        Err(ShaperError::TooLong { ticks, capacity: 8 })
    );
    let other = Zv
        .on_grid(Mode::from_hertz(100.0, 0.0).unwrap(), 0.001)
        .unwrap();
    assert!(matches!(
        filter.install(&other),
        Err(ShaperError::SampleTimeMismatch { .. })
    ));
    let mut invalid = ShapingFilter::new(f64::NAN, 8);
    assert!(invalid.install(&other).is_err());
    assert_eq!(invalid.step(Setpoint::at_rest(2.0)).position, 2.0);
}
