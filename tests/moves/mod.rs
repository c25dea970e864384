//! Moves as the stream tells of them, without an engine.

use quell::service::contract::{Batch, Event, Measured, MoveResult, MoveStart, Quantity, TickRow};

/// A move of half a second from 2 s on, as the engine tells of it: of 4.5 s, 14 batches end before it does.
pub fn a_move(id: u64) -> Vec<Batch> {
    let name = Some(format!("move-{id:06}"));
    let times: Vec<f64> = (0..450).map(|k| 0.01 * f64::from(k)).collect();
    let batch = |(number, times): (usize, &[f64])| Batch {
        number: number as u64 + 1000 * id,
        time: times[times.len() - 1],
        ticks: times.iter().map(|&time| row(time)).collect(),
        measured: times.iter().map(|&time| measured(time)).collect(),
        events: Vec::new(),
    };
    let mut batches: Vec<_> = times.chunks(20).enumerate().map(batch).collect();
    batches[10].events.push(Event::MoveStarted(MoveStart {
        id,
        joint: "joint_1".into(),
        time_s: 2.0,
        recording: name.clone(),
        ..MoveStart::default()
    }));
    batches[14]
        .events
        .push(Event::MoveEnded(Box::new(MoveResult {
            id,
            joint: "joint_1".into(),
            recording: name,
            ..MoveResult::default()
        })));
    batches
}

fn row(time: f64) -> TickRow {
    TickRow {
        time,
        position: (time - 2.0).clamp(0.0, 0.5),
        ..TickRow::default()
    }
}

fn measured(time: f64) -> Measured {
    Measured {
        received: time,
        stamp: time + 700.0,
        joint: 0,
        quantity: Quantity::MotorPosition,
        value: [time, 0.0, 0.0],
        refused: false,
    }
}
