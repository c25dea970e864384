//! Conditions for taking a plan or a train.

use quell_shapers::RetuneOutcome;

use super::messages::{NotTaken, Plan, RetuneOrder, Start, Train};
use crate::controller::Controller;

/// Whether a plan can begin; installs the train that it needs.
pub fn ready(plan: &Plan, controller: &mut Controller, tick: u64) -> Result<bool, NotTaken> {
    let train = match &plan.start {
        Start::Tick(start) if *start < tick => return Err(NotTaken::Late),
        Start::Tick(start) => return Ok(*start == tick),
        Start::Rest(train) => train,
    };
    if !controller.is_settled() {
        return Ok(false);
    }
    put_in_force(train, controller)?;
    // A longer train takes over once the command has stood still for its length.
    Ok(!controller.is_train_waiting())
}

/// Installs a train once the joint rests, unless it is the next one already.
pub fn put_in_force(train: &Train, controller: &mut Controller) -> Result<(), NotTaken> {
    if controller.axis().status().retunes != train.retunes {
        return Err(NotTaken::Outdated);
    }
    controller.hold(train.hold);
    let axis = controller.axis();
    if *axis.next_train() == train.train && axis.status().shaped_for == train.known {
        return Ok(());
    }
    let set = controller.set_train(train.shaper, &train.known, &train.train);
    set.map_err(NotTaken::Train)
}

/// Continues with the copy of the filter in which a train takes over. If the command has changed since, or the
/// train leaves no less, nothing changes.
pub fn adopt(order: &mut RetuneOrder, controller: &mut Controller) -> RetuneOutcome {
    let (train, modes) = (&order.train, &order.modes);
    let outcome = controller.adopt(&mut order.lent, &train.known, modes);
    if !matches!(outcome, RetuneOutcome::Refused(_)) {
        controller.hold(train.hold);
    }
    outcome
}
