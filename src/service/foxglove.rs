//! A live view for Foxglove: command and motion of each joint, and the residual vibration of its moves.
//!
//! Each joint has two channels, in JSON: `/quell/<joint>` has a [`Frame`] every 5 ms, `/quell/<joint>/moves` a
//! [`MoveResult`] after each move. A client that is too slow loses the oldest messages; nothing waits for it.
//!
//! Source: Foxglove, WebSocket protocol, subprotocol `foxglove.sdk.v1`.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use foxglove::{Context, FoxgloveError, PartialMetadata, RawChannel, Schema};
use serde::Serialize;
use serde_json::{Value, json};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, oneshot};
use tokio::time::timeout;

use super::clock::ServiceClock;
use super::contract::{Batch, Event, Frame, Handle, KnownMode, ModeValue, MoveResult};

/// Time between two frames of a joint, s: a screen shows every third.
const INTERVAL: f64 = 0.005;
/// Most time for the clients to leave when the service ends.
const FAREWELL: Duration = Duration::from_secs(1);

/// A server that runs until this is dropped.
pub struct FoxgloveServer {
    address: SocketAddr,
    ending: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl FoxgloveServer {
    /// Starts the server; port 0 takes a free one.
    ///
    /// # Errors
    /// The system's error, for example if the port is in use.
    pub fn start(
        address: SocketAddr,
        joints: &[String],
        handle: &Handle,
        clock: ServiceClock,
    ) -> io::Result<Self> {
        let context = Context::new();
        let channels = joints.iter().map(|joint| Channels::new(&context, joint));
        let channels = channels.collect::<Result<Vec<_>, _>>();
        let view = View {
            channels: channels.map_err(io::Error::other)?,
            stream: handle.stream(),
            origin: clock.unix_time() - clock.now(),
            clock,
        };
        let (ending, ended) = oneshot::channel();
        let (started, port) = sync_channel(1);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("quell-foxglove".into())
            .spawn(move || runtime.block_on(serve(address, &context, view, started, ended)))?;
        let port = port.recv().map_err(io::Error::other)??;
        Ok(Self {
            address: SocketAddr::new(address.ip(), port),
            ending: Some(ending),
            thread: Some(thread),
        })
    }

    /// Its address.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for FoxgloveServer {
    fn drop(&mut self) {
        // The thread ends once its channel is closed.
        self.ending = None;
        if let Some(thread) = self.thread.take() {
            // If it panicked, that was reported when it did.
            let _ = thread.join();
        }
    }
}

/// The channels of one joint.
struct Channels {
    joint: String,
    frames: Arc<RawChannel>,
    moves: Arc<RawChannel>,
}

impl Channels {
    fn new(context: &Arc<Context>, joint: &str) -> Result<Self, FoxgloveError> {
        let channel = |topic: String, schema: Schema| {
            let channel = context.channel_builder(topic).message_encoding("json");
            channel.schema(schema).build_raw()
        };
        let frame = Frame {
            motor_rad: Some(0.0),
            deformation_rad: Some(0.0),
            tip_deformation_m: Some(0.0),
            frequency_hz: Some(0.0),
            frequency_std_hz: Some(0.0),
            ..Frame::default()
        };
        let moved = MoveResult {
            mode: Some(ModeValue {
                frequency_hz: 0.0,
                damping_ratio: 0.0,
            }),
            payload_kg: Some(0.0),
            residual_rad: Some(0.0),
            residual_m: Some(0.0),
            unshaped_rad: Some(0.0),
            unshaped_m: Some(0.0),
            vibration_rad: Some(0.0),
            vibration_m: Some(0.0),
            unshaped_vibration_rad: Some(0.0),
            unshaped_vibration_m: Some(0.0),
            unshaped_std_rad: Some(0.0),
            modes: vec![KnownMode::default()],
            recording: Some(String::new()),
            ..MoveResult::default()
        };
        Ok(Self {
            joint: joint.to_owned(),
            frames: channel(format!("/quell/{joint}"), schema("quell.Frame", &frame))?,
            moves: channel(
                format!("/quell/{joint}/moves"),
                schema("quell.Move", &moved),
            )?,
        })
    }
}

/// The JSON schema of an example in which no field is left out.
fn schema(name: &str, example: &impl Serialize) -> Schema {
    fn kind(value: &Value) -> Value {
        match value {
            Value::Object(fields) => {
                let fields = fields
                    .iter()
                    .map(|(name, value)| (name.clone(), kind(value)));
                let fields: serde_json::Map<_, _> = fields.collect();
                json!({ "type": "object", "properties": fields })
            }
            Value::Array(items) => {
                json!({ "type": "array", "items": items.first().map(kind) })
            }
            Value::String(_) => json!({ "type": "string" }),
            Value::Bool(_) => json!({ "type": "boolean" }),
            _ => json!({ "type": "number" }),
        }
    }
    let example = serde_json::to_value(example).unwrap_or_default();
    Schema::new(name, "jsonschema", kind(&example).to_string().into_bytes())
}

/// The state of the server.
struct View {
    channels: Vec<Channels>,
    stream: broadcast::Receiver<Arc<Batch>>,
    /// The service's zero in seconds since 1970.
    origin: f64,
    clock: ServiceClock,
}

async fn serve(
    address: SocketAddr,
    context: &Arc<Context>,
    mut view: View,
    started: SyncSender<io::Result<u16>>,
    mut ended: oneshot::Receiver<()>,
) {
    let server = context.websocket_server().name("quell");
    let server = server.bind(address.ip().to_string(), address.port());
    let server = match server.start().await {
        Ok(server) => server,
        Err(error) => {
            // The caller of `start` waits for this message.
            let _ = started.send(Err(io::Error::other(error)));
            return;
        }
    };
    let _ = started.send(Ok(server.port()));
    loop {
        tokio::select! {
            batch = view.stream.recv() => match batch {
                Ok(batch) => view.show(&batch),
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => break,
            },
            _ = &mut ended => break,
        }
    }
    // A client that does not read its farewell holds nothing.
    let _ = timeout(FAREWELL, server.stop().wait()).await;
}

impl View {
    fn show(&mut self, batch: &Batch) {
        if self.channels.iter().any(|joint| joint.frames.has_sinks()) {
            for frame in batch.frames(INTERVAL) {
                if let Some(joint) = self.channels.get(frame.joint) {
                    self.log(&joint.frames, &frame, frame.time_s + self.origin);
                }
            }
        }
        for event in &batch.events {
            if let Event::MoveEnded(moved) = event {
                let named = |joint: &&Channels| joint.joint == moved.joint;
                if let Some(joint) = self.channels.iter().find(named) {
                    self.log(&joint.moves, moved.as_ref(), self.clock.unix_time());
                }
            }
        }
    }

    fn log(&self, channel: &RawChannel, what: &impl Serialize, unix_time: f64) {
        let time = PartialMetadata::with_log_time((unix_time * 1e9) as u64);
        // Numbers and strings always serialise.
        if let Ok(text) = serde_json::to_vec(what) {
            channel.log_with_meta(&text, time);
        }
    }
}
