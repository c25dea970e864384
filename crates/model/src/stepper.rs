//! Steps that end where the motion is not smooth: friction that stops to slide or to stick, a corner of a
//! force.
//!
//! Friction does not change its state within a step: it sticks or slides in one direction. If the velocity of a
//! sliding attachment changes its sign, the step ends there, and the attachment sticks. At the start of every
//! step sticking friction is released if it bears more than its limit. So no step gains energy, however many
//! events coincide.
//! Source: Karnopp, ASME J. Dynamic Systems, Measurement and Control 107 (1985), for the state
//! machine; Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, section II.6, for the
//! events.

mod events;

use super::attachment::{ATTACHMENTS, Attachment};
use super::chain::{Chain, Constants, Instant, State, coordinate, position};
use super::effects::{Change, Motion, Zone};
use super::piecewise::RADIANS_A_STEP;
use super::runge_kutta::{Span, Step, Trial, Whole, steps};
use super::trace::Trace;

/// Most events in one step; after these the step is taken as it is, since a contact chatters.
const MOST_EVENTS: usize = 16;

/// Relative velocity, as a share of the motor side's, that is only rounding.
const ROUNDING: f64 = 1e-9;

/// Share of a step by which the end of sticking is passed: a nanosecond in a millisecond.
const OVERSHOOT: f64 = 1e-6;

/// Radians in a step of the vibration on a stiff force: it lasts for less than a radian, so that the step may be longer than
/// that of a mode.
const BRISTLES: f64 = 2.0 * RADIANS_A_STEP;

/// A chain in motion.
pub(super) struct Stepper<'a> {
    pub chain: &'a mut Chain,
    constants: Constants,
    step: Step,
    whole: Whole,
    /// Whether no event can happen.
    smooth: bool,
    /// Whether there is only the linear chain.
    linear: bool,
    /// Whether the input is the whole motion, without any dynamics.
    given: bool,
    /// Corners of forces: index, sign of the switching function.
    corners: Vec<(usize, f64)>,
    /// Breakaway force of an attachment in either direction at the start of a step, in the equation's unit, where it has friction. An
    /// attachment that sticks stays at its position.
    breakaway: [Option<[f64; 2]>; 3],
    /// Whether that depends on the position.
    varies: bool,
    /// Dependence of an attachment's friction on the speed, if it is slow enough for the steps.
    falls: [Fall; 3],
    /// 0 sticks, otherwise the sign of the slip velocity.
    slides: [f64; 3],
}

/// Friction whose level depends on the speed.
#[derive(Default)]
struct Fall {
    /// Acceleration by the whole change of friction; 0 of one that does not change.
    drop: f64,
    /// Speeds at which it changes.
    zones: Vec<Zone>,
}

#[derive(Clone, Copy)]
enum Event {
    Stop(Attachment),
    Breakaway,
    Corner,
}

impl<'a> Stepper<'a> {
    /// The chain at its first instant: moving attachments slide, memories are initialised.
    pub fn new(chain: &'a mut Chain, span: &Span, state: &State, h: f64) -> Self {
        let (time, input) = span.at(0.0);
        let constants = Constants::new(&chain.linear);
        let (motion, _) = chain.motion(time, state, input);
        let mut corners = Vec::new();
        for index in 0..chain.forces.len() {
            let attachment = chain.attachment(chain.forces[index].place);
            let [x, v] = coordinate(attachment, &motion);
            let element = &mut chain.forces[index];
            (element.memory.time, element.memory.position) = (time, x);
            element.law.remember(&motion, x, v, &mut element.memory);
            if let Some(value) = element.law.switch(&motion, x, v, &element.memory) {
                corners.push((index, sign(value)));
            }
        }
        let falls = falls(chain, &constants, h);
        let breakaway = breakaway(chain, &motion);
        let mut laws = chain.frictions.iter().map(|element| &element.law);
        let varies = laws.any(|law| law.varies());
        let (step, whole) = steps(chain);
        Self {
            smooth: corners.is_empty() && chain.frictions.is_empty(),
            linear: chain.is_linear(),
            given: chain.linear.link_is_input,
            chain,
            constants,
            step,
            whole,
            corners,
            breakaway,
            varies,
            falls,
            slides: [0.0; 3],
        }
    }

    /// The quantities at the start of a span, after overloaded attachments have been released.
    #[inline]
    pub fn settle(&mut self, state: &State, span: &Span) -> Instant {
        let (time, input) = span.at(0.0);
        if self.linear {
            return self
                .chain
                .evaluate::<false>(&self.constants, time, state, input);
        }
        self.let_go(state, time, input)
    }

    fn let_go(&mut self, state: &State, time: f64, input: [f64; 3]) -> Instant {
        if self.chain.frictions.is_empty() {
            return self.evaluate(time, state, input);
        }
        let motion = self
            .chain
            .position::<true>(&self.constants, time, state, input)
            .motion;
        if self.varies {
            self.breakaway = breakaway(self.chain, &motion);
        }
        for attachment in self.rough() {
            let rate = coordinate(attachment, &motion)[1];
            if rate.abs() > ROUNDING * (motion.motor[1].abs() + motion.link[1].abs()) {
                self.slides[attachment as usize] = rate.signum();
            }
        }
        self.set_sliding();
        loop {
            let instant = self.evaluate(time, state, input);
            let Some(attachment) = self.overburdened(&instant.holding) else {
                return instant;
            };
            // Each pass releases one attachment, so that there are at most three.
            self.slides[attachment as usize] = instant.holding[attachment as usize].signum();
            self.set_sliding();
        }
    }

    /// Advances from the start of the span, with given accelerations, to `to`. Earlier ends of a step become
    /// nodes.
    #[inline]
    pub fn advance(
        &mut self,
        state: &mut State,
        span: Span,
        to: f64,
        start: Instant,
        trace: &mut Trace,
    ) {
        if self.given {
            // Nothing is integrated: forces update their memories, and friction gets the sign of the prescribed
            // motion.
            let from = span.from - span.t0;
            for turn in span.input.turns(from, to - span.t0) {
                // A memory that reverses with the motion must see the turning point.
                self.remember(state, span.t0 + turn, span.input.at(turn));
            }
            self.remember(state, to, span.at(to - span.from).1);
            return;
        }
        if self.smooth {
            let h = to - span.from;
            (self.whole)(self.chain, &self.constants, &span, state, &start, h);
            if !self.chain.forces.is_empty() {
                self.remember(state, to, span.at(h).1);
            }
            return;
        }
        self.advance_between_events(state, span, to, start, trace);
    }

    fn advance_between_events(
        &mut self,
        state: &mut State,
        mut span: Span,
        to: f64,
        mut start: Instant,
        trace: &mut Trace,
    ) {
        let (shortest, mut events) = ((to - span.from) / Change::FINEST, 0);
        while to > span.from {
            let longest = self.longest(&start, to - span.from);
            let h = self.on_bristles(&start, longest).max(shortest);
            let h = h.min(to - span.from);
            let trial = self.trial(state, &span, &start, h);
            let event = self.first_event(state, &start, &trial, &span);
            let h = match event {
                Some((event, share)) if events < MOST_EVENTS => {
                    events += 1;
                    if share > 0.0 {
                        *state = self.trial(state, &span, &start, share * h).end;
                    }
                    self.happen(event);
                    share * h
                }
                _ => {
                    if event.is_some() {
                        self.calm(&trial, &span);
                    }
                    *state = trial.end;
                    h
                }
            };
            let (input, then) = (span.at(h).1, span.from + h);
            span.from = if h == to - span.from {
                to
            } else {
                then.min(to)
            };
            self.accept(state, span.from, input, h);
            if span.from < to {
                start = self.settle(state, &span);
                trace.push(&start, &span);
            }
        }
    }

    /// The longest step for friction that depends on the speed.
    fn longest(&self, start: &Instant, h: f64) -> f64 {
        let mut longest = h;
        for attachment in self.rough() {
            let slides = self.slides[attachment as usize];
            if slides == 0.0 {
                continue;
            }
            let fall = &self.falls[attachment as usize];
            let rate = slides * coordinate(attachment, &start.motion)[1];
            let change = slides * slip(start, attachment);
            for zone in &fall.zones {
                longest = longest.min(zone.longest(rate, change, fall.drop, h));
            }
        }
        longest
    }

    /// The longest step on a force that may be far stiffer than the transmission, or depend on the speed.
    fn on_bristles(&self, start: &Instant, h: f64) -> f64 {
        let mut longest = h;
        for &(force, _) in &self.corners {
            let element = &self.chain.forces[force];
            let attachment = self.chain.attachment(element.place);
            let [_, v] = coordinate(attachment, &start.motion);
            let stiffness = element.law.stiffness(v, &element.memory);
            if stiffness > 0.0 {
                let mobility = self.constants.mobility(attachment);
                let square = self.chain.linear.unit_force * mobility * stiffness;
                longest = longest.min(BRISTLES / square.sqrt());
            }
            if let Some(zone) = element.law.zone() {
                let change = v.signum() * slip(start, attachment);
                longest = longest.min(zone.longest(v.abs(), change, 0.0, h));
            }
        }
        longest
    }

    fn evaluate(&self, time: f64, state: &State, input: [f64; 3]) -> Instant {
        self.chain
            .evaluate::<true>(&self.constants, time, state, input)
    }

    fn trial(&self, state: &State, span: &Span, start: &Instant, h: f64) -> Trial {
        (self.step)(self.chain, &self.constants, span, state, start, h)
    }

    /// Attachments with friction.
    fn rough(&self) -> impl Iterator<Item = Attachment> + use<> {
        let breakaway = self.breakaway;
        ATTACHMENTS
            .into_iter()
            .filter(move |&attachment| breakaway[attachment as usize].is_some())
    }

    /// The remaining capacity of a sticking attachment beyond its present force.
    fn spare(&self, attachment: Attachment, force: f64) -> f64 {
        let breakaway = self.breakaway[attachment as usize].unwrap_or_default();
        breakaway[usize::from(force < 0.0)] - force.abs()
    }

    /// The most overloaded sticking attachment.
    fn overburdened(&self, holding: &[f64; 3]) -> Option<Attachment> {
        let spare =
            |attachment: &Attachment| self.spare(*attachment, holding[*attachment as usize]);
        let attachments = self.rough().filter(|&attachment| self.holds(attachment));
        let lacking = attachments.filter(|attachment| spare(attachment) < 0.0);
        lacking.min_by(|a, b| spare(a).total_cmp(&spare(b)))
    }

    /// Whether an attachment sticks and something could make it slide.
    fn holds(&self, attachment: Attachment) -> bool {
        self.slides[attachment as usize] == 0.0 && self.yields(attachment)
    }

    /// Whether a sliding attachment can be stopped.
    fn yields(&self, attachment: Attachment) -> bool {
        self.constants.mobility(attachment) > 0.0
    }

    /// Sets the sliding states of the frictions.
    fn set_sliding(&mut self) {
        for index in 0..self.chain.frictions.len() {
            let attachment = self.chain.attachment(self.chain.frictions[index].place);
            self.chain.frictions[index].slides = self.slides[attachment as usize];
        }
    }

    /// The state at the end of a step of length `h`; sticking attachments stand still, memories are updated.
    fn accept(&mut self, state: &mut State, time: f64, input: [f64; 3], h: f64) {
        for attachment in self.rough() {
            if self.holds(attachment) {
                let motion = self
                    .chain
                    .position::<true>(&self.constants, time, state, input)
                    .motion;
                match attachment {
                    Attachment::Motor => {
                        state[1] = 0.0;
                        if let Some(pull) = &self.chain.pull {
                            state[0] = pull.forgotten(time, state[0], h);
                        }
                    }
                    Attachment::Across => state[3] = motion.motor[1],
                    Attachment::Link => state[3] = 0.0,
                }
            }
        }
        self.remember(state, time, input);
    }

    fn remember(&mut self, state: &State, time: f64, input: [f64; 3]) {
        if self.chain.forces.is_empty() {
            return;
        }
        let motion = self
            .chain
            .position::<true>(&self.constants, time, state, input)
            .motion;
        for index in 0..self.chain.forces.len() {
            let attachment = self.chain.attachment(self.chain.forces[index].place);
            let element = &mut self.chain.forces[index];
            let [x, v] = coordinate(attachment, &motion);
            element.law.remember(&motion, x, v, &mut element.memory);
        }
        for (force, side) in &mut self.corners {
            let element = &self.chain.forces[*force];
            let [x, v] = coordinate(self.chain.attachment(element.place), &motion);
            let value = element.law.switch(&motion, x, v, &element.memory);
            *side = value.map_or(*side, sign);
        }
    }
}

/// Breakaway force of each attachment that has friction, in either direction.
fn breakaway(chain: &Chain, motion: &Motion) -> [Option<[f64; 2]>; 3] {
    let mut found = [None; 3];
    for element in &chain.frictions {
        let attachment = chain.attachment(element.place);
        let own = element.law.breakaway_at(position(attachment, motion));
        let [up, down] = found[attachment as usize].unwrap_or([0.0; 2]);
        let unit = chain.linear.unit_force;
        found[attachment as usize] = Some([up + unit * own[0], down + unit * own[1]]);
    }
    found
}

/// Dependence of each attachment's friction on the speed. Stribeck velocities that are too small for steps of
/// length `h` become 0: the breakaway force then acts at rest only. So do transition velocities: the friction
/// then jumps, and sticks.
fn falls(chain: &mut Chain, constants: &Constants, h: f64) -> [Fall; 3] {
    let mut found = <[Fall; 3]>::default();
    for index in 0..chain.frictions.len() {
        let attachment = chain.attachment(chain.frictions[index].place);
        let law = &mut chain.frictions[index].law;
        let Change { force, zones } = law.change();
        let drop = chain.linear.unit_force * constants.mobility(attachment) * force;
        if drop <= 0.0 {
            continue;
        }
        let curve = law.levels.is_some();
        if !curve && zones[0].step < drop * h / Change::FINEST {
            if law.transition_velocity > 0.0 {
                (law.transition_velocity, law.breakaway) = (0.0, law.kinetic);
            }
            law.stribeck_velocity = 0.0;
            continue;
        }
        let own = &mut found[attachment as usize];
        own.drop += drop;
        own.zones.extend(zones);
    }
    found
}

/// Slip acceleration at an attachment.
fn slip(instant: &Instant, attachment: Attachment) -> f64 {
    match attachment {
        Attachment::Motor => instant.motor,
        Attachment::Across => instant.link - instant.motor,
        Attachment::Link => instant.link,
    }
}

/// The sign of a switching function; 0 at the corner.
fn sign(value: f64) -> f64 {
    match value {
        0.0 => 0.0,
        _ => value.signum(),
    }
}
