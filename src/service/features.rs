//! The optional features of the service; each has a stand-in for builds without it.

use std::io;
use std::net::SocketAddr;

use super::clock::ServiceClock;
use super::config::{Config, NatsConfig};
use super::contract::Handle;
use super::link::RobotLink;
use super::station::StartError;

/// A bridge that requests moves for a robot's link; it is started once requests can be answered.
pub type Companion = Box<dyn FnOnce(Handle) -> io::Result<Box<dyn Send>>>;

/// Whether a link over Zenoh is part of this build.
pub const ZENOH: bool = cfg!(feature = "zenoh");

/// The live view of Foxglove, and its address.
///
/// # Errors
/// [`StartError`] where the address is not available, or the view is not part of this build.
#[cfg(feature = "foxglove")]
pub fn live_view(
    address: SocketAddr,
    joints: &[String],
    handle: &Handle,
    clock: ServiceClock,
) -> Result<(SocketAddr, Box<dyn Send>), StartError> {
    let server = super::foxglove::FoxgloveServer::start(address, joints, handle, clock);
    let server = server.map_err(|error| StartError::System {
        what: format!("Foxglove at {address}"),
        error,
    })?;
    Ok((server.address(), Box::new(server)))
}

/// Stand-in: not part of this build.
///
/// # Errors
/// [`StartError::NotBuilt`], always.
#[cfg(not(feature = "foxglove"))]
pub fn live_view(
    _: SocketAddr,
    _: &[String],
    _: &Handle,
    _: ServiceClock,
) -> Result<(SocketAddr, Box<dyn Send>), StartError> {
    Err(StartError::NotBuilt {
        feature: "foxglove",
    })
}

/// The link to a robot on ROS 2 over Zenoh, and the receiver of its trajectories.
///
/// # Errors
/// [`StartError`] where Zenoh refuses, or is not part of this build.
#[cfg(feature = "zenoh")]
pub fn over_zenoh(
    config: &Config,
    clock: ServiceClock,
) -> Result<(Box<dyn RobotLink>, Companion), StartError> {
    use super::link::{Node, ZenohBridge, ZenohLink};
    let refused = |error| StartError::System {
        what: "Zenoh".into(),
        error,
    };
    let node = std::sync::Arc::new(Node::open(&config.zenoh).map_err(refused)?);
    let link = ZenohLink::start(&node, config, clock).map_err(refused)?;
    let config = config.clone();
    let companion = move |handle| -> io::Result<Box<dyn Send>> {
        Ok(Box::new(ZenohBridge::start(node, &config, handle)?))
    };
    Ok((Box::new(link), Box::new(companion)))
}

/// Stand-in: not part of this build.
///
/// # Errors
/// [`StartError::NotBuilt`], always.
#[cfg(not(feature = "zenoh"))]
pub fn over_zenoh(
    _: &Config,
    _: ServiceClock,
) -> Result<(Box<dyn RobotLink>, Companion), StartError> {
    Err(StartError::NotBuilt { feature: "zenoh" })
}

/// A publisher of estimates and trains at a NATS server.
///
/// # Errors
/// [`StartError`] where the address is invalid, or this is not part of this build.
#[cfg(feature = "nats")]
pub fn telemetry(config: &NatsConfig, handle: &Handle) -> Result<Box<dyn Send>, StartError> {
    let telemetry = super::telemetry::Telemetry::start(config, handle);
    let telemetry = telemetry.map_err(|error| StartError::System {
        what: "nats.server".into(),
        error,
    })?;
    Ok(Box::new(telemetry))
}

/// Stand-in: not part of this build.
///
/// # Errors
/// [`StartError::NotBuilt`], always.
#[cfg(not(feature = "nats"))]
pub fn telemetry(_: &NatsConfig, _: &Handle) -> Result<Box<dyn Send>, StartError> {
    Err(StartError::NotBuilt { feature: "nats" })
}
