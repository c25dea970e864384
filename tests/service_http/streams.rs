//! Readers of the stream, also those that do not read.

use super::stand_in::{Outside, outside, settings};
use quell::service::contract::{Batch, TickRow};
use serde_json::Value;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket, client::client};

type Reader = WebSocket<TcpStream>;

fn reader(outside: &Outside) -> Reader {
    let stream = TcpStream::connect(outside.address).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    let address = format!("ws://{}/api/stream", outside.address);
    client(address, stream).unwrap().0
}

fn next(reader: &mut Reader) -> Value {
    loop {
        if let Message::Text(text) = reader.read().unwrap() {
            return serde_json::from_str(&text).unwrap();
        }
    }
}

/// A batch of some 60 kB of text.
fn batch(number: u64) -> Arc<Batch> {
    let row = |k: u64| TickRow {
        time: 4.0 * number as f64 + 0.02 * k as f64 + 0.005,
        deformation: f64::NAN,
        natural_frequency: f64::NAN,
        ..TickRow::default()
    };
    Arc::new(Batch {
        number,
        ticks: (0..200).map(row).collect(),
        ..Batch::default()
    })
}

#[test]
fn who_does_not_read_loses_and_is_told_while_others_get_all() {
    let outside = outside(settings(), None);
    let mut sleepers: Vec<_> = (0..10).map(|_| reader(&outside)).collect();
    let mut awake = reader(&outside);
    assert_eq!(next(&mut awake)["type"], "state");
    let count = 400;
    let (mut seen, mut frames) = (0, 0);
    let begin = Instant::now();
    for number in 0..count {
        outside.stream.send(batch(number)).unwrap();
        // The one that reads is kept in step, so that its own speed plays no role.
        loop {
            let message = next(&mut awake);
            assert_ne!(message["type"], "lost", "{message}");
            if message["type"] == "batch" {
                assert_eq!(message["number"], number);
                frames += message["frames"].as_array().unwrap().len();
                break;
            }
        }
        seen += 1;
    }
    println!(
        "{count} batches in {:?} beside ten that do not read",
        begin.elapsed()
    );
    assert_eq!((seen, frames), (count, 200 * count as usize));
    // One that wakes up is told what it missed, and goes on with the newest.
    let sleeper = &mut sleepers[0];
    let (mut last, mut told) = (None, 0);
    while last != Some(count - 1) {
        let message = next(sleeper);
        match message["type"].as_str() {
            Some("lost") => told += message["batches"].as_u64().unwrap(),
            Some("batch") => {
                let number = message["number"].as_u64().unwrap();
                last = Some(number);
            }
            _ => {}
        }
    }
    assert!(told > 0 && told < count, "{told} told as lost");
    let mut client = super::Client::new(outside.address);
    let metrics = client.get("/metrics").text();
    assert!(metrics.contains("quell_streams 11\n"), "{metrics}");
}
