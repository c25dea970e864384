//! The orders that change the train: at rest, and in motion by a copy of the filter.

use quell_shapers::{Refusal, RetuneOutcome};

use super::JointTick;
use crate::controller::Controller;
use crate::service::tick::messages::{Event, NotTaken, RetuneOrder, TrainOrder};
use crate::service::tick::taking::{adopt, put_in_force};

impl JointTick {
    /// Takes a train, once the joint rests.
    pub fn take_train(&mut self, order: Box<TrainOrder>) -> Event {
        let taken = match self.controller.as_deref_mut() {
            Some(controller) => put_in_force(&order.train, controller),
            None => Err(NotTaken::Idle),
        };
        Event::Train(order, taken)
    }

    /// Lends a copy of the filter for a retune of the running plan; `tick` is the next one. An order that has
    /// its copy waits for its tick.
    pub fn retune(&mut self, mut order: Box<RetuneOrder>, tick: u64) -> Option<Event> {
        if order.lent.is_some() {
            let replaced = self.retuning.replace(order)?;
            return Some(Event::Retuned(
                replaced,
                RetuneOutcome::Refused(Refusal::Busy),
            ));
        }
        let follows = self.follows(&order);
        let controller = self.controller.as_deref_mut().filter(|controller| {
            follows && controller.axis().status().retunes == order.train.retunes
        });
        (order.lent, order.tick) = (controller.and_then(Controller::lend), tick);
        Some(Event::Lent(order))
    }

    /// Whether the plan of a retune order is running, with a train that may change.
    fn follows(&self, order: &RetuneOrder) -> bool {
        self.adaptive && !self.frozen && self.runs && self.ticket == order.ticket
    }

    /// Retunes once the command has reached the end of the order's copy of the filter.
    pub fn take_retune(&mut self) -> Option<Event> {
        let controller = self.controller.as_deref_mut()?;
        let due = |order: &mut Box<RetuneOrder>| {
            let lent = order.lent.as_deref();
            lent.is_none_or(|lent| controller.due_in(lent) <= 0)
        };
        let mut order = self.retuning.take_if(due)?;
        let follows = self.follows(&order);
        let controller = self.controller.as_deref_mut()?;
        let outcome = match follows {
            true => adopt(&mut order, controller),
            false => {
                controller.give_back(&mut order.lent);
                RetuneOutcome::Refused(Refusal::Busy)
            }
        };
        Some(Event::Retuned(order, outcome))
    }
}
