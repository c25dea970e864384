//! Start and end of the service: a station on threads, with its companions.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;

use super::clock::ServiceClock;
use super::config::{Config, JointConfig, RobotKind};
use super::contract::Handle;
use super::disk::{Disk, FileSystem};
use super::features::{Companion, live_view, over_zenoh, telemetry};
use super::link::{UdpLink, UdpSettings};
use super::recorder::Shelf;
use super::station::{RobotParts, StartError, Station, system};
use super::tick::{TickThread, TickThreadSettings};

/// A running service.
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
    /// A handle for requests and state.
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }

    /// The shelf of the recordings; `None` if recording is off.
    pub fn shelf(&self) -> Option<Arc<Shelf>> {
        self.shelf.clone()
    }

    /// The address of the UDP link, if there is one.
    pub fn udp_address(&self) -> Option<SocketAddr> {
        self.udp
    }

    /// The address of the live view of Foxglove, if there is one.
    pub fn foxglove_address(&self) -> Option<SocketAddr> {
        self.foxglove
    }

    /// Brings every joint to a jerk-limited stop, saves the state, and ends.
    pub fn stop(mut self) {
        self.end();
    }

    fn end(&mut self) {
        // First, so that the robot brakes while the companions say their farewells: their requests are refused from now on.
        self.ending.store(true, Relaxed);
        self.companions.clear();
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
/// [`StartError`] where something in the configuration is not available.
pub fn start(config: Config) -> Result<Service, StartError> {
    let disk = Disk::of(&config.data, Arc::new(FileSystem))?;
    start_on(config, disk)
}

/// As [`start`], with the data folder on an open disk.
///
/// # Errors
/// As [`start`].
pub fn start_on(config: Config, disk: Disk) -> Result<Service, StartError> {
    let clock = ServiceClock::start();
    let reached = reach(&config, &clock)?;
    if config.robot != RobotKind::Embedded {
        config.joints.iter().for_each(JointConfig::warn_of_limits);
    }
    let station = Station::assemble(config.clone(), clock.clone(), reached.robot, disk)?;
    let (handle, shelf) = (station.handle(), station.shelf());
    let ending = Arc::new(AtomicBool::new(false));
    let engine = run(station, config.real_time, Arc::clone(&ending))?;
    let mut service = Service {
        handle,
        udp: reached.udp,
        foxglove: None,
        companions: Vec::new(),
        ending,
        engine: Some(engine),
        shelf,
    };
    if let Some(companion) = reached.companion {
        let companion = companion(service.handle());
        let companion = companion.map_err(|error| system("the robot's requests", error))?;
        service.companions.push(companion);
    }
    if let Some(address) = config.foxglove {
        let names = config.joints.iter().map(|joint| joint.name.clone());
        let names: Vec<_> = names.collect();
        let (address, view) = live_view(address, &names, &service.handle, clock)?;
        service.foxglove = Some(address);
        service.companions.push(view);
    }
    if let Some(nats) = &config.nats {
        service.companions.push(telemetry(nats, &service.handle)?);
    }
    Ok(service)
}

/// The engine's thread; when it ends, tick and keeper have ended, too.
fn run(
    station: Station,
    real_time: bool,
    ending: Arc<AtomicBool>,
) -> Result<JoinHandle<()>, StartError> {
    let Station {
        pulse,
        engine,
        keeper,
        learners,
        ..
    } = station;
    let tick = TickThread::start(pulse, TickThreadSettings { real_time });
    let tick = tick.map_err(|error| system("the tick's thread", error))?;
    let begin = || -> io::Result<JoinHandle<()>> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .build()?;
        let keeper = std::thread::Builder::new()
            .name("quell-state".into())
            .spawn(move || keeper.run())?;
        // Nobody waits for its end: what is not learned when the engine ends is kept by nobody.
        std::thread::Builder::new()
            .name("quell-learners".into())
            .spawn(move || learners.run())?;
        std::thread::Builder::new()
            .name("quell-engine".into())
            .spawn(move || {
                runtime.block_on(engine.run(&ending));
                drop(tick);
                // The engine and with it the sender are gone: the keeper has written the last state.
                let _ = keeper.join();
            })
    };
    begin().map_err(|error| system("the engine's thread", error))
}

/// A robot with the parts that depend on its link.
struct Reached {
    robot: RobotParts,
    udp: Option<SocketAddr>,
    companion: Option<Companion>,
}

fn reach(config: &Config, clock: &ServiceClock) -> Result<Reached, StartError> {
    let (mut udp, mut companion) = (None, None);
    let robot = match config.robot {
        RobotKind::Embedded => RobotParts::embedded(config)?,
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
            let link = UdpLink::start(settings, clock.clone());
            let link = link.map_err(|error| system(config.udp, error))?;
            udp = link.address().ok();
            RobotParts::over(Box::new(link))
        }
        RobotKind::Zenoh => {
            let (link, beside) = over_zenoh(config, clock.clone())?;
            companion = Some(beside);
            RobotParts::over(link)
        }
    };
    Ok(Reached {
        robot,
        udp,
        companion,
    })
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};
    use std::time::Duration;

    use super::*;
    use crate::service::config::Overrides;

    /// Longest that anything here is waited for.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// A companion that takes long to end: until the robot is being stopped.
    struct Slow(Handle, Sender<bool>);

    impl Drop for Slow {
        fn drop(&mut self) {
            let mut snapshots = self.0.snapshots();
            let stopping = async {
                while !snapshots.borrow_and_update().stopping {
                    if snapshots.changed().await.is_err() {
                        // The engine has stopped the robot and ended.
                        return;
                    }
                }
            };
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_time()
                .build();
            let seen = runtime
                .expect("a runtime")
                .block_on(async { tokio::time::timeout(PATIENCE, stopping).await.is_ok() });
            self.1.send(seen).expect("a listener");
        }
    }

    #[test]
    fn the_robot_is_stopped_before_companions_have_ended() {
        let data = tempfile::tempdir().expect("a folder");
        let overrides = Overrides {
            robot: Some(RobotKind::Embedded),
            data: Some(data.path().to_path_buf()),
            ..Overrides::default()
        };
        let mut config = Config::load(None, &overrides).expect("defaults");
        config.real_time = false;
        let mut service = start(config).expect("a service");
        let (told, seen) = channel();
        let slow = Slow(service.handle(), told);
        service.companions.push(Box::new(slow));
        service.stop();
        assert_eq!(seen.recv(), Ok(true));
    }
}
