//! ROS 2 over Zenoh: joint states and accelerations in, positions of all joints out.
//!
//! Zenoh's threads decode messages, and the tick takes their values from a ring. Setpoints go over another ring
//! to a sending thread, since Zenoh may allocate and block.

mod bridge;
mod commands;
mod messages;
mod node;

pub use bridge::ZenohBridge;
pub use node::Node;

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use quell_shapers::Setpoint;
use rtrb::{Consumer, Producer, RingBuffer};
use zenoh::qos::Priority;

use super::intake::{Counts, Intake, Received, count};
use super::{INBOX, RobotLink};
use crate::recording::Encoder;
use crate::service::clock::ServiceClock;
use crate::service::config::{Config, ZenohConfig};
use crate::service::contract::{LinkHealth, Measured, Quantity};
use commands::{Commands, Positions};
use messages::{FLOAT64_MULTI_ARRAY, IMU, JOINT_STATE};
use node::{Publisher, Subscription};

/// Most commands that wait for the sending thread; older ones are of no use to a robot.
const WAITING: usize = 16;
/// Duration of one wait of the sending thread, so that it notices the end.
const WAIT: Duration = Duration::from_millis(50);

/// The tick's end of the link.
pub struct ZenohLink {
    ring: Consumer<Received>,
    counts: Arc<Counts>,
    _subscriptions: Vec<Subscription>,
    next: Commands,
    commands: Producer<Positions>,
    full: u64,
    sending: Arc<Sending>,
    sender: Option<JoinHandle<()>>,
}

/// State of the sending thread, and its counts.
#[derive(Default)]
struct Sending {
    ending: AtomicBool,
    sent: AtomicU64,
    failures: AtomicU64,
}

impl ZenohLink {
    /// Subscribes to the robot's topics, and starts the sending thread.
    ///
    /// # Errors
    /// The error of Zenoh or of the system.
    pub fn start(node: &Node, config: &Config, clock: ServiceClock) -> io::Result<Self> {
        let joints = config.joints.len();
        let (producer, ring) = RingBuffer::new(8 * INBOX * joints);
        let counts = Arc::new(Counts::default());
        let intake = Intake::new(joints, config.watchdog, producer, Arc::clone(&counts));
        let ears = Arc::new(Ears {
            names: config
                .joints
                .iter()
                .map(|joint| joint.name.clone())
                .collect(),
            intake: Mutex::new(intake),
            origin: ((clock.unix_time() - clock.now()) * 1e9) as i64,
            clock,
        });
        let subscriptions = subscriptions(node, &config.zenoh, &ears)?;
        let publisher = node.publisher(
            &config.zenoh.commands,
            &FLOAT64_MULTI_ARRAY,
            Priority::RealTime,
        )?;
        let (commands, waiting) = RingBuffer::new(WAITING);
        let sending = Arc::new(Sending::default());
        let shared = Arc::clone(&sending);
        let sender = std::thread::Builder::new()
            .name("quell-zenoh".into())
            .spawn(move || shared.run(waiting, publisher, joints))?;
        Ok(Self {
            ring,
            counts,
            _subscriptions: subscriptions,
            next: Commands::new(joints),
            commands,
            full: 0,
            sending,
            sender: Some(sender),
        })
    }
}

impl RobotLink for ZenohLink {
    fn receive(&mut self, _now: f64, inbox: &mut Vec<Measured>) {
        while inbox.len() < inbox.capacity()
            && let Ok(received) = self.ring.pop()
        {
            if let Received::Measured(measured) = received {
                if measured.quantity == Quantity::MotorPosition {
                    self.next.measure(measured.joint, measured.value[0]);
                }
                inbox.push(measured);
            }
        }
    }

    /// `std_msgs/Float64MultiArray` has no time stamp.
    fn carries_time(&self) -> bool {
        false
    }

    fn send(&mut self, _now: f64, joint: usize, setpoint: &Setpoint) {
        self.next.command(joint, setpoint.position);
    }

    fn flush(&mut self) {
        let Some(command) = self.next.take() else {
            return;
        };
        if self.commands.push(command).is_err() {
            self.full += 1;
        }
        if let Some(sender) = &self.sender {
            sender.thread().unpark();
        }
    }

    fn counters(&self) -> LinkHealth {
        LinkHealth {
            sent: self.sending.sent.load(Relaxed),
            send_failures: self.full + self.sending.failures.load(Relaxed),
            ..self.counts.counters()
        }
    }
}

impl Drop for ZenohLink {
    fn drop(&mut self) {
        self.sending.ending.store(true, Relaxed);
        if let Some(sender) = self.sender.take() {
            sender.thread().unpark();
            // If it panicked, that was reported when it did.
            let _ = sender.join();
        }
    }
}

impl Sending {
    fn run(&self, mut waiting: Consumer<Positions>, mut publisher: Publisher, joints: usize) {
        let mut body = Encoder::new();
        loop {
            while let Ok(command) = waiting.pop() {
                let positions = &command[..joints];
                let dimensions = [("joint", joints)];
                body.clear();
                body.float64_multi_array(&dimensions, positions);
                match publisher.put(body.bytes()) {
                    true => count(&self.sent, 1),
                    false => count(&self.failures, 1),
                }
            }
            // Checked after the ring is empty, so that the last setpoint is not lost.
            if self.ending.load(Relaxed) {
                return;
            }
            std::thread::park_timeout(WAIT);
        }
    }
}

/// The receiver of messages.
struct Ears {
    names: Vec<String>,
    intake: Mutex<Intake>,
    clock: ServiceClock,
    /// The service's time 0 on the robot's clock, if both clocks are the same, ns since 1970. Stamps are
    /// relative to it, so that they keep all their digits.
    origin: i64,
}

fn subscriptions(
    node: &Node,
    topics: &ZenohConfig,
    ears: &Arc<Ears>,
) -> io::Result<Vec<Subscription>> {
    let positions = |topic: &str, quantity: Quantity| {
        let ears = Arc::clone(ears);
        node.subscribe(topic, &JOINT_STATE, move |body| {
            ears.hear(|intake, now| ears.positions(body, quantity, intake, now))
        })
    };
    let names = &ears.names;
    let tip = topics.imu_joint.as_ref();
    let tip = tip.and_then(|joint| names.iter().position(|name| name == joint));
    let tip = tip.unwrap_or(names.len() - 1);
    let accelerated = Arc::clone(ears);
    Ok(vec![
        positions(&topics.joint_states, Quantity::MotorPosition)?,
        positions(&topics.link_states, Quantity::LinkPosition)?,
        node.subscribe(&topics.imu, &IMU, move |body| {
            accelerated.hear(|intake, now| accelerated.acceleration(body, tip, intake, now))
        })?,
    ])
}

impl Ears {
    /// Processes a message that arrives now, and counts it.
    fn hear(&self, take: impl FnOnce(&mut Intake, f64)) {
        // If another thread has panicked, that was reported.
        let Ok(mut intake) = self.intake.lock() else {
            return;
        };
        take(&mut intake, self.clock.now());
        intake.counts().finished();
    }

    fn positions(&self, body: &[u8], quantity: Quantity, intake: &mut Intake, now: f64) {
        let Some(message) = messages::joint_state(body) else {
            count(&intake.counts().malformed, 1);
            return;
        };
        let stamp = self.stamp(message.stamp);
        let mut known = false;
        for (name, position) in message.positions {
            if let Some(joint) = self.names.iter().position(|joint| joint == name) {
                known = true;
                let value = [position, 0.0, 0.0];
                intake.take(joint, stamp, std::iter::once((quantity, value)), now);
            }
        }
        count(&intake.counts().unknown_joint, u64::from(!known));
    }

    fn acceleration(&self, body: &[u8], joint: usize, intake: &mut Intake, now: f64) {
        let Some(message) = messages::imu(body) else {
            count(&intake.counts().malformed, 1);
            return;
        };
        let stamp = self.stamp(message.stamp);
        let measured = (Quantity::TipAcceleration, message.acceleration);
        intake.take(joint, stamp, std::iter::once(measured), now);
    }

    /// The stamp of a message, s; 0 if the sender sets none.
    fn stamp(&self, stamp: i64) -> Option<f64> {
        (stamp != 0).then(|| stamp.saturating_sub(self.origin) as f64 * 1e-9)
    }
}
