//! The filter: exact ends, installation at rest, limits kept.

use quell_shapers::{
    AdaptiveFilter, Buffers, Entry, GridTrain, Mode, Setpoint, Shaper, ShaperError, ShapingFilter,
    Tap, Zv, Zvd,
};

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

#[test]
fn val_lent_buffers_make_the_same_filters() {
    let (mut line, mut history) = ([Setpoint::at_rest(9.0); 130], [Entry::default(); 128]);
    let (mut planned, mut future) = ([line[0]; 128], [line[0]; 128]);
    let buffers = Buffers {
        line: &mut line[..],
        history: &mut history[..],
        planned: &mut planned[..],
        future: &mut future[..],
    };
    let mut lent = AdaptiveFilter::in_buffers(TICK, buffers).unwrap();
    let mut simple = ShapingFilter::new(TICK, 64);
    let (mut owned, train) = (AdaptiveFilter::new(TICK, 64, 128), train(8.12));
    assert_eq!((lent.capacity(), lent.horizon()), (64, 128));
    lent.install(&train).unwrap();
    simple.install(&train).unwrap();
    owned.install(&train).unwrap();
    for k in 0..200 {
        let input = Setpoint::at_rest(f64::from(k.min(100)) * 0.03);
        let out = owned.step(input);
        assert_eq!((lent.step(input), simple.step(input)), (out, out));
    }
}

#[test]
fn val_a_train_is_read_back_to_the_bit_or_refused() {
    let train = train(8.12);
    assert_eq!(GridTrain::from_taps(train.taps(), TICK), Ok(train.clone()));
    let mut taps = train.taps().to_vec();
    taps[1].amplitude += 1e-12;
    let refused = |taps: &[Tap]| GridTrain::from_taps(taps, TICK).unwrap_err();
    assert!(matches!(refused(&taps), ShaperError::Sum(_)));
    taps[1].amplitude = f64::NAN;
    assert!(matches!(refused(&taps), ShaperError::Sum(_)));
    taps.swap(0, 1);
    assert!(matches!(refused(&taps), ShaperError::OutOfRange { .. }));
    assert_eq!(refused(&[]), ShaperError::Empty);
    assert!(matches!(
        refused(&vec![taps[0]; 300]),
        ShaperError::OutOfRange { .. }
    ));
}
