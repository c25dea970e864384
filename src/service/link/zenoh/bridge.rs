//! The bridge to ROS 2 besides the setpoints: moves in, modes and impulses out.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio::runtime::Runtime;
use zenoh::qos::Priority;

use super::messages::{self, FLOAT64_MULTI_ARRAY, JOINT_TRAJECTORY};
use super::node::{Node, Publisher, Subscription};
use crate::recording::Encoder;
use crate::service::config::Config;
use crate::service::contract::{Handle, JointSnapshot, Request};

/// Most waiting trajectories.
const WAITING: usize = 16;
/// Interval of publishing modes and impulses: a late subscriber gets them soon, and it is fast enough for a
/// display.
const TOLD: Duration = Duration::from_millis(100);
/// The fields of a mode's message.
const MODE: &str = "frequency_hz,damping_ratio,estimated_frequency_hz,estimated_frequency_std_hz,\
                    estimated_damping_ratio,estimated_damping_ratio_std,converged";

/// The messages to the bridge's thread.
enum Word {
    /// Joints and their targets, rad.
    Targets(Vec<(String, f64)>),
    /// The service ends.
    End,
}

/// Turns trajectories into moves, and publishes modes and impulses, until it is dropped.
pub struct ZenohBridge {
    words: SyncSender<Word>,
    thread: Option<JoinHandle<()>>,
}

/// The publishers of one joint.
struct Told {
    mode: Publisher,
    impulses: Publisher,
    modes: Publisher,
}

impl ZenohBridge {
    /// Subscribes to the targets and starts the thread.
    ///
    /// # Errors
    /// The error of Zenoh or of the system.
    pub fn start(node: Arc<Node>, config: &Config, handle: Handle) -> io::Result<Self> {
        let (words, heard) = sync_channel(WAITING);
        let joints = config.joints.iter();
        let told = joints.map(|joint| told(&node, &joint.name));
        let told = told.collect::<io::Result<Vec<_>>>()?;
        let targets = words.clone();
        let subscription =
            node.subscribe(&config.zenoh.targets, &JOINT_TRAJECTORY, move |body| {
                take(body, &targets)
            })?;
        let runtime = tokio::runtime::Builder::new_current_thread().build()?;
        let thread = std::thread::Builder::new()
            .name("quell-ros2".into())
            .spawn(move || run(&heard, &handle, &runtime, told, subscription, node))?;
        Ok(Self {
            words,
            thread: Some(thread),
        })
    }
}

impl Drop for ZenohBridge {
    fn drop(&mut self) {
        // If the channel is closed, the thread has ended already.
        let _ = self.words.send(Word::End);
        if let Some(thread) = self.thread.take() {
            // If it panicked, that was reported when it did.
            let _ = thread.join();
        }
    }
}

fn told(node: &Node, joint: &str) -> io::Result<Told> {
    // A joint's name may contain characters that a topic of ROS 2 may not.
    let name = joint.replace(['-', '.'], "_");
    let publisher = |what: &str| {
        let topic = format!("/quell/{name}/{what}");
        node.publisher(&topic, &FLOAT64_MULTI_ARRAY, Priority::Data)
    };
    Ok(Told {
        mode: publisher("mode")?,
        impulses: publisher("impulses")?,
        modes: publisher("modes")?,
    })
}

fn take(body: &[u8], words: &SyncSender<Word>) {
    let Some(targets) = messages::targets(body) else {
        tracing::warn!("a trajectory without a last point for all of its joints is refused");
        return;
    };
    if words.try_send(Word::Targets(targets)).is_err() {
        tracing::warn!("a trajectory is refused: too many wait already");
    }
}

fn run(
    heard: &Receiver<Word>,
    handle: &Handle,
    runtime: &Runtime,
    mut told: Vec<Told>,
    _subscription: Subscription,
    _node: Arc<Node>,
) {
    let (mut body, mut due) = (Encoder::new(), Instant::now());
    loop {
        match heard.recv_timeout(due.saturating_duration_since(Instant::now())) {
            Ok(Word::Targets(targets)) => {
                for (joint, target) in targets {
                    move_to(handle, runtime, joint, target);
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                due = Instant::now() + TOLD;
                for (joint, told) in handle.snapshot().joints.iter().zip(&mut told) {
                    tell(joint, told, &mut body);
                }
            }
            Ok(Word::End) | Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

fn move_to(handle: &Handle, runtime: &Runtime, joint: String, target: f64) {
    let request = Request::Move {
        joint: joint.clone(),
        target,
        shaper: None,
    };
    match runtime.block_on(handle.ask(request)) {
        Ok(_) => tracing::info!(joint, target, "a trajectory became a move"),
        Err(error) => tracing::warn!(joint, target, "a trajectory is refused: {error}"),
    }
}

fn tell(joint: &JointSnapshot, told: &mut Told, body: &mut Encoder) {
    let Some(mode) = joint.mode else { return };
    let estimate = joint.estimate.as_ref();
    let of = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let values = [
        mode.frequency_hz,
        mode.damping_ratio,
        of(estimate.map(|estimate| estimate.frequency_hz)),
        of(estimate.map(|estimate| estimate.frequency_std_hz)),
        of(estimate.map(|estimate| estimate.damping_ratio)),
        of(estimate.map(|estimate| estimate.damping_ratio_std)),
        f64::from(estimate.is_some_and(|estimate| estimate.converged)),
    ];
    put(&mut told.mode, &[(MODE, values.len())], &values, body);
    let impulses = joint.train.numbers();
    put(
        &mut told.impulses,
        &joint.train.dimensions(),
        &impulses,
        body,
    );
    let modes = joint.learning.numbers();
    put(&mut told.modes, &joint.learning.dimensions(), &modes, body);
}

fn put(
    publisher: &mut Publisher,
    dimensions: &[(&str, usize)],
    numbers: &[f64],
    body: &mut Encoder,
) {
    body.clear();
    body.float64_multi_array(dimensions, numbers);
    publisher.put(body.bytes());
}
