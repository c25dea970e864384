//! A robot over UDP with a clock of its own: as many steps and datagrams as control periods lie between
//! two setpoints, so that a machine that is busy slows it down and does not disturb it. Some datagrams
//! are lost, doubled, or come late.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use quell::service::between::between;
use quell_shapers::Setpoint;
use serde::Deserialize;

/// A setpoint as the robot receives it.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Received {
    pub seq: u64,
    /// Instant on the service's clock, s.
    pub t: f64,
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

/// Goes by the stamps of the setpoints, from one to the next, so that a time without them is a longer
/// step and nothing else.
#[derive(Default)]
struct Playback {
    last: Option<(f64, Setpoint)>,
    /// Waits in succession that brought nothing.
    waits: u32,
}

impl Playback {
    /// The commands of the steps up to a setpoint. Where none has come for long it holds the last one.
    fn next(&mut self, setpoint: Option<Received>, period: f64) -> Vec<Command> {
        let Some(received) = setpoint else {
            self.waits += 1;
            let (_, held) = self.last.unwrap_or_default();
            let holds = self.last.is_none() || self.waits > 10;
            return Vec::from_iter(holds.then_some(command(held)));
        };
        let to = Setpoint {
            position: received.position,
            velocity: received.velocity,
            acceleration: received.acceleration,
        };
        let before = self.last.replace((received.t, to));
        self.waits = 0;
        let (since, from) = before.unwrap_or((received.t - period, to));
        let steps = ((received.t - since) / period).round().max(1.0);
        // After a longer time the motion begins anew.
        let steps = if steps > 21.0 { 1.0 } else { steps };
        (1..=steps as usize)
            .map(|k| command(between([from, to], k as f64 / steps, steps * period)))
            .collect()
    }
}

fn command(setpoint: Setpoint) -> Command {
    Command {
        position: setpoint.position,
        velocity: Some(setpoint.velocity),
    }
}

/// The fault of its sensor of the link.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// It repeats itself.
    Stuck = 1,
    /// It reads somewhere else, now and then.
    Jumps,
    /// It says nothing.
    Dead,
}

/// The setpoints that the robot is sent.
#[derive(Default)]
struct Orders {
    ending: AtomicBool,
    silent: AtomicBool,
    fault: AtomicU8,
}

pub struct UdpRobot {
    pub received: Arc<Mutex<Vec<Received>>>,
    orders: Arc<Orders>,
    socket: UdpSocket,
    thread: Option<JoinHandle<()>>,
}

impl UdpRobot {
    /// A robot that speaks to a service at `address`, stepped by `period` (s) a setpoint.
    pub fn start(address: SocketAddr, period: f64) -> Self {
        let received = Arc::new(Mutex::new(Vec::new()));
        let orders: Arc<Orders> = Arc::default();
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
        let own = socket.try_clone().expect("a socket");
        let (log, told) = (Arc::clone(&received), Arc::clone(&orders));
        let thread = std::thread::spawn(move || run(&own, address, period, &log, &told));
        Self {
            received,
            orders,
            socket,
            thread: Some(thread),
        }
    }

    /// From now on it says nothing, or speaks again.
    pub fn be_silent(&self, silent: bool) {
        self.orders.silent.store(silent, Relaxed);
    }

    /// From now on its sensor of the link fails, or is whole again.
    pub fn fail(&self, fault: Option<Fault>) {
        let fault = fault.map_or(0, |fault| fault as u8);
        self.orders.fault.store(fault, Relaxed);
    }

    /// Sends something else from its address.
    pub fn send(&self, datagram: &[u8], address: SocketAddr) {
        // What the system does not take was not sent.
        let _ = self.socket.send_to(datagram, address);
    }

    pub fn last(&self) -> Option<Received> {
        self.received.lock().expect("no panic").last().copied()
    }
}

impl Drop for UdpRobot {
    fn drop(&mut self) {
        self.orders.ending.store(true, Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

fn run(
    socket: &UdpSocket,
    address: SocketAddr,
    period: f64,
    log: &Mutex<Vec<Received>>,
    orders: &Orders,
) {
    let wait = Some(Duration::from_millis(5));
    socket.set_read_timeout(wait).expect("a timeout");
    let arm = ArmSimulation::new(&Robot::rx170(), 0, &SimulationOptions::default());
    let mut arm = arm.expect("an arm");
    let mut playback = Playback::default();
    let (mut buffer, mut step, mut held) = ([0; 512], 0u64, None);
    let mut stuck = None;
    while !orders.ending.load(Relaxed) {
        let setpoint = socket.recv_from(&mut buffer).ok().map(|(length, _)| {
            serde_json::from_slice::<Received>(&buffer[..length]).expect("JSON")
        });
        if let Some(setpoint) = setpoint {
            log.lock().expect("no panic").push(setpoint);
        }
        for command in playback.next(setpoint, period) {
            arm.step(command, period);
            step += 1;
            let whole = arm.true_link_position();
            stuck =
                (orders.fault.load(Relaxed) == Fault::Stuck as u8).then(|| stuck.unwrap_or(whole));
            let link = match orders.fault.load(Relaxed) {
                fault if fault == Fault::Dead as u8 => String::new(),
                fault if fault == Fault::Jumps as u8 && step.is_multiple_of(7) => {
                    format!(",\"link_position\":{:e}", whole + 0.3)
                }
                _ => format!(",\"link_position\":{:e}", stuck.unwrap_or(whole)),
            };
            let datagram = format!(
                "{{\"t\":{:.6},\"joint\":\"joint_1\",\"motor_position\":{:e}{link}}}",
                // A clock of its own: started another day, and 50 ppm fast.
                86_412.5 + 1.00005 * arm.time(),
                arm.true_motor_position(),
            );
            if orders.silent.load(Relaxed) || step.is_multiple_of(50) {
                continue;
            }
            let send = |text: &str| {
                // Nobody listening is the service's matter.
                let _ = socket.send_to(text.as_bytes(), address);
            };
            match step % 100 {
                10 => held = Some(datagram),
                20 => {
                    send(&datagram);
                    send(&datagram);
                }
                30 => send("{\"t\": 1, \"joint\": \"joint_1\""),
                31 => send("{\"t\": 1, \"joint\": \"elbow\", \"motor_position\": 0}"),
                _ => {
                    send(&datagram);
                    held.take().iter().for_each(|late: &String| send(late));
                }
            }
        }
    }
}
