//! The on-line aligner: any arrival order, any clock, no allocation.

use proptest::prelude::*;
use quell::signal::{Aligner, Clock, Measurement};

fn motor(time: f64) -> Measurement {
    Measurement::MotorPosition {
        time,
        position: cubic(time),
    }
}

fn cubic(t: f64) -> f64 {
    0.3 + t * (1.1 + t * (-2.0 + 5.0 * t))
}

proptest! {
    /// A cubic is reproduced at the sensor's instants whatever its clock and however late either
    /// stream arrives, in the order of the stamps, each measurement once.
    #[test]
    fn cubics_are_exact_in_any_order_of_arrival(
        offset in -0.01..0.01f64, ppm in -200.0..200.0f64, delay in 0usize..20, phase in 0.0..0.003f64,
    ) {
        let clock = Clock { offset, skew: ppm * 1e-6 };
        let mut aligner = Aligner::new(clock);
        let mut aligned = Vec::new();
        for k in 0..150 + delay {
            // Events of a 4 ms encoder and a 3 ms sensor, the latter `delay` of its periods late.
            if k < 150 {
                aligner.observe(motor(0.004 * k as f64));
            }
            if let Some(late) = k.checked_sub(delay) {
                let stamp = clock.stamp(phase + 0.003 * late as f64);
                aligner.observe(Measurement::Deformation { time: stamp, deformation: late as f64 });
            }
            while let Some(sample) = aligner.next_aligned() {
                aligned.push(sample);
            }
        }
        // 150 sensor samples reach to 0.45 s, the encoder to 0.6 s.
        prop_assert_eq!(aligned.len(), 150);
        prop_assert_eq!(aligner.dropped(), 0);
        for (k, sample) in aligned.iter().enumerate() {
            prop_assert!((sample.time - (phase + 0.003 * k as f64)).abs() < 1e-12);
            // The first instants have fewer than four samples around them.
            if sample.time > 0.008 {
                prop_assert!((sample.motor_position - cubic(sample.time)).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn what_cannot_be_aligned_is_dropped_counted_and_harmless() {
    let mut aligner = Aligner::new(Clock::REFERENCE);
    let link = |time| Measurement::LinkPosition {
        time,
        position: 1.0,
    };
    let counted = allocation_counter::measure(|| {
        // 200 wait for an encoder that has not begun: the oldest 136 make room.
        for k in 0..200 {
            aligner.observe(link(0.003 * f64::from(k)));
        }
        assert_eq!(aligner.next_aligned(), None);
        assert_eq!(aligner.dropped(), 136);
        for time in [0.0, f64::NAN, -1.0, 0.0, 0.004, 0.008, f64::INFINITY] {
            aligner.observe(motor(time));
        }
        aligner.observe(link(f64::NAN));
        // The oldest that wait begin at 0.408 s: nothing brackets them yet.
        assert_eq!(aligner.next_aligned(), None);
        for k in 3..300 {
            aligner.observe(motor(0.004 * f64::from(k)));
        }
        // The history reaches back 64 samples from 1.196 s: all that waited is too old by now.
        assert_eq!(aligner.next_aligned(), None);
        assert_eq!(aligner.dropped(), 200);
    });
    assert_eq!(counted.count_total, 0);
}
