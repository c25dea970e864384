//! The events that end a step early, and their times.

use super::super::chain::{Instant, State, coordinate};
use super::super::roots::{first_root, root_of_parabola};
use super::super::runge_kutta::{Span, Trial};
use super::{Event, OVERSHOOT, Stepper, sign, slip};
use crate::effects::Motion;

impl Stepper<'_> {
    /// The first event in the step, and its time as a share of the step.
    pub(super) fn first_event(
        &mut self,
        state: &State,
        start: &Instant,
        trial: &Trial,
        span: &Span,
    ) -> Option<(Event, f64)> {
        let mut first: Option<(Event, f64)> = None;
        let mut note = |event, share| {
            if first.is_none_or(|(_, earliest)| share < earliest) {
                first = Some((event, share));
            }
        };
        let end = self.motion_at(state, trial, span, 1.0);
        for attachment in self.rough() {
            if self.holds(attachment) {
                let spare =
                    |holding: &[f64; 3]| self.spare(attachment, holding[attachment as usize]);
                let [middle, last] = &trial.holding;
                let spare = [spare(&start.holding), spare(middle), spare(last)];
                if spare[1].min(spare[2]) < 0.0 {
                    // A little later, so that the limit is truly exceeded.
                    let share = root_of_parabola(spare) * (1.0 + OVERSHOOT) + OVERSHOOT;
                    note(Event::Breakaway, share.min(1.0));
                }
                continue;
            }
            let slides = self.slides[attachment as usize];
            let rate = |motion: &Motion| slides * coordinate(attachment, motion)[1];
            let within = |share: f64| rate(&self.motion_at(state, trial, span, share));
            let below = match rate(&end) < 0.0 {
                true => Some(1.0),
                // It may have stopped and started again.
                false => {
                    let half =
                        rate(&start.motion) + 0.5 * trial.h * slides * slip(start, attachment);
                    let quarters = [0.5, 0.25, 0.75].into_iter();
                    let mut below = quarters.filter(|&share| half < 0.0 && within(share) < 0.0);
                    below.next()
                }
            };
            if let Some(below) = below {
                note(
                    Event::Stop(attachment),
                    first_root(within, below).unwrap_or(0.0),
                );
            }
        }
        for index in 0..self.corners.len() {
            let (force, side) = self.corners[index];
            let element = &self.chain.forces[force];
            let attachment = self.chain.attachment(element.place);
            let switch = |motion: &Motion| {
                let [x, v] = coordinate(attachment, motion);
                let value = element.law.switch(motion, x, v, &element.memory);
                side * value.unwrap_or(side)
            };
            if switch(&end) < 0.0 {
                let switch = |share| switch(&self.motion_at(state, trial, span, share));
                match first_root(switch, 1.0) {
                    // On the far side, where the force has its other branch.
                    Some(share) => note(Event::Corner, (share + OVERSHOOT).min(1.0)),
                    // It was on the other side already at the start.
                    None => self.corners[index].1 = -side,
                }
            } else if side == 0.0 {
                let [x, v] = coordinate(attachment, &end);
                let value = element.law.switch(&end, x, v, &element.memory);
                self.corners[index].1 = value.map_or(0.0, sign);
            }
        }
        first
    }

    pub(super) fn motion_at(
        &self,
        state: &State,
        trial: &Trial,
        span: &Span,
        share: f64,
    ) -> Motion {
        let (time, input) = span.at(share * trial.h);
        let state = match share {
            1.0 => trial.end,
            _ => trial.within(state, share),
        };
        self.chain
            .position::<true>(&self.constants, time, &state, input)
            .motion
    }

    pub(super) fn happen(&mut self, event: Event) {
        match event {
            Event::Breakaway | Event::Corner => {}
            Event::Stop(attachment) if self.yields(attachment) => {
                self.slides[attachment as usize] = 0.0
            }
            Event::Stop(attachment) => self.slides[attachment as usize] *= -1.0,
        }
    }

    /// Ends chatter: if there are too many events in one step, attachments that would slide back stick.
    pub(super) fn calm(&mut self, trial: &Trial, span: &Span) {
        let end = self.motion_at(&trial.end, trial, span, 1.0);
        for attachment in self.rough() {
            let rate = coordinate(attachment, &end)[1];
            if self.slides[attachment as usize] * rate < 0.0 && self.yields(attachment) {
                self.slides[attachment as usize] = 0.0;
            }
        }
        for (force, side) in &mut self.corners {
            let element = &self.chain.forces[*force];
            let [x, v] = coordinate(self.chain.attachment(element.place), &end);
            let value = element.law.switch(&end, x, v, &element.memory);
            *side = value.map_or(*side, sign);
        }
    }
}
