//! A station stepped by hand: a simulated clock, a robot that says what it is told to, and what it received.

use std::net::SocketAddr;
use std::path::Path;
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use super::plant::Plant;
use quell::service::clock::{ServiceClock, SimulatedTime};
use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::contract::{
    Accepted, Handle, JointSnapshot, LinkHealth, Measured, Request, ServiceError, Snapshot,
};
use quell::service::disk::Disk;
use quell::service::link::{Ear, Heard, RobotLink, UdpSettings};
use quell::service::station::{RobotParts, Station};
use quell_shapers::Setpoint;
use quell_trajectories::Limits;

pub const PERIOD: f64 = 0.004;
pub const WATCHDOG: f64 = 0.06;
/// So fast that a move takes some hundred ticks.
pub const LIMITS: Limits = Limits {
    velocity: 2.0,
    acceleration: 30.0,
    jerk: 600.0,
};

/// The way of a stop from the greatest velocity, rad.
pub fn stopping() -> f64 {
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = LIMITS;
    0.5 * velocity * (velocity / acceleration + acceleration / jerk)
}

/// A motor side that stands still for so many ticks is commanded.
pub const STANDSTILL: usize = 80;
pub const ROBOT: SocketAddr =
    SocketAddr::new(std::net::IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), 40_000);

/// The setpoints that the robot received, with the time of the tick that they were sent at, s.
pub type Sent = (f64, Setpoint);

/// A link whose other end is in this process.
struct Wire {
    heard: Heard,
    sent: Arc<Mutex<Vec<Sent>>>,
    timed: bool,
}

impl RobotLink for Wire {
    fn receive(&mut self, _now: f64, inbox: &mut Vec<Measured>) {
        self.heard.receive(inbox);
    }

    fn carries_time(&self) -> bool {
        self.timed
    }

    fn send(&mut self, now: f64, _joint: usize, setpoint: &Setpoint) {
        self.sent.lock().expect("no panic").push((now, *setpoint));
    }

    fn counters(&self) -> LinkHealth {
        self.heard.counters()
    }
}

/// A robot whose motor side follows at once, and what it is doing.
#[derive(Default)]
pub struct Robot {
    /// One that rings, and says so.
    pub arm: Option<Plant>,
    deformation: Option<f64>,
    /// The sensor of its deformation has a number every so many samples; 0 is always.
    pub sees_every: usize,
    spoken: usize,
    /// Time of the one that rings, s.
    pub time: f64,
    pub position: f64,
    pub silent: bool,
    /// Time constant with which it follows, s.
    pub lag: f64,
    /// Switched off, it does not follow.
    pub off: bool,
    /// Its clock minus the service's, s.
    pub ahead: f64,
    /// The messages that it has said and those on their way still.
    held: Vec<String>,
    /// So many datagrams go out later, in one.
    pub holds: usize,
    /// So many are not believed, its clock having started anew.
    unbelieved: usize,
}

impl Robot {
    /// A control period after a setpoint.
    fn follow(&mut self, setpoint: Setpoint) {
        let Some(arm) = &mut self.arm else {
            let share = 1.0 - (-PERIOD / self.lag).exp();
            self.position += share * (setpoint.position - self.position);
            return;
        };
        let heard = arm.step(setpoint.position, setpoint.velocity);
        (self.position, self.deformation) = (heard.motor, heard.deformation);
        self.time = heard.time;
    }
}

/// A request, and who waits for its answer.
pub struct Asked {
    pub request: Request,
    /// How many were asked before.
    pub number: usize,
    /// When, s.
    pub at: f64,
    answer: Pin<Box<dyn Future<Output = Result<Accepted, ServiceError>>>>,
}

/// A request that was answered.
pub struct Answered {
    pub request: Request,
    /// How many were asked before.
    pub number: usize,
    /// When it was asked, s.
    pub at: f64,
    pub answer: Result<Accepted, ServiceError>,
}

pub fn config(data: &Path) -> Config {
    let overrides = Overrides {
        robot: Some(RobotKind::Udp),
        data: Some(data.to_path_buf()),
        rate: Some(1.0 / PERIOD),
        ..Overrides::default()
    };
    let mut config = Config::load(None, &overrides).expect("defaults");
    config.watchdog = Duration::from_secs_f64(WATCHDOG);
    config.joints[0].limits = LIMITS;
    config
}

pub struct World {
    pub station: Station,
    pub handle: Handle,
    pub clock: ServiceClock,
    pub time: SimulatedTime,
    pub robot: Robot,
    /// Ticks until the engine works again.
    pub engine_sleeps: usize,
    /// When the robot was heard last, s.
    pub heard: f64,
    ear: Ear,
    sent: Arc<Mutex<Vec<Sent>>>,
    asked: Vec<Asked>,
    count: usize,
}

impl World {
    /// A service that starts while the wall shows `unix_time`, and a robot that stands at `position`.
    pub fn start(config: Config, unix_time: f64, position: f64, timed: bool) -> Self {
        Self::start_on(Disk::default(), config, unix_time, position, timed)
    }

    /// The same over a data folder on this disk.
    pub fn start_on(
        disk: Disk,
        config: Config,
        unix_time: f64,
        position: f64,
        timed: bool,
    ) -> Self {
        let (clock, time) = ServiceClock::simulated(unix_time);
        let (ear, heard) = Ear::new(UdpSettings {
            address: ROBOT,
            robot: None,
            joints: vec!["joint_1".into()],
            watchdog: config.watchdog,
            key: None,
        });
        let sent: Arc<Mutex<Vec<Sent>>> = Arc::default();
        let wire = Wire {
            heard,
            sent: Arc::clone(&sent),
            timed,
        };
        let robot = RobotParts::over(Box::new(wire));
        let station = Station::assemble(config, clock.clone(), robot, disk).expect("a station");
        Self::over(station, clock, time, (ear, sent), position)
    }

    /// A service with the embedded arm. What it is sent is not seen.
    pub fn embedded(config: Config) -> Self {
        let (clock, time) = ServiceClock::simulated(1e9);
        let robot = RobotParts::embedded(&config).expect("an arm");
        let settings = UdpSettings {
            address: ROBOT,
            robot: None,
            joints: Vec::new(),
            watchdog: config.watchdog,
            key: None,
        };
        let disk = Disk::default();
        let station = Station::assemble(config, clock.clone(), robot, disk).expect("a station");
        let (ear, _) = Ear::new(settings);
        let mut world = Self::over(station, clock, time, (ear, Arc::default()), 0.0);
        world.robot.silent = true;
        world
    }

    fn over(
        station: Station,
        clock: ServiceClock,
        time: SimulatedTime,
        (ear, sent): (Ear, Arc<Mutex<Vec<Sent>>>),
        position: f64,
    ) -> Self {
        Self {
            handle: station.handle(),
            station,
            clock,
            time,
            robot: Robot {
                position,
                ahead: 86_412.5,
                ..Robot::default()
            },
            engine_sleeps: 0,
            heard: 0.0,
            ear,
            sent,
            asked: Vec::new(),
            count: 0,
        }
    }

    /// One whose joint is commanded.
    pub fn commanded(config: Config, timed: bool) -> Self {
        let mut world = Self::start(config, 1e9, 0.0, timed);
        for _ in 0..STANDSTILL {
            world.step();
        }
        assert!(!world.sent().is_empty(), "the joint is commanded");
        world.enable();
        let enabled = world.step();
        assert!(enabled.iter().all(|one| one.answer.is_ok()));
        world.count = 0;
        world
    }

    /// Takes a fault back, if there is one, and lets moves begin.
    pub fn enable(&mut self) {
        self.ask(Request::Reset);
        self.ask(Request::Enable);
    }

    /// A control period: the robot speaks, the tick runs, the engine works, answers are heard.
    pub fn step(&mut self) -> Vec<Answered> {
        self.speak();
        let before = self.sent.lock().expect("no panic").len();
        self.station.beat();
        if let Some((_, last)) = self.sent.lock().expect("no panic")[before..].last()
            && !self.robot.off
        {
            self.robot.follow(*last);
        }
        match self.engine_sleeps {
            0 => self.station.work(),
            _ => self.engine_sleeps -= 1,
        }
        self.answers()
    }

    /// The engine works while the tick is stuck.
    pub fn work(&mut self) -> Vec<Answered> {
        self.station.work();
        self.answers()
    }

    /// Steps, and gives every answer.
    pub fn steps(&mut self, count: usize) -> Vec<Answered> {
        (0..count).flat_map(|_| self.step()).collect()
    }

    fn speak(&mut self) {
        if self.robot.silent {
            return;
        }
        let now = self.clock.now();
        self.robot.spoken += 1;
        let sees = self
            .robot
            .spoken
            .is_multiple_of(self.robot.sees_every.max(1));
        let deformation = self.robot.deformation.map(|value| match sees {
            true => format!(",\"deformation\":{value:e}"),
            false => ",\"deformation\":NaN".into(),
        });
        self.robot.held.push(format!(
            "{{\"t\":{:.6},\"joint\":\"joint_1\",\"motor_position\":{:e}{}}}",
            now + self.robot.ahead,
            self.robot.position,
            deformation.unwrap_or_default(),
        ));
        if self.robot.holds > 0 {
            self.robot.holds -= 1;
            return;
        }
        for datagram in self.robot.held.drain(..) {
            self.ear.hear(datagram.as_bytes(), ROBOT, now);
            match self.robot.unbelieved {
                0 => self.heard = now,
                _ => self.robot.unbelieved -= 1,
            }
        }
    }

    /// The robot's clock starts anew: it takes some stamps until that is believed.
    pub fn restart_robot_clock(&mut self) {
        self.set_robot_clock(1e4);
    }

    /// The robot's clock leaps by so much, s.
    pub fn set_robot_clock(&mut self, leap: f64) {
        self.robot.ahead += leap;
        self.robot.unbelieved = 8;
    }

    /// Something comes from the robot's address.
    pub fn hear(&mut self, bytes: &[u8]) {
        self.ear.hear(bytes, ROBOT, self.clock.now());
    }

    pub fn ask(&mut self, request: Request) {
        let (handle, own) = (self.handle.clone(), request.clone());
        let mut answer: Asked = Asked {
            request,
            number: self.count,
            at: self.clock.now(),
            answer: Box::pin(async move { handle.ask(own).await }),
        };
        self.count += 1;
        // The request goes out when it is polled first.
        let poll = answer.poll();
        assert!(poll.is_pending(), "the engine has not worked since");
        self.asked.push(answer);
    }

    pub fn go(&mut self, target: f64) {
        self.ask(Request::Move {
            joint: "joint_1".into(),
            target,
            shaper: None,
        });
    }

    /// All clients close their connections: nobody waits for an answer.
    pub fn give_up(&mut self) {
        self.asked.clear();
    }

    /// Requests that wait for their answers.
    pub fn waiting(&self) -> &[Asked] {
        &self.asked
    }

    fn answers(&mut self) -> Vec<Answered> {
        let mut answered = Vec::new();
        for mut asked in std::mem::take(&mut self.asked) {
            match asked.poll() {
                Poll::Pending => self.asked.push(asked),
                Poll::Ready(answer) => answered.push(Answered {
                    request: asked.request,
                    number: asked.number,
                    at: asked.at,
                    answer,
                }),
            }
        }
        answered
    }

    /// Time goes by without a tick; the robot speaks on.
    pub fn miss(&mut self, ticks: usize) {
        for _ in 0..ticks {
            self.speak();
            self.time.advance_to(self.clock.now() + PERIOD);
        }
    }

    pub fn sent(&self) -> Vec<Sent> {
        self.sent.lock().expect("no panic").clone()
    }

    pub fn last(&self) -> Option<Sent> {
        self.sent.lock().expect("no panic").last().copied()
    }

    pub fn snapshot(&self) -> Arc<Snapshot> {
        self.handle.snapshot()
    }

    pub fn joint(&self) -> JointSnapshot {
        self.snapshot().joints[0].clone()
    }
}

impl Asked {
    fn poll(&mut self) -> Poll<Result<Accepted, ServiceError>> {
        let mut context = Context::from_waker(Waker::noop());
        self.answer.as_mut().poll(&mut context)
    }
}

/// The first fault of setpoints in succession, in words.
pub fn first_beyond_limits(sent: &[Sent], timed: bool) -> Option<String> {
    let mut pairs = sent.windows(2);
    pairs.find_map(|pair| beyond_limits(pair[0], pair[1], timed))
}

/// How far a position between two samples (`AxisState::between`) may be beside a plan of bounded jerk `j`, in `j h^3`: the
/// greatest integral of the absolute Peano kernel of the quintic Hermite interpolation, which is at half the period.
const QUINTIC: f64 = 0.006_185;

/// The fault of two setpoints in succession that no plan within the limits makes, in words.
pub fn beyond_limits(before: Sent, now: Sent, timed: bool) -> Option<String> {
    use quell::service::bridged::bridged;
    let allowed = 1.0 + 1e-9;
    let apart = ((now.0 - before.0) / PERIOD).round();
    let stood = apart as u64 > bridged(PERIOD) + 1;
    let gone = if timed { apart * PERIOD } else { PERIOD };
    let (from, to) = (before.1, now.1);
    let way = to.position - from.position;
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = LIMITS;
    let too_much = |what: &str, value: f64, most: f64| {
        (value.abs() > most)
            .then(|| format!("{what} {value:e}, {most:e} allowed: {before:?} {now:?}"))
    };
    too_much("velocity", to.velocity, velocity * allowed)
        .or_else(|| too_much("acceleration", to.acceleration, acceleration * allowed))
        .or_else(|| match stood {
            true => too_much("step after a gap", way, jerk * PERIOD.powi(3)),
            false => {
                let change = (to.acceleration - from.acceleration) / gone;
                let mean = 0.5 * (from.velocity + to.velocity);
                // The trapezoidal rule's error where the jerk is bounded, and those of velocities and of the two
                // positions between two samples.
                let parts = 1.0 / 12.0 + 1.0 / 8.0 + 2.0 * QUINTIC;
                let bound = jerk * gone.powi(3) * parts * allowed + 1e-13;
                too_much("jerk", change, jerk * allowed + 1e-6)
                    .or_else(|| too_much("jump", way - gone * mean, bound))
            }
        })
}
