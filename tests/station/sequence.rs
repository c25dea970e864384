//! How many stamps of a sensor are lost: counted exactly, whatever comes late, twice, or in a burst.

use proptest::prelude::*;
use quell::service::link::{Order, Sequence};

const GAP: f64 = 0.001;

fn lost(order: Order) -> u64 {
    match order {
        Order::Next { lost } => lost,
        _ => 0,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// One in five is lost, one in ten comes up to twenty later, one in ten twice; clocks jitter. Once the
    /// sensor says more for a while. No more than twelve of forty are lost: the usual gap is a median over 64, of which
    /// a burst takes up to 31, and by chance most of the rest may be gaps with losses.
    #[test]
    fn what_is_lost_is_counted_and_nothing_else(
        fates in prop::collection::vec((0..100u32, 1..20usize, -0.05..0.05f64), 1500..2500),
        burst in (300..1300usize, 0..31usize, 0.001..0.3f64),
        start in 0.0..1e6f64,
    ) {
        let mut sequence = Sequence::default();
        let (mut counted, mut dropped, mut late) = (0, Vec::new(), Vec::<(usize, f64)>::new());
        let last = fates.len();
        for (k, &(fate, by, jitter)) in fates.iter().enumerate() {
            let stamp = start + GAP * (k as f64 + jitter);
            // The ends are whole: what is missing behind the newest is not known yet.
            // A burst behind one that is missing may be what was missing.
            let whole = k < 2 || k + 200 > last || (k <= burst.0 && k + 3 > burst.0);
            let recent = dropped.iter().filter(|at| **at + 40 > k).count();
            match fate {
                0..20 if !whole && recent < 12 => dropped.push(k),
                20..30 if !whole => late.push((k + by, stamp)),
                _ => counted += lost(sequence.take(stamp)),
            }
            if (30..40).contains(&fate) {
                prop_assert_eq!(sequence.take(stamp), Order::Doubled);
            }
            let (at, count, share) = burst;
            if at == k {
                for more in 1..=count {
                    let within = GAP * share * more as f64 / count as f64;
                    counted += lost(sequence.take(stamp + within));
                }
            }
            for (_, stamp) in late.extract_if(.., |(at, _)| *at <= k) {
                counted += lost(sequence.take(stamp));
            }
        }
        prop_assert_eq!(counted, dropped.len() as u64);
    }

    /// A sensor that pauses and then says at once what it held back has lost nothing, nor has one whose
    /// rate changes.
    #[test]
    fn a_pause_that_is_made_up_for_and_another_rate_are_no_loss(
        held in 2..60usize,
        rate in 0.05..20.0f64,
    ) {
        let (mut sequence, mut counted, mut stamp) = (Sequence::default(), 0, 50.0);
        let mut say = |gap: f64, count: usize| {
            for _ in 0..count {
                stamp += gap;
                counted += lost(sequence.take(stamp));
            }
        };
        say(GAP, 300);
        // It pauses, and the last of what it held back comes when it would have.
        say(GAP * (held as f64 - 0.01 * (held - 1) as f64), 1);
        say(0.01 * GAP, held - 1);
        say(GAP, 300);
        say(GAP * rate, 300);
        prop_assert_eq!(counted, 0);
    }
}
