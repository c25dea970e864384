//! Sensors that fail while an arm moves and learns: never much more vibration than without shaping,
//! never a limit exceeded, never a target missed.

mod campaign;
mod fault;
mod joint;
mod rig;

use campaign::{campaign, table};

/// Most that a move may leave, over the unshaped one: what is asked of the campaign, whose 600 programmes come to
/// 1.21 once.
const MOST: f64 = 1.2;

/// A few programmes of each fault, with every shaper, estimator and sensor among them; as many more as
/// `cargo bench --bench faults` is asked for.
#[test]
fn no_fault_of_a_sensor_makes_the_robot_shake() {
    let outcomes = campaign(0, 3);
    println!("{}", table(&outcomes));
    for outcome in &outcomes {
        assert!(outcome.is_kept(), "{}: {outcome:?}", outcome.case);
        assert!(outcome.worst() <= MOST, "{}: {outcome:?}", outcome.case);
    }
}
