//! Sensors that fail while an arm moves and learns: never much more vibration than without shaping,
//! never a limit exceeded, never a target missed.

mod campaign;
mod fault;
mod rig;

use campaign::{campaign, table};

/// A few programmes of each fault, with every shaper, estimator and sensor among them; as many more as
/// `cargo bench --bench faults` is asked for.
#[test]
fn no_fault_of_a_sensor_makes_the_robot_shake() {
    let outcomes = campaign(0, 3);
    println!("{}", table(&outcomes));
    for outcome in &outcomes {
        assert!(outcome.is_kept(), "{}: {outcome:?}", outcome.case);
        assert!(outcome.worst() <= 1.2, "{}: {outcome:?}", outcome.case);
    }
}
