//! Reads the rings: events, records, reports.

use std::sync::Arc;

use super::{BATCH, Engine};
use crate::service::contract::{Batch, Measured, MoveEnd, Quantity};
use crate::service::ringing::rings_for;
use crate::service::state::LearnedMode;
use crate::service::tick::{Event, JointReport, Record};

impl Engine {
    /// Empties the rings and acts on their content.
    pub(super) fn pump(&mut self) {
        let now = self.clock.now();
        self.hear_all();
        self.rings.orders.hand_on();
        self.hear_learners();
        self.wait_no_longer(now);
        self.hear_of_recordings();
        let mut round = false;
        while let Ok(report) = self.rings.joints.pop() {
            self.believe(report);
        }
        while let Ok(whole) = self.rings.whole.pop() {
            self.counts(whole.tick, whole.time);
            self.whole = Some(whole);
            round = true;
        }
        for index in 0..self.joints.len() {
            self.look_after(index, now);
            self.insist_on_stop(index);
            self.look_along(index, now);
        }
        if round {
            (0..self.joints.len()).for_each(|index| self.order_train(index));
            self.publish();
        }
        self.follow_feed();
        self.end_holds(now);
        self.retry(now);
        if now - self.batch_since >= BATCH {
            self.flush(now);
        }
    }

    /// Handles all messages of the tick.
    pub(super) fn hear_all(&mut self) {
        // Records first: those of a move belong to it before it ends.
        while let Ok(record) = self.rings.records.pop() {
            self.record(record);
        }
        while let Ok(event) = self.rings.events.pop() {
            self.hear(event);
        }
    }

    fn record(&mut self, record: Record) {
        match record {
            Record::Tick(row, next) => {
                self.counts(next, row.time);
                if let Some(running) = &mut self.joints[row.joint].running {
                    running.take(&row);
                }
                self.batch.ticks.push(row);
            }
            Record::Heard(index, id, sample) => {
                let running = self.joints[index].running.as_mut();
                if let Some(running) = running.filter(|running| running.start.id == id) {
                    running.hear(sample);
                }
            }
            Record::Measured(measured) => {
                self.measure(&measured);
                self.batch.measured.push(measured);
            }
        }
    }

    fn measure(&mut self, measured: &Measured) {
        let joint = &mut self.joints[measured.joint];
        if measured.refused {
            return;
        }
        if let Some(registrar) = &mut joint.registrar {
            registrar.take(measured);
        }
        if measured.quantity != Quantity::MotorPosition {
            return;
        }
        joint.motor = Some(measured.value[0]);
        if !joint.began {
            joint.standstill.take(measured.received, measured.value[0]);
        }
    }

    fn hear(&mut self, event: Event) {
        match event {
            Event::Taken(taken) => self.taken(&taken),
            Event::NotTaken(plan, why) => self.not_taken(&plan, why),
            Event::Settled(index, id, time) => self.settled(index, id, time),
            Event::Tripped(trip) => self.tripped(trip),
            Event::Left(index) => self.left(index),
            Event::Lost(index) => self.lost(index),
            Event::Back(index, position) => self.back(index, position),
            Event::Train(order, answer) => self.train_answered(&order, &answer),
            Event::Lent(order) => self.foresee(order),
            Event::Retuned(order, outcome) => self.retuned(&order, &outcome),
            // Dropped here, off the tick.
            Event::Controller(_) | Event::Sensor(_) => {}
        }
    }

    fn settled(&mut self, index: usize, id: u64, time: f64) {
        let joint = &mut self.joints[index];
        if let Some(running) = joint.running.as_mut().filter(|move_| move_.start.id == id) {
            running.settled = Some(time);
        }
    }

    fn believe(&mut self, report: JointReport) {
        let index = report.joint;
        let joint = &mut self.joints[index];
        if let Some(axis) = &report.axis {
            joint.commanded = Some([axis.planned, axis.sent]);
            if let Some(running) = joint.running.as_mut() {
                running.frozen |= axis.frozen;
            }
            let status = &axis.status;
            if status.retunes > joint.retunes {
                joint.mode = status.shaped_for.mode;
                joint.mode_since = self.clock.unix_time();
                let more = u64::from(status.retunes - joint.retunes);
                let payload = self.payload.unwrap_or(0.0);
                let state = self
                    .state
                    .joints
                    .entry(joint.config.name.clone())
                    .or_default();
                state.retunes += more;
                state.learn(LearnedMode {
                    payload_kg: payload,
                    mode: joint.mode.into(),
                    unix_time_s: joint.mode_since,
                });
                tracing::info!(
                    joint = joint.config.name,
                    hertz = joint.mode.hertz(),
                    damping_ratio = joint.mode.damping_ratio(),
                    "learned"
                );
                joint.retunes = status.retunes;
                joint.report = Some(report);
                self.save();
                return;
            }
            joint.retunes = status.retunes;
        }
        joint.report = Some(report);
    }

    /// Ends moves that have rung out, begins joints that stand still, stops joints without measurements.
    fn look_after(&mut self, index: usize, now: f64) {
        self.end_registration(index);
        let joint = &self.joints[index];
        let mode = joint.mode;
        if joint
            .running
            .as_ref()
            .is_some_and(|running| running.has_rung_out(now, mode))
        {
            self.finish(index);
        }
        let joint = &mut self.joints[index];
        if !joint.began {
            if let Some(position) = joint.standstill.position() {
                joint.standstill.restart();
                self.begin(index, position);
            }
            return;
        }
        self.look_again(index, now);
        self.let_go_of_displaced(index, now);
    }

    /// Ends a move and publishes its result, once.
    pub(super) fn finish(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        let estimate = joint.axis().and_then(|axis| axis.status.estimate);
        let own = super::joint::name_of(joint.standing_shaper());
        let Some(running) = joint.running.as_mut() else {
            return;
        };
        running.interrupt(MoveEnd::Replaced);
        let settled = running.settled.is_some();
        // A shaper for one move ends with the move.
        joint.train_due |= running.start.shaper != own;
        let (mode, sure) = match estimate.filter(|estimate| estimate.converged) {
            Some(estimate) => (estimate.mode, true),
            None => (joint.mode, false),
        };
        if let Some(since) = running.settled.filter(|_| !running.shaped) {
            joint.rings_until = since + rings_for(mode);
        }
        let radius = joint.sensor.arc().map(|arc| arc.radius());
        let result = running.result(mode, sure, self.config.period, radius);
        // Rows after that are a command at rest, not the move.
        let ended = joint.running.take_if(|_| settled);
        if !self.is_judged(result.id) {
            match ended {
                Some(running) => self.have_judged(index, running, result),
                None => self.tell(result),
            }
        }
        self.begin_registration(index);
    }

    /// Sends the batch.
    pub(super) fn flush(&mut self, now: f64) {
        (self.batch_since, self.batch.time) = (now, now);
        let next = Batch {
            number: self.batch.number + 1,
            ticks: Vec::with_capacity(self.batch.ticks.len()),
            measured: Vec::with_capacity(self.batch.measured.len()),
            ..Batch::default()
        };
        let batch = std::mem::replace(&mut self.batch, next);
        // There may be no reader.
        let _ = self.ends.stream.send(Arc::new(batch));
    }
}
