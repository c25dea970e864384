//! A robot over UDP with a clock of its own: one step and one datagram for each setpoint, so that a
//! machine that is busy slows it down and does not disturb it. Some datagrams are lost, doubled, or
//! come late.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use serde::Deserialize;

/// A setpoint as the robot receives it.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Received {
    pub seq: u64,
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
}

pub struct UdpRobot {
    pub received: Arc<Mutex<Vec<Received>>>,
    ending: Arc<AtomicBool>,
    silent: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl UdpRobot {
    /// A robot that speaks to a service at `address`, stepped by `period` (s) a setpoint.
    pub fn start(address: SocketAddr, period: f64) -> Self {
        let received = Arc::new(Mutex::new(Vec::new()));
        let (ending, silent) = (Arc::default(), Arc::default());
        let log = Arc::clone(&received);
        let (stop, mute) = (Arc::clone(&ending), Arc::clone(&silent));
        let thread = std::thread::spawn(move || run(address, period, &log, &stop, &mute));
        Self {
            received,
            ending,
            silent,
            thread: Some(thread),
        }
    }

    /// From now on it says nothing, or speaks again.
    pub fn be_silent(&self, silent: bool) {
        self.silent.store(silent, Relaxed);
    }

    pub fn last(&self) -> Option<Received> {
        self.received.lock().expect("no panic").last().copied()
    }
}

impl Drop for UdpRobot {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

fn run(
    address: SocketAddr,
    period: f64,
    log: &Mutex<Vec<Received>>,
    ending: &AtomicBool,
    silent: &AtomicBool,
) {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let wait = Some(Duration::from_millis(5));
    socket.set_read_timeout(wait).expect("a timeout");
    let arm = ArmSimulation::new(&Robot::rx170(), 0, &SimulationOptions::default());
    let mut arm = arm.expect("an arm");
    let mut command = Command {
        position: 0.0,
        velocity: Some(0.0),
    };
    let (mut buffer, mut step, mut held) = ([0; 512], 0u64, None);
    while !ending.load(Relaxed) {
        if let Ok((length, _)) = socket.recv_from(&mut buffer) {
            let setpoint: Received = serde_json::from_slice(&buffer[..length]).expect("JSON");
            log.lock().expect("no panic").push(setpoint);
            command.position = setpoint.position;
            command.velocity = Some(setpoint.velocity);
        }
        arm.step(command, period);
        step += 1;
        let datagram = format!(
            "{{\"t\":{:.6},\"joint\":\"joint_1\",\"motor_position\":{:e},\"link_position\":{:e}}}",
            // A clock of its own: started another day, and 50 ppm fast.
            86_412.5 + 1.00005 * arm.time(),
            arm.true_motor_position(),
            arm.true_link_position(),
        );
        if silent.load(Relaxed) || step.is_multiple_of(50) {
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
