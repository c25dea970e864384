//! Trains that the tick is to install at rest.

use super::Engine;
use super::planning::standing_train;
use crate::service::tick::{NotTaken, ToTick, TrainOrder};

impl Engine {
    /// Orders the train that should be in force, if it is another one.
    pub(super) fn order_train(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        let unshaped = joint.running.as_ref().is_some_and(|move_| !move_.shaped);
        let rings = unshaped || self.clock.now() < joint.rings_until;
        // A waiting order has a train for its own way.
        if !joint.train_due || rings || !joint.began || joint.asked.is_some() {
            return;
        }
        match standing_train(joint, joint.standing_shaper(), self.config.period) {
            Ok(train) => {
                let order = TrainOrder {
                    joint: index,
                    train,
                };
                joint.train_due = false;
                self.rings.orders.push(ToTick::Train(Box::new(order)));
            }
            Err(error) => {
                tracing::warn!(joint = joint.config.name, "{error}");
                joint.train_due = false;
            }
        }
    }

    /// Handles the tick's answer on a train.
    pub(super) fn train_answered(&mut self, order: &TrainOrder, answer: &Result<(), NotTaken>) {
        let joint = &mut self.joints[order.joint];
        match answer {
            Ok(()) => {
                let mode = order.train.known.mode;
                if joint.mode != mode {
                    joint.mode_since = self.clock.unix_time();
                }
                joint.mode = mode;
                joint.wanted_mode = joint.wanted_mode.filter(|wanted| *wanted != mode);
            }
            Err(NotTaken::Outdated) => joint.train_due = true,
            Err(why) => tracing::warn!(joint = joint.config.name, ?why, "a train was not taken"),
        }
    }
}
