//! The service without its threads: links, tick, engine and stored data, assembled.
//!
//! [`start`](super::start()) runs a station on threads with the system's clock. A test runs one step by step,
//! with a simulated clock and a link of its own.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::channel;

use nalgebra::Isometry3;
use quell_shapers::{Mode, ShaperError, UncertainMode};
use quell_trajectories::{PlanError, Planner};
use thiserror::Error;

use super::clock::ServiceClock;
use super::config::{Config, JointConfig};
use super::contract::{Handle, Snapshot, channels};
use super::disk::{Disk, FolderError};
use super::engine::{Engine, EngineParts, Hearing, Joint, Learning, Registrar, longest_train};
use super::guard::Bounds;
use super::keeper::Keeper;
use super::kept::Kept;
use super::learners::{Learners, Pupil};
use super::link::{EmbeddedLink, RobotLink};
use super::recorder::{Shelf, ShelfError};
use super::state::State;
use super::tick::{JointTick, Pulse, Tick, Watchdog};
use crate::adaptation::AdaptationSettings;
use crate::closed_loop::{ClosedLoopError, commission};
use crate::learning::{Inertia, LearnerSettings};
use crate::plant::{ArmSimulation, SimulationError, SimulationOptions};
use crate::signal::{Clock, DeformationSensor};

#[cfg(test)]
mod range_fault;

/// Displacement of the embedded arm's commissioning move, rad: as `quell move`, 30 degrees or less.
const COMMISSIONING: f64 = 0.25;

/// Why the service does not start.
#[derive(Debug, Error)]
pub enum StartError {
    /// A socket or a thread.
    #[error("{what}: {error}")]
    System {
        /// The attempt.
        what: String,
        /// The system's error.
        error: io::Error,
    },
    /// The data folder is in use by another service, or not available.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The folder of recordings is not available.
    #[error(transparent)]
    Shelf(#[from] ShelfError),
    /// A requested feature is not part of this build.
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

/// The robot: its link and, if it is simulated, its model.
pub struct RobotParts {
    /// The link.
    pub link: Box<dyn RobotLink>,
    /// The embedded arm in its initial state.
    arm: Option<ArmSimulation>,
    /// The sensor of its tip, registered.
    sensor: Option<DeformationSensor>,
}

impl RobotParts {
    /// A robot with a link only.
    pub fn over(link: Box<dyn RobotLink>) -> Self {
        let (arm, sensor) = (None, None);
        Self { link, arm, sensor }
    }

    /// The arm, with its tracker registered by a simulated slow move.
    ///
    /// # Errors
    /// [`StartError`] where it cannot be simulated or registered.
    pub fn embedded(config: &Config) -> Result<Self, StartError> {
        let joint = &config.joints[0];
        let options = SimulationOptions {
            seed: 1,
            ..SimulationOptions::default()
        };
        let mut arm = ArmSimulation::new(&config.description, joint.index, &options)?;
        let registration = commission(&mut arm, COMMISSIONING, joint.limits)?;
        let (frame, clock) = (registration.sensor_to_base, registration.clock);
        Ok(Self {
            sensor: Some(DeformationSensor::new(*arm.arc(), frame, clock)),
            link: Box::new(EmbeddedLink::new(arm.clone(), config.period)),
            arm: Some(arm),
        })
    }
}

/// All parts of the service, not yet running.
pub struct Station {
    /// Tick and clock.
    pub(super) pulse: Pulse,
    pub(super) engine: Engine,
    pub(super) keeper: Keeper,
    pub(super) learners: Learners,
    handle: Handle,
    shelf: Option<Arc<Shelf>>,
}

impl Station {
    /// Assembles everything on top of the data folder, which is on `disk`.
    ///
    /// # Errors [`StartError`] where something in the configuration is not available.
    pub fn assemble(
        config: Config,
        clock: ServiceClock,
        robot: RobotParts,
        disk: Disk,
    ) -> Result<Self, StartError> {
        let disk = disk.on_clock(clock.clone());
        let Kept { shelf, file, state } = Kept::open(&config, &disk)?;
        let joints: Vec<_> = config
            .joints
            .iter()
            .map(|joint| made(joint, &config, &robot, &state, &clock))
            .collect::<Result<_, _>>()?;
        let watchdog = Watchdog {
            timeout: config.watchdog.as_secs_f64(),
            stops: config.watchdog_stops,
        };
        let ticks = joints.iter().enumerate().map(|(index, joint)| {
            let registered = robot.sensor.is_some();
            JointTick::new(index, bounds(joint), watchdog, joint.adaptation, registered)
                .following_within(joint.config.following_limit, config.period)
                .ranging_within(joint.config.range, config.period)
        });
        let (tick, rings) = Tick::new(ticks.collect(), robot.link, config.period);
        let (handle, ends) = channels(Snapshot {
            version: env!("CARGO_PKG_VERSION"),
            robot: config.robot.name(),
            ..Snapshot::default()
        });
        let pupils = joints
            .iter()
            .map(|joint| pupil(&joint.config, &config, &state));
        let (learners, lessons) = Learners::new(pupils.collect::<Result<_, _>>()?);
        let (saver, states) = channel();
        Ok(Self {
            pulse: Pulse::new(tick, clock.clone()),
            keeper: Keeper::new(file, states, clock.clone()),
            engine: Engine::new(EngineParts {
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
                lessons,
            }),
            learners,
            handle,
            shelf,
        })
    }

    /// A handle for requests and state.
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }

    /// The shelf of the recordings; `None` if recording is off.
    pub fn shelf(&self) -> Option<Arc<Shelf>> {
        self.shelf.clone()
    }

    /// Runs the tick that is due next.
    pub fn beat(&mut self) {
        self.pulse.beat();
    }

    /// Lets the engine do its pending work, and saves what it has learned.
    pub fn work(&mut self) {
        self.engine.work();
        self.learners.work();
        self.keeper.work();
    }

    /// Lets the engine answer pending requests only: requests arrive between its rounds.
    pub fn answer(&mut self) {
        self.engine.answer_all();
    }
}

fn made(
    joint: &JointConfig,
    config: &Config,
    robot: &RobotParts,
    state: &State,
    clock: &ServiceClock,
) -> Result<Joint, StartError> {
    let sensor = robot.sensor.clone();
    let own = match joint.arc {
        Some(arc) => DeformationSensor::new(arc, Isometry3::identity(), Clock::REFERENCE),
        None => DeformationSensor::without_arc(Clock::REFERENCE),
    };
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
        _ => clock.unix_time(),
    };
    Ok(Joint {
        sensor: sensor.unwrap_or(own),
        shaper: joint.shaper,
        shaping: joint.shaping,
        adaptation: joint.adaptation,
        mode,
        wanted_mode: None,
        mode_since: since,
        train_due: false,
        rings_until: f64::NEG_INFINITY,
        retunes: 0,
        before: [0; 3],
        report: None,
        commanded: None,
        position: 0.0,
        began: false,
        hearing: Hearing::Heard,
        stop_due: false,
        running: None,
        asked: None,
        jog: None,
        ordered: Vec::new(),
        change: None,
        standstill: Default::default(),
        learning: Learning::default(),
        motor: None,
        registrar: robot.sensor.is_none().then(Registrar::default),
        config: joint.clone(),
    })
}

/// A joint that learns from its moves, with the knowledge that was saved.
fn pupil(joint: &JointConfig, config: &Config, state: &State) -> Result<Pupil, StartError> {
    let known = UncertainMode::believed(joint.belief);
    let base = joint.shaper.on_grid_for(&known, config.period);
    let adaptation = AdaptationSettings::around(joint.belief);
    Ok(Pupil {
        name: joint.name.clone(),
        settings: LearnerSettings {
            belief: joint.belief,
            natural_frequency: adaptation.natural_frequency,
            dead_band: adaptation.dead_band,
            longest_train: longest_train(joint),
            base: base.map_err(|reason| StartError::Belief {
                joint: joint.name.clone(),
                reason,
            })?,
            inertia: inertia(joint, config),
        },
        range: joint.range,
        memory: state
            .joints
            .get(&joint.name)
            .and_then(|state| state.map.clone()),
    })
}

/// The inertia of everything that a joint carries, if the robot's description has it.
fn inertia(joint: &JointConfig, config: &Config) -> Option<Inertia> {
    let robot = config.describes.then(|| config.description.clone())?;
    let others = config
        .joints
        .iter()
        .filter(|other| other.name != joint.name);
    let others: Vec<usize> = others.map(|other| other.index).collect();
    let (index, home) = (joint.index, robot.home());
    (!robot.bodies.is_empty()).then(|| {
        Inertia::new(move |position, positions, payload| {
            let mut pose = home.clone();
            for (at, position) in others.iter().zip(positions).chain([(&index, &position)]) {
                if let Some(slot) = pose.get_mut(*at) {
                    *slot = *position;
                }
            }
            robot.inertia(&pose, payload, index).unwrap_or(0.0)
        })
    })
}

fn bounds(joint: &Joint) -> Bounds {
    Bounds {
        limits: joint.config.limits,
        radius: joint.config.arc.map_or(f64::INFINITY, |arc| arc.radius()),
        deformation: joint.config.deformation_range,
        resolution: joint.config.encoder_resolution,
    }
}

/// An error with the attempted operation.
pub(super) fn system(what: impl std::fmt::Display, error: io::Error) -> StartError {
    StartError::System {
        what: what.to_string(),
        error,
    }
}
