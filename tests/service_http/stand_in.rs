//! An engine that does nothing but answer, and the service's outside upon it.

use quell::report::page;
use quell::service::contract::{
    Accepted, EnableState, EngineEnds, JointSnapshot, KnownMode, LearningView, ModeValue, Request,
    ServiceError, Snapshot, Stopping, TrainView, channels,
};
use quell::service::http::{Settings, serve};
use quell::service::recorder::{Bounds, Recorder, Shelf};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::{broadcast, oneshot};

pub struct Outside {
    pub address: SocketAddr,
    pub stream: broadcast::Sender<Arc<quell::service::contract::Batch>>,
    end: Option<oneshot::Sender<()>>,
    // Dropped last: everything runs on it.
    _runtime: Runtime,
}

impl Drop for Outside {
    fn drop(&mut self) {
        self.end.take().map(|end| end.send(()));
    }
}

pub fn settings() -> Settings {
    Settings {
        token: None,
        max_connections: 16,
        max_body_bytes: 4096,
        arcs: BTreeMap::new(),
        recorder: None,
        report: page,
        diagnosis_limit: Duration::from_secs(600),
    }
}

pub const BOUNDS: Bounds = Bounds {
    bytes: 1_000_000,
    count: 100,
    last: 1,
};

/// With recordings in a folder, if there is one.
pub fn outside(mut settings: Settings, shelf: Option<(&Path, Bounds)>) -> Outside {
    let runtime = Runtime::new().unwrap();
    let (handle, ends) = channels(snapshot());
    let stream = ends.stream.clone();
    let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).unwrap();
    let address = listener.local_addr().unwrap();
    let (end, ended) = oneshot::channel::<()>();
    let shelf = shelf.map(|(folder, bounds)| Shelf::open(folder, bounds).unwrap());
    runtime.block_on(async {
        tokio::spawn(answer(ends));
        settings.recorder = shelf.map(|shelf| Recorder::start(&handle, shelf));
        tokio::spawn(async move {
            let ended = async {
                // A dropped sender ends it as well.
                let _ = ended.await;
            };
            serve(listener, handle, settings, ended).await.unwrap();
        });
    });
    Outside {
        address,
        stream,
        end: Some(end),
        _runtime: runtime,
    }
}

fn snapshot() -> Snapshot {
    Snapshot {
        version: "0",
        robot: "stand-in",
        joints: vec![JointSnapshot {
            name: "joint_1".into(),
            range_rad: [-100_f64.to_radians(), 100_f64.to_radians()],
            shaper: "zvd",
            mode: Some(ModeValue {
                frequency_hz: 8.0,
                damping_ratio: 0.05,
            }),
            train: TrainView {
                times_s: vec![0.0, 0.06],
                amplitudes: vec![0.5, 0.5],
            },
            learning: LearningView {
                modes: vec![KnownMode::default(), KnownMode::default()],
                ..LearningView::default()
            },
            ..JointSnapshot::default()
        }],
        ..Snapshot::default()
    }
}

async fn answer(mut ends: EngineEnds) {
    while let Some(envelope) = ends.requests.recv().await {
        let value = |what, value| {
            let rule = "finite and plausible";
            Err(ServiceError::Value { what, value, rule })
        };
        let answer = match envelope.request {
            Request::Move { target, .. } if !target.is_finite() => value("target", target),
            Request::Move { shaper, .. } if shaper.as_deref() == Some("nonsense") => {
                Err(ServiceError::UnknownShaper {
                    shaper: "nonsense".into(),
                    known: "zvd".into(),
                })
            }
            Request::Move { shaper, .. } if shaper.as_deref() == Some("zv") => {
                let joint = "joint_1".into();
                Err(ServiceError::ShaperInMotion { joint })
            }
            Request::Move { .. } | Request::MoveWithin { .. } => Ok(Accepted::Move {
                id: 1,
                duration_s: 1.0,
                speed: 1.0,
            }),
            Request::MoveTogether { .. } => Ok(Accepted::Together {
                moves: Vec::new(),
                duration_s: 1.0,
            }),
            Request::Jog { .. } => Ok(Accepted::Jog { held_s: 0.25 }),
            Request::Feed { .. } | Request::Forget { .. } => Ok(Accepted::Changed),
            Request::Stop => Ok(Accepted::Stop {
                duration_s: 0.1,
                joints: vec![Stopping {
                    joint: "joint_1".into(),
                    duration_s: Some(0.1),
                }],
            }),
            Request::Enable | Request::Disable | Request::Reset => Ok(Accepted::EnableState {
                state: EnableState::Disabled,
            }),
            Request::Payload { mass } if mass > 1.0 => value("mass_kg", mass),
            Request::Payload { .. } => Err(ServiceError::Stopping),
            Request::Shaping(_) => Ok(Accepted::Changed),
        };
        // Whoever asked may have gone.
        let _ = envelope.reply.send(answer);
    }
}
