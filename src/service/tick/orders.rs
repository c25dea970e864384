//! The orders to the tick: in the order in which they are given, and none is lost.
//!
//! They travel over a ring. What finds it full waits at the engine's end, and the tick is told that it does not know
//! everything yet: it begins no move then, which may have been taken back since.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

use rtrb::{Consumer, Producer, PushError, RingBuffer};

use super::ToTick;

/// The engine's end.
pub struct Orders {
    ring: Producer<ToTick>,
    /// What has found the ring full.
    waiting: VecDeque<ToTick>,
    behind: Arc<AtomicBool>,
}

/// The tick's end.
pub(super) struct Ordered {
    ring: Consumer<ToTick>,
    behind: Arc<AtomicBool>,
}

/// Both ends of a ring for so many orders.
pub(super) fn orders(capacity: usize) -> (Orders, Ordered) {
    let (producer, consumer) = RingBuffer::new(capacity);
    let behind = Arc::<AtomicBool>::default();
    let engine = Orders {
        ring: producer,
        waiting: VecDeque::new(),
        behind: Arc::clone(&behind),
    };
    let tick = Ordered {
        ring: consumer,
        behind,
    };
    (engine, tick)
}

impl Orders {
    /// Gives an order, after all that were given before.
    pub fn push(&mut self, order: ToTick) {
        self.waiting.push_back(order);
        self.hand_on();
    }

    /// Hands on what waits, as far as there is room.
    pub fn hand_on(&mut self) {
        while let Some(order) = self.waiting.pop_front() {
            if let Err(PushError::Full(order)) = self.ring.push(order) {
                self.waiting.push_front(order);
                break;
            }
        }
        self.behind.store(self.is_behind(), SeqCst);
    }

    /// Whether an order waits, because the tick has not taken those before it for a long time.
    pub fn is_behind(&self) -> bool {
        !self.waiting.is_empty()
    }
}

impl Ordered {
    /// Whether every order that was given so far is in the ring. Asked before the ring is emptied, it holds for what
    /// is found there.
    pub fn is_whole(&self) -> bool {
        !self.behind.load(SeqCst)
    }

    /// The next order.
    pub fn pop(&mut self) -> Option<ToTick> {
        self.ring.pop().ok()
    }
}
