//! Learned modes, published at a NATS server for fleet management.
//!
//! Each joint has two subjects, in JSON: `quell.<robot>.<joint>.estimate` has an [`EstimateView`] whenever the
//! estimate changes, at most once a second; `quell.<robot>.<joint>.train` the mode and the impulses whenever
//! another train is in force. `unix_time_s` in each is the time of the change. A dot in a joint's name becomes
//! `_`.
//!
//! They are plain messages: nothing waits for an absent server, least of all the robot. When the server is
//! back, it gets the present values.

use std::io;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use async_nats::{Client, ConnectOptions, ServerAddr};
use serde::Serialize;
use tokio::sync::{oneshot, watch};
use tokio::time::{sleep, timeout};

use super::config::NatsConfig;
use super::contract::{
    EstimateView, Handle, JointSnapshot, LearningView, ModeValue, Snapshot, TrainView,
};

/// Interval of publishing, s. A mode belongs to a machine and drifts within minutes. A fleet of 10^5 axes in
/// permanent motion makes 10^5 messages a second.
const INTERVAL: Duration = Duration::from_secs(1);
/// Most time for the last messages when the service ends.
const FAREWELL: Duration = Duration::from_secs(1);

/// Publishes until it is dropped.
pub struct Telemetry {
    ending: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Telemetry {
    /// Starts to publish; the server need not be reachable yet.
    ///
    /// # Errors
    /// The system's error; [`io::ErrorKind::InvalidInput`] for an invalid address.
    pub fn start(config: &NatsConfig, handle: &Handle) -> io::Result<Self> {
        let server: ServerAddr = config.server.parse()?;
        let teller = Teller {
            robot: config.robot.clone(),
            snapshots: handle.snapshots(),
            told: Vec::new(),
        };
        let (ending, ended) = oneshot::channel();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("quell-telemetry".into())
            .spawn(move || {
                runtime.block_on(serve(server, teller, ended));
                // The search for the server's address may take longer than the service.
                runtime.shutdown_background();
            })?;
        Ok(Self {
            ending: Some(ending),
            thread: Some(thread),
        })
    }
}

impl Drop for Telemetry {
    fn drop(&mut self) {
        // The thread ends once its channel is closed.
        self.ending = None;
        if let Some(thread) = self.thread.take() {
            // If it panicked, that was reported when it did.
            let _ = thread.join();
        }
    }
}

async fn serve(server: ServerAddr, mut teller: Teller, mut ended: oneshot::Receiver<()>) {
    let options = ConnectOptions::new().name("quell");
    let connected = options.retry_on_initial_connect().connect(server).await;
    let client = match connected {
        Ok(client) => client,
        Err(error) => {
            tracing::warn!(%error, "what is learned is not published");
            return;
        }
    };
    tokio::select! {
        () = teller.tell(&client) => {}
        _ = &mut ended => {}
    }
    // The end does not wait for an absent server.
    let _ = timeout(FAREWELL, client.flush()).await;
}

/// The last messages on a joint.
#[derive(Clone, Default)]
struct Told {
    /// Time of the estimate.
    estimate: Option<f64>,
    /// The train in force; empty before there is one.
    train: TrainView,
    /// Knowledge from moves.
    learning: LearningView,
}

struct Teller {
    robot: String,
    snapshots: watch::Receiver<Arc<Snapshot>>,
    told: Vec<Told>,
}

#[derive(Serialize)]
struct Estimate<'a> {
    unix_time_s: f64,
    #[serde(flatten)]
    estimate: &'a EstimateView,
}

#[derive(Serialize)]
struct Modes<'a> {
    unix_time_s: f64,
    #[serde(flatten)]
    learning: &'a LearningView,
}

#[derive(Serialize)]
struct Train<'a> {
    unix_time_s: f64,
    shaper: &'static str,
    mode: Option<ModeValue>,
    #[serde(flatten)]
    train: &'a TrainView,
}

impl Teller {
    /// Publishes changes until the engine has ended.
    async fn tell(&mut self, client: &Client) {
        while self.snapshots.changed().await.is_ok() {
            let snapshot = Arc::clone(&self.snapshots.borrow_and_update());
            self.told.resize(snapshot.joints.len(), Told::default());
            for (index, joint) in snapshot.joints.iter().enumerate() {
                for (what, payload) in self.changed(index, joint, snapshot.unix_time_s) {
                    let name = joint.name.replace('.', "_");
                    let subject = format!("quell.{}.{name}.{what}", self.robot);
                    if let Err(error) = client.publish(subject, payload.into()).await {
                        tracing::warn!(%error, "what is learned is not published");
                    }
                }
            }
            sleep(INTERVAL).await;
        }
    }

    /// New values of a joint, as subject and JSON.
    fn changed(
        &mut self,
        joint: usize,
        now: &JointSnapshot,
        time: f64,
    ) -> Vec<(&'static str, Vec<u8>)> {
        let told = &mut self.told[joint];
        // Numbers and strings always serialise.
        let mut news = Vec::new();
        if let Some(estimate) = &now.estimate
            && told.estimate.replace(estimate.time_s) != Some(estimate.time_s)
        {
            let payload = serde_json::to_vec(&Estimate {
                unix_time_s: time,
                estimate,
            });
            news.push(("estimate", payload.unwrap_or_default()));
        }
        if told.learning != now.learning {
            told.learning.clone_from(&now.learning);
            let payload = serde_json::to_vec(&Modes {
                unix_time_s: time,
                learning: &now.learning,
            });
            news.push(("modes", payload.unwrap_or_default()));
        }
        if told.train != now.train {
            told.train.clone_from(&now.train);
            let payload = serde_json::to_vec(&Train {
                unix_time_s: now.mode_since_s,
                shaper: now.shaper,
                mode: now.mode,
                train: &now.train,
            });
            news.push(("train", payload.unwrap_or_default()));
        }
        news
    }
}
