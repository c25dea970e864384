//! When a plan or a train is taken, and why not.

use quell_shapers::{Refusal, RetuneOutcome};

use super::messages::{NotTaken, Plan, RetuneOrder, Start, Train};
use crate::controller::Controller;

/// Whether a plan's time has come; installs the train that it needs.
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

/// Has a train take over once the joint rests, unless it is the next one already.
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

/// Has a train take over in motion; where it is out of date or leaves no less, nothing changes.
pub fn retune(order: &RetuneOrder, controller: &mut Controller) -> RetuneOutcome {
    let RetuneOrder { train, modes, .. } = order;
    if controller.axis().status().retunes != train.retunes {
        return RetuneOutcome::Refused(Refusal::NotWorth(0.0));
    }
    let outcome = controller.retune(&train.train, &train.known, modes);
    if !matches!(outcome, RetuneOutcome::Refused(_)) {
        controller.hold(train.hold);
    }
    outcome
}
