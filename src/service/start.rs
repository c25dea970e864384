//! Starting and ending the service.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;

use nalgebra::{Isometry3, Unit, Vector3};
use quell_shapers::{Mode, ShaperError, UncertainMode};
use quell_trajectories::{PlanError, Planner};
use thiserror::Error;

use super::clock::{ServiceClock, unix_time};
use super::config::{Config, JointConfig, RobotKind};
use super::contract::{Handle, Snapshot, channels};
use super::disk::{Disk, FileSystem, FolderError};
use super::engine::{Engine, EngineParts, Joint, Registrar};
use super::features::{Companion, live_view, over_zenoh, telemetry};
use super::guard::Bounds;
use super::kept::Kept;
use super::link::{EmbeddedLink, RobotLink, UdpLink, UdpSettings};
use super::recorder::{Shelf, ShelfError};
use super::state::{State, StateFile};
use super::tick::{JointTick, Tick, TickThread, TickThreadSettings};
use crate::closed_loop::{ClosedLoopError, commission};
use crate::plant::{ArmSimulation, SimulationError, SimulationOptions};
use crate::signal::{Clock, DeformationSensor, JointArc};

/// Displacement of the embedded arm's commissioning move, rad: as `quell move`, 30 degrees or less.
const COMMISSIONING: f64 = 0.25;

/// Why the service does not start.
#[derive(Debug, Error)]
pub enum StartError {
    /// A socket or a thread.
    #[error("{what}: {error}")]
    System {
        /// What was tried.
        what: String,
        /// What the system says.
        error: io::Error,
    },
    /// The data folder is another service's, or not to be had.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The folder of recordings is not to be had.
    #[error(transparent)]
    Shelf(#[from] ShelfError),
    /// Something is asked for that is not part of this build.
    #[error("{feature} is not part of this build: cargo build --release --features {feature}")]
    NotBuilt {
        /// The feature that has it.
        feature: &'static str,
    },
    /// The embedded arm cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The embedded arm's tracker cannot be registered.
    #[error(transparent)]
    Commissioning(#[from] ClosedLoopError),
    /// There is no planner.
    #[error(transparent)]
    Planner(#[from] PlanError),
    /// A joint's belief cannot be shaped for at this rate.
    #[error("{joint}: {reason}")]
    Belief {
        /// The joint.
        joint: String,
        /// Why.
        reason: ShaperError,
    },
}

/// A service that runs.
pub struct Service {
    handle: Handle,
    udp: Option<SocketAddr>,
    foxglove: Option<SocketAddr>,
    companions: Vec<Box<dyn Send>>,
    ending: Arc<AtomicBool>,
    engine: Option<JoinHandle<()>>,
    shelf: Option<Arc<Shelf>>,
}

impl Service {
    /// What the outside holds of it.
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }

    /// What has been recorded, for the recorder; none where nothing is.
    pub fn shelf(&self) -> Option<Arc<Shelf>> {
        self.shelf.clone()
    }

    /// Where the UDP link listens, if there is one.
    pub fn udp_address(&self) -> Option<SocketAddr> {
        self.udp
    }

    /// Where the live view of Foxglove listens, if there is one.
    pub fn foxglove_address(&self) -> Option<SocketAddr> {
        self.foxglove
    }

    /// Brings every joint to a jerk-limited stop, keeps the state, and ends.
    pub fn stop(mut self) {
        self.end();
    }

    fn end(&mut self) {
        // First what asks for moves.
        self.companions.clear();
        self.ending.store(true, Relaxed);
        if let Some(engine) = self.engine.take() {
            // If it panicked, that was reported when it did.
            let _ = engine.join();
        }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        self.end();
    }
}

/// Starts the service: links, tick, engine. No request is lost from here on.
///
/// # Errors
/// [`StartError`] where something that the configuration asks for is not to be had.
pub fn start(config: Config) -> Result<Service, StartError> {
    let disk = Disk::of(&config.data, Arc::new(FileSystem))?;
    start_on(config, disk)
}

/// As [`start`], with the data folder on a disk that is open.
///
/// # Errors
/// As [`start`].
pub fn start_on(config: Config, disk: Disk) -> Result<Service, StartError> {
    let clock = ServiceClock::start();
    let Kept { shelf, file, state } = Kept::open(&config, &disk)?;
    let robot = robot(&config, clock)?;
    if config.robot != RobotKind::Embedded {
        config.joints.iter().for_each(JointConfig::warn_of_limits);
    }
    let joints: Vec<_> = config
        .joints
        .iter()
        .map(|joint| made(joint, &config, &robot, &state))
        .collect::<Result<_, _>>()?;
    let timeout = config.watchdog.as_secs_f64();
    let ticks = joints.iter().enumerate().map(|(index, joint)| {
        let registered = robot.sensor.is_some();
        JointTick::new(index, bounds(joint), timeout, joint.adaptation, registered)
    });
    let (tick, rings) = Tick::new(ticks.collect(), robot.link, config.period);
    let (handle, ends) = channels(Snapshot {
        version: env!("CARGO_PKG_VERSION"),
        robot: config.robot.name(),
        ..Snapshot::default()
    });
    let names: Vec<_> = config
        .joints
        .iter()
        .map(|joint| joint.name.clone())
        .collect();
    let (foxglove, nats) = (config.foxglove, config.nats.clone());
    let (saver, states) = channel();
    let real_time = config.real_time;
    let engine = Engine::new(EngineParts {
        config,
        clock,
        ends,
        rings,
        joints,
        arm: robot.arm,
        state,
        saver,
        disk,
        planner: Planner::new(1)?,
    });
    let settings = TickThreadSettings { real_time };
    let tick = TickThread::start(tick, clock, settings);
    let tick = tick.map_err(|error| system("the tick's thread", error))?;
    let ending = Arc::new(AtomicBool::new(false));
    let engine = run(engine, tick, (file, states), Arc::clone(&ending));
    let engine = engine.map_err(|error| system("the engine's thread", error))?;
    let mut service = Service {
        handle,
        udp: robot.udp,
        foxglove: None,
        companions: Vec::new(),
        ending,
        engine: Some(engine),
        shelf,
    };
    if let Some(companion) = robot.companion {
        let companion = companion(service.handle());
        let companion = companion.map_err(|error| system("the robot's requests", error))?;
        service.companions.push(companion);
    }
    if let Some(address) = foxglove {
        let (address, view) = live_view(address, &names, &service.handle, clock)?;
        service.foxglove = Some(address);
        service.companions.push(view);
    }
    if let Some(nats) = &nats {
        service.companions.push(telemetry(nats, &service.handle)?);
    }
    Ok(service)
}

/// The engine's thread, which outlives neither tick nor keeper of states.
fn run(
    engine: Engine,
    tick: TickThread,
    (file, states): (StateFile, Receiver<State>),
    ending: Arc<AtomicBool>,
) -> io::Result<JoinHandle<()>> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()?;
    let keeper = std::thread::Builder::new()
        .name("quell-state".into())
        .spawn(move || file.keep(&states))?;
    std::thread::Builder::new()
        .name("quell-engine".into())
        .spawn(move || {
            runtime.block_on(engine.run(&ending));
            drop(tick);
            // The engine is gone, and with it the sender: the keeper has written the last state.
            let _ = keeper.join();
        })
}

/// The robot's link, and what goes with it.
struct RobotParts {
    link: Box<dyn RobotLink>,
    udp: Option<SocketAddr>,
    arm: Option<ArmSimulation>,
    sensor: Option<DeformationSensor>,
    companion: Option<Companion>,
}

fn robot(config: &Config, clock: ServiceClock) -> Result<RobotParts, StartError> {
    match config.robot {
        RobotKind::Embedded => embedded(config),
        RobotKind::Udp => {
            let settings = UdpSettings {
                address: config.udp,
                robot: config.udp_robot,
                joints: config
                    .joints
                    .iter()
                    .map(|joint| joint.name.clone())
                    .collect(),
                watchdog: config.watchdog,
                key: config.udp_key.clone(),
            };
            let link = UdpLink::start(settings, clock);
            let link = link.map_err(|error| system(config.udp, error))?;
            Ok(RobotParts {
                udp: link.address().ok(),
                link: Box::new(link),
                arm: None,
                sensor: None,
                companion: None,
            })
        }
        RobotKind::Zenoh => {
            let (link, companion) = over_zenoh(config, clock)?;
            Ok(RobotParts {
                link,
                udp: None,
                arm: None,
                sensor: None,
                companion: Some(companion),
            })
        }
    }
}

/// The arm, its tracker registered by a slow move that takes no time.
fn embedded(config: &Config) -> Result<RobotParts, StartError> {
    let joint = &config.joints[0];
    let options = SimulationOptions {
        seed: 1,
        ..SimulationOptions::default()
    };
    let mut arm = ArmSimulation::new(&config.description, joint.index, &options)?;
    let registration = commission(&mut arm, COMMISSIONING, joint.limits)?;
    let (frame, clock) = (registration.sensor_to_base, registration.clock);
    Ok(RobotParts {
        sensor: Some(DeformationSensor::new(*arm.arc(), frame, clock)),
        link: Box::new(EmbeddedLink::new(arm.clone(), config.period)),
        udp: None,
        arm: Some(arm),
        companion: None,
    })
}

fn made(
    joint: &JointConfig,
    config: &Config,
    robot: &RobotParts,
    state: &State,
) -> Result<Joint, StartError> {
    let arc = joint.arc.unwrap_or_else(unit_arc);
    let sensor = robot.sensor.clone();
    let own = DeformationSensor::new(arc, Isometry3::identity(), Clock::REFERENCE);
    let remembered = state
        .joints
        .get(&joint.name)
        .and_then(|state| state.with_payload(0.0));
    let learned = remembered.and_then(|learned| Mode::try_from(learned.mode).ok());
    let designed = |mode: Mode| {
        let known = UncertainMode::believed(mode);
        joint.shaper.on_grid_for(&known, config.period)
    };
    let usable = learned.filter(|mode| designed(*mode).is_ok());
    let mode = usable.unwrap_or(joint.belief);
    designed(mode).map_err(|reason| StartError::Belief {
        joint: joint.name.clone(),
        reason,
    })?;
    let since = match (usable, remembered) {
        (Some(_), Some(remembered)) => remembered.unix_time_s,
        _ => unix_time(),
    };
    Ok(Joint {
        sensor: sensor.unwrap_or(own),
        arc_known: joint.arc.is_some(),
        shaper: joint.shaper,
        shaping: joint.shaping,
        adaptation: joint.adaptation,
        mode,
        wanted_mode: None,
        mode_since: since,
        train_due: false,
        retunes: 0,
        before: [0; 3],
        report: None,
        position: 0.0,
        began: false,
        stopped_by_watchdog: false,
        stop_due: false,
        running: None,
        asked: None,
        standstill: Default::default(),
        motor: None,
        registrar: robot.sensor.is_none().then(Registrar::default),
        config: joint.clone(),
    })
}

/// An arc for a joint whose tip is not known: its lengths are never told.
fn unit_arc() -> JointArc {
    let axis = Unit::new_unchecked(Vector3::z());
    JointArc::new(nalgebra::Point3::origin(), axis, Vector3::x())
}

fn bounds(joint: &Joint) -> Bounds {
    Bounds {
        limits: joint.config.limits,
        radius: joint.config.arc.map_or(f64::INFINITY, |arc| arc.radius()),
        deformation: joint.config.deformation_range,
        resolution: joint.config.encoder_resolution,
    }
}

fn system(what: impl std::fmt::Display, error: io::Error) -> StartError {
    StartError::System {
        what: what.to_string(),
        error,
    }
}
