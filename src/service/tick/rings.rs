//! The rings between tick and engine.

use rtrb::{Consumer, Producer, RingBuffer};

use super::orders::{Ordered, Orders, orders};
use super::{Event, JointReport, Record, WholeReport};

/// Most waiting orders and events of a joint; it has at most a few of either.
pub(super) const ORDERS: usize = 64;
/// Duration of records that may wait for the engine, s.
const RECORDED: f64 = 2.0;
/// Records for each tick and joint that the ring has room for: a row, three sensors, and a deformation.
const RECORDS: f64 = 5.0;
/// Most waiting rounds of reports.
const ROUNDS: usize = 8;

/// The engine's end of the tick.
pub struct EngineRings {
    /// Orders to the tick.
    pub orders: Orders,
    /// The events.
    pub events: Consumer<Event>,
    /// Commands and measurements.
    pub records: Consumer<Record>,
    /// Reports of the joints.
    pub joints: Consumer<JointReport>,
    /// Report of tick and link, after the joints of the same round.
    pub whole: Consumer<WholeReport>,
}

/// The tick's end of the engine.
pub(super) struct TickRings {
    pub orders: Ordered,
    pub events: Producer<Event>,
    pub records: Producer<Record>,
    pub joints: Producer<JointReport>,
    pub whole: Producer<WholeReport>,
}

/// Both ends, for so many joints and a control period, s.
pub(super) fn rings(joints: usize, period: f64) -> (TickRings, EngineRings) {
    let capacity = RECORDED / period * RECORDS * joints as f64;
    let (orders, taken) = orders(ORDERS * joints);
    let (tell, events) = RingBuffer::new(2 * ORDERS * joints);
    let (record, records) = RingBuffer::new(capacity as usize);
    let (report, reports) = RingBuffer::new(ROUNDS * joints);
    let (report_whole, whole) = RingBuffer::new(ROUNDS);
    let tick = TickRings {
        orders: taken,
        events: tell,
        records: record,
        joints: report,
        whole: report_whole,
    };
    let engine = EngineRings {
        orders,
        events,
        records,
        joints: reports,
        whole,
    };
    (tick, engine)
}
