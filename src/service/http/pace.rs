//! Timeouts of a connection: the event that it waits for, and the deadline.
//!
//! A client that holds a connection without using it takes it from others. So every wait has its own timeout,
//! on every address, loopback included.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::time::Instant;

/// Time for the head of a request, from its first byte on, or from the start of the connection. 16 KiB take
/// less on any connection that can show the page.
const HEAD: Duration = Duration::from_secs(1);
/// Time for which an idle connection is kept after an answer: browsers and scripts that ask every few seconds
/// need not reconnect.
const IDLE: Duration = Duration::from_secs(15);
/// Time in which a client must read some of its answer: that of a reader of the stream.
const STALL: Duration = Duration::from_secs(10);
/// Age at which a connection ends after its present answer.
const LIFE: Duration = Duration::from_secs(600);

/// The event that a connection waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Waits {
    /// For the first byte of the connection.
    Byte,
    /// For the head of a request.
    Head,
    /// For the service: the handler bounds the time of the body and of its own work.
    Answer,
    /// For the next request; parts of the last answer may still be in transit.
    Request,
}

/// Why a connection must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overdue {
    /// No byte arrived: browsers connect before they ask, and use another connection if this one closes
    /// silently.
    Silent,
    /// The head of a request was incomplete: no answer has been sent.
    Head,
    /// No further request arrived.
    Idle,
    /// The client does not read its answer.
    Stalled,
    /// It has reached its greatest age.
    Old,
}

/// The pace of one connection.
#[derive(Debug)]
pub struct Pace(Mutex<State>);

#[derive(Clone, Copy, Debug)]
struct State {
    opened: Instant,
    waits: Waits,
    since: Instant,
    /// Time since which the client reads nothing, if something waits to be sent.
    blocked: Option<Instant>,
}

impl Pace {
    /// The pace of a new connection.
    pub fn new(now: Instant) -> Self {
        Self(Mutex::new(State {
            opened: now,
            waits: Waits::Byte,
            since: now,
            blocked: None,
        }))
    }

    /// Notes received bytes.
    pub fn heard(&self, now: Instant) {
        let mut state = self.state();
        match state.waits {
            // Its timeout began with the connection.
            Waits::Byte => state.waits = Waits::Head,
            Waits::Request => (state.waits, state.since) = (Waits::Head, now),
            Waits::Head | Waits::Answer => {}
        }
    }

    /// Notes a complete head of a request.
    pub fn asked(&self, now: Instant) {
        let mut state = self.state();
        (state.waits, state.since) = (Waits::Answer, now);
    }

    /// Notes the answer of the service.
    pub fn answered(&self, now: Instant) {
        let mut state = self.state();
        (state.waits, state.since) = (Waits::Request, now);
    }

    /// Notes bytes that the client has read.
    pub fn took(&self, now: Instant) {
        let mut state = self.state();
        state.blocked = None;
        if state.waits == Waits::Request {
            state.since = now;
        }
    }

    /// Notes that the client reads no bytes now.
    pub fn blocked(&self, now: Instant) {
        self.state().blocked.get_or_insert(now);
    }

    /// The deadline of the connection if nothing happens, and the reason.
    pub fn deadline(&self) -> (Instant, Overdue) {
        let state = *self.state();
        let own = match (state.blocked, state.waits) {
            (Some(since), _) => Some((since + STALL, Overdue::Stalled)),
            (None, Waits::Byte) => Some((state.since + HEAD, Overdue::Silent)),
            (None, Waits::Head) => Some((state.since + HEAD, Overdue::Head)),
            (None, Waits::Request) => Some((state.since + IDLE, Overdue::Idle)),
            (None, Waits::Answer) => None,
        };
        let last = (state.opened + LIFE, Overdue::Old);
        own.map_or(last, |own| if own.0 <= last.0 { own } else { last })
    }

    /// A panic cannot leave the state inconsistent: each change is an assignment of plain data.
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_has_a_second_and_what_dribbles_gains_nothing() {
        let begin = Instant::now();
        let at = |ms: u64| begin + Duration::from_millis(ms);
        let pace = Pace::new(begin);
        assert_eq!(pace.deadline(), (at(1000), Overdue::Silent));
        pace.heard(at(300));
        pace.heard(at(900));
        assert_eq!(pace.deadline(), (at(1000), Overdue::Head));
        pace.asked(at(950));
        assert_eq!(pace.deadline(), (begin + LIFE, Overdue::Old));
        pace.answered(at(2000));
        assert_eq!(pace.deadline(), (at(2000) + IDLE, Overdue::Idle));
        // The next head has its second from its first byte on.
        pace.heard(at(9000));
        pace.heard(at(9900));
        assert_eq!(pace.deadline(), (at(10_000), Overdue::Head));
    }

    #[test]
    fn an_answer_must_be_taken_and_may_take_long() {
        let begin = Instant::now();
        let at = |s: u64| begin + Duration::from_secs(s);
        let pace = Pace::new(begin);
        pace.asked(begin);
        pace.answered(begin);
        for second in 1..60 {
            pace.blocked(at(second));
            assert_eq!(pace.deadline(), (at(second) + STALL, Overdue::Stalled));
            pace.blocked(at(second) + STALL / 2);
            assert_eq!(pace.deadline(), (at(second) + STALL, Overdue::Stalled));
            pace.took(at(second));
            assert_eq!(pace.deadline(), (at(second) + IDLE, Overdue::Idle));
        }
        pace.asked(at(60));
        assert_eq!(pace.deadline(), (begin + LIFE, Overdue::Old));
    }
}
