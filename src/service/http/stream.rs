//! `GET /api/v1/stream`: live events for any number of readers.
//!
//! Every message is JSON with a `type`:
//! - `state`, four times a second: `state` is the [`Snapshot`](crate::service::contract::Snapshot);
//! - `batch`: `number`, counted up by 1; `frames`, of each joint one every 10 ms; `events`;
//! - `lost`: number of `batches` that were not sent because this reader was too slow.
//!
//! A message is created once for all readers. A reader that is too slow loses the oldest messages and does not
//! delay others.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

use axum::extract::State;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tokio::sync::broadcast::{self, error::RecvError};

use super::App;
use super::answer::Refused;
use super::counters::{Open, add};
use crate::service::contract::{Batch, Event, Frame, Handle, Snapshot};

/// Time between frames of a joint, s: more than ten in a period of a robot's modes.
const INTERVAL: f64 = 0.01;
/// Time between states.
const STATE: Duration = Duration::from_millis(250);
/// Messages that a reader may lag behind: some two seconds.
const BEHIND: usize = 128;
/// Time in which a message must be read; otherwise the connection is closed.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longest message of a reader, bytes; its content is ignored.
const LONGEST: usize = 1024;

/// A message for all readers.
#[derive(Clone, Debug)]
struct News {
    /// The number of a batch.
    number: Option<u64>,
    text: Utf8Bytes,
}

/// The source of messages for readers; cheap to clone.
#[derive(Clone, Debug)]
pub struct Feed(broadcast::Sender<News>);

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Told<'a> {
    State {
        state: &'a Snapshot,
    },
    Batch {
        number: u64,
        frames: Vec<Frame>,
        events: &'a [Event],
    },
    Lost {
        batches: u64,
    },
}

impl Feed {
    /// Starts to create messages of the stream; none while there is no reader.
    pub fn start(handle: &Handle) -> Self {
        let (sender, _) = broadcast::channel(BEHIND);
        tokio::spawn(make(handle.clone(), handle.stream(), sender.clone()));
        Self(sender)
    }
}

async fn make(
    handle: Handle,
    mut stream: broadcast::Receiver<Arc<Batch>>,
    sender: broadcast::Sender<News>,
) {
    let mut state = tokio::time::interval(STATE);
    loop {
        let news = tokio::select! {
            batch = stream.recv() => match batch {
                Ok(batch) if sender.receiver_count() > 0 => news_of(&batch),
                Err(RecvError::Closed) => break,
                // The gap in the numbers shows the loss to the readers.
                _ => continue,
            },
            _ = state.tick() => {
                if sender.receiver_count() == 0 {
                    continue;
                }
                let state = Told::State { state: &handle.snapshot() };
                text(&state).map(|text| News { number: None, text })
            }
        };
        // There may be no reader any more.
        let _ = news.map(|news| sender.send(news));
    }
}

fn news_of(batch: &Batch) -> Option<News> {
    let told = Told::Batch {
        number: batch.number,
        frames: batch.frames(INTERVAL),
        events: &batch.events,
    };
    let number = Some(batch.number);
    text(&told).map(|text| News { number, text })
}

fn text(told: &Told) -> Option<Utf8Bytes> {
    let text = serde_json::to_string(told);
    text.inspect_err(|error| tracing::error!(%error, "a message cannot be written"))
        .ok()
        .map(Utf8Bytes::from)
}

/// `GET /api/v1/stream`.
pub async fn stream(State(app): State<Arc<App>>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(place) = Arc::clone(&app.streams).try_acquire_owned() else {
        let sentence = "too many streams are open; close one";
        return Refused::new(StatusCode::SERVICE_UNAVAILABLE, sentence).into_response();
    };
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    upgrade.on_upgrade(async move |socket| {
        let _place = place;
        let _open = Open::new(&app.counters.streams);
        follow(&app, socket).await;
    })
}

/// Sends messages until the reader disconnects or stops reading.
async fn follow(app: &App, mut socket: WebSocket) {
    let mut news = app.feed.0.subscribe();
    let first = text(&Told::State {
        state: &app.handle.snapshot(),
    });
    if let Some(first) = first
        && !send(app, &mut socket, first).await
    {
        return;
    }
    let mut last = None;
    loop {
        tokio::select! {
            one = news.recv() => {
                let one = match one {
                    Ok(one) => one,
                    Err(RecvError::Lagged(_)) => continue,
                    Err(RecvError::Closed) => return,
                };
                let lost = lost(&mut last, one.number);
                app.counters.batches_lost.fetch_add(lost, Relaxed);
                let told = (lost > 0).then(|| text(&Told::Lost { batches: lost })).flatten();
                for message in told.into_iter().chain([one.text]) {
                    if !send(app, &mut socket, message).await {
                        return;
                    }
                }
            }
            // The library answers pings; all else is ignored.
            heard = socket.recv() => match heard {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => {}
            },
        }
    }
}

/// Number of batches between the last one and this one.
fn lost(last: &mut Option<u64>, number: Option<u64>) -> u64 {
    let Some(number) = number else { return 0 };
    let expected = last.replace(number).map_or(number, |last| last + 1);
    number.saturating_sub(expected)
}

async fn send(app: &App, socket: &mut WebSocket, text: Utf8Bytes) -> bool {
    match tokio::time::timeout(PATIENCE, socket.send(Message::Text(text))).await {
        Ok(result) => result.is_ok(),
        Err(_) => {
            add(&app.counters.streams_closed);
            false
        }
    }
}
