//! The orders to the tick: in their order, without loss.
//!
//! They travel over a ring. If it is full, orders wait at the engine's end, and the tick is told that orders
//! are missing. It then begins no move, since the move may have been withdrawn.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

use rtrb::{Consumer, Producer, PushError, RingBuffer};

use super::ToTick;

/// The engine's end.
pub struct Orders {
    ring: Producer<ToTick>,
    /// Orders that wait because the ring was full.
    waiting: VecDeque<ToTick>,
    behind: Arc<AtomicBool>,
}

/// The tick's end.
pub(super) struct Ordered {
    ring: Consumer<ToTick>,
    behind: Arc<AtomicBool>,
}

/// Both ends of a ring of this capacity.
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
    /// Adds an order, after all earlier ones.
    pub fn push(&mut self, order: ToTick) {
        self.waiting.push_back(order);
        self.hand_on();
    }

    /// Moves waiting orders to the ring, as far as there is room.
    pub fn hand_on(&mut self) {
        while let Some(order) = self.waiting.pop_front() {
            if let Err(PushError::Full(order)) = self.ring.push(order) {
                self.waiting.push_front(order);
                break;
            }
        }
        self.behind.store(self.is_behind(), SeqCst);
    }

    /// Whether an order waits because the tick has not taken earlier ones for a long time.
    pub fn is_behind(&self) -> bool {
        !self.waiting.is_empty()
    }
}

impl Ordered {
    /// Whether all orders so far are in the ring. Asked before the ring is emptied, the answer holds for its
    /// content.
    pub fn is_whole(&self) -> bool {
        !self.behind.load(SeqCst)
    }

    /// The next order.
    pub fn pop(&mut self) -> Option<ToTick> {
        self.ring.pop().ok()
    }
}
