//! The guard of the sensors: what is stuck, saturated, jumps, or is no number is refused, and only that.

use quell::service::contract::{Measured, Quantity};
use quell::service::guard::{Bounds, CommandedMotion, Fault, Guard};
use quell_trajectories::Limits;

const BOUNDS: Bounds = Bounds {
    limits: Limits {
        velocity: 2.0,
        acceleration: 20.0,
        jerk: 200.0,
    },
    radius: 1.0,
    deformation: 0.05,
    resolution: 1e-5,
};
const MOVING: CommandedMotion = CommandedMotion {
    velocity: 1.0,
    jerk: 100.0,
    step: 0.0,
};
const STILL: CommandedMotion = CommandedMotion {
    velocity: 0.0,
    jerk: 0.0,
    step: 0.0,
};

struct Bench {
    guard: Guard,
    stamp: f64,
}

impl Bench {
    fn new() -> Self {
        let (guard, stamp) = (Guard::new(BOUNDS), 100.0);
        Self { guard, stamp }
    }

    /// Whether the next sample, a millisecond after the last, is admitted.
    fn says(&mut self, quantity: Quantity, value: f64, motion: CommandedMotion) -> bool {
        self.stamp += 0.001;
        let measured = Measured {
            received: self.stamp,
            stamp: self.stamp,
            joint: 0,
            quantity,
            value: [value, 0.0, 0.0],
            refused: false,
        };
        self.guard.admits(&measured, motion)
    }

    fn refused(&self, fault: Fault) -> u64 {
        let sensors = self.guard.report().sensors();
        sensors.map(|(_, s)| s.refused[fault as usize]).sum()
    }
}

#[test]
fn a_sensor_that_repeats_itself_in_motion_is_stuck_and_at_rest_is_not() {
    let mut bench = Bench::new();
    let taken = (0..1000).filter(|_| bench.says(Quantity::LinkPosition, 0.1, STILL));
    assert_eq!(taken.count(), 1000);
    let taken = (0..1000).filter(|_| bench.says(Quantity::LinkPosition, 0.1, MOVING));
    // 32 equal readings in succession are what chance does not make.
    assert_eq!(taken.count(), 31);
    assert_eq!(bench.refused(Fault::Stuck), 969);
    assert!(bench.guard.report().is_at_fault());
    // It is believed again after half a second of good readings.
    let good = |k: i32| 0.1 + 1e-3 * f64::from(k);
    let taken = (0..1000).filter(|k| bench.says(Quantity::LinkPosition, good(*k), MOVING));
    assert!((499..=501).contains(&taken.count()));
    assert!(!bench.guard.report().is_at_fault());
}

#[test]
fn the_end_of_the_scale_a_jump_and_no_number_are_refused() {
    for (quantity, good, bad, fault) in [
        (Quantity::Deformation, 0.01, 0.05, Fault::Saturated),
        (Quantity::Deformation, 0.01, -0.2, Fault::Saturated),
        // 4 times 2 rad/s over 1 ms is 8 mrad.
        (Quantity::MotorPosition, 0.5, 0.5085, Fault::Jump),
        (Quantity::LinkPosition, 0.5, 0.0, Fault::Jump),
        (Quantity::TipPosition, 0.5, 0.5085, Fault::Jump),
    ] {
        let mut bench = Bench::new();
        assert!(bench.says(quantity, good, STILL));
        assert!(!bench.says(quantity, bad, STILL), "{quantity:?} {bad}");
        assert_eq!(bench.refused(fault), 1, "{quantity:?} {bad}");
        assert!(!bench.says(quantity, good, STILL), "not believed at once");
        let taken = (0..1200).filter(|_| bench.says(quantity, good, STILL));
        assert!((690..=703).contains(&taken.count()), "{quantity:?} {bad}");
    }
    // No number is a sample that is missing: the next one is believed.
    for (quantity, bad) in [
        (Quantity::LinkPosition, f64::NAN),
        (Quantity::MotorPosition, f64::NEG_INFINITY),
        (Quantity::TipPosition, f64::INFINITY),
    ] {
        let mut bench = Bench::new();
        assert!(bench.says(quantity, 0.5, STILL));
        assert!(!bench.says(quantity, bad, STILL), "{quantity:?} {bad}");
        let report = bench.guard.report();
        assert_eq!(report.fault_of(quantity), Some(Fault::NotFinite));
        assert!(!report.is_at_fault());
        assert!(bench.says(quantity, 0.5, STILL));
        assert_eq!(bench.guard.report().fault_of(quantity), None);
        assert_eq!(bench.refused(Fault::NotFinite), 1);
        // It does not excuse a sensor at fault.
        assert!(!bench.says(quantity, 9.0, STILL));
        assert!(!bench.says(quantity, bad, STILL));
        assert_eq!(bench.guard.report().fault_of(quantity), Some(Fault::Jump));
        assert!(!bench.says(quantity, 9.0, STILL));
    }
    let mut bench = Bench::new();
    let stepped = CommandedMotion {
        step: 0.03,
        ..MOVING
    };
    assert!(bench.says(Quantity::MotorPosition, 0.5, MOVING));
    assert!(bench.says(Quantity::MotorPosition, 0.53, stepped));
    assert!(!bench.says(Quantity::MotorPosition, 0.57, stepped));
    let mut bench = Bench::new();
    let motion = |k: i32| 0.5 + 7.9e-3 * f64::from(k);
    assert!((0..100).all(|k| bench.says(Quantity::MotorPosition, motion(k), MOVING)));
}

/// A clock that goes back is no jump of the joint, and a fault ends by the service's clock.
#[test]
fn a_sensor_whose_clock_starts_anew_is_believed() {
    let says = |guard: &mut Guard, received: f64, stamp: f64, value: f64| {
        let measured = Measured {
            received,
            stamp,
            joint: 0,
            quantity: Quantity::MotorPosition,
            value: [value, 0.0, 0.0],
            refused: false,
        };
        guard.admits(&measured, MOVING)
    };
    let mut guard = Guard::new(BOUNDS);
    assert!(says(&mut guard, 10.0, 5000.0, 0.5));
    assert!(says(&mut guard, 10.01, 3.0, 0.51));
    // 4 times 2 rad/s over 10 ms is 80 mrad.
    assert!(!says(&mut guard, 10.02, 2.0, 0.6));
    let back = (1..600).map(|k| 1e-3 * f64::from(k));
    let taken = back.filter(|t| says(&mut guard, 10.02 + t, 1.0 + t, 0.6 + 0.1 * t));
    assert!((99..=101).contains(&taken.count()));
}
