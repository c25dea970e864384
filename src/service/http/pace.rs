//! How slow a client may be: what a connection waits for now, and until when.
//!
//! A client that holds a connection without using it takes a place from others. So each thing that is
//! waited for has its own time, on every address, loopback included.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::time::Instant;

/// Time in which the head of a request must be here, from its first byte on, or from when the connection
/// was made. 16 KiB take less on any line that can show the page.
const HEAD: Duration = Duration::from_secs(1);
/// Time for which a connection without a request is kept after an answer: browsers and scripts that ask every
/// few seconds need not connect anew.
const IDLE: Duration = Duration::from_secs(15);
/// Time in which a client must take some of its answer: as long as a reader of the stream has.
const STALL: Duration = Duration::from_secs(10);
/// Time after which a connection ends with the answer that it is at.
const LIFE: Duration = Duration::from_secs(600);

/// The event that a connection waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Waits {
    /// For the first byte of all.
    Byte,
    /// For the head of a request.
    Head,
    /// For the service: the handler bounds the time of the body and of its own work.
    Answer,
    /// For the next request; parts of the last answer may still be on their way.
    Request,
}

/// Why a connection has to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overdue {
    /// Nothing came: browsers connect before they ask, and ask again elsewhere where they are not told anything.
    Silent,
    /// The head of a request was not here in time: nothing of an answer has been sent.
    Head,
    /// No request came.
    Idle,
    /// The client does not take its answer.
    Stalled,
    /// It has lived long enough.
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
    /// Since when the client takes nothing, where something waits to be sent.
    blocked: Option<Instant>,
}

impl Pace {
    /// Of a connection that is made now.
    pub fn new(now: Instant) -> Self {
        Self(Mutex::new(State {
            opened: now,
            waits: Waits::Byte,
            since: now,
            blocked: None,
        }))
    }

    /// Bytes came.
    pub fn heard(&self, now: Instant) {
        let mut state = self.state();
        match state.waits {
            // Its second began with the connection.
            Waits::Byte => state.waits = Waits::Head,
            Waits::Request => (state.waits, state.since) = (Waits::Head, now),
            Waits::Head | Waits::Answer => {}
        }
    }

    /// The head of a request is whole.
    pub fn asked(&self, now: Instant) {
        let mut state = self.state();
        (state.waits, state.since) = (Waits::Answer, now);
    }

    /// The service has answered.
    pub fn answered(&self, now: Instant) {
        let mut state = self.state();
        (state.waits, state.since) = (Waits::Request, now);
    }

    /// The client took some bytes.
    pub fn took(&self, now: Instant) {
        let mut state = self.state();
        state.blocked = None;
        if state.waits == Waits::Request {
            state.since = now;
        }
    }

    /// The client takes no bytes now.
    pub fn blocked(&self, now: Instant) {
        self.state().blocked.get_or_insert(now);
    }

    /// When the connection has to end if nothing happens, and why.
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

    /// No holder can leave the state half changed: each change is an assignment of plain data.
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
