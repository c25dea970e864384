//! A chain from a robot description in URDF, from the base to a link.

#[cfg(feature = "urdf")]
mod parse;

use std::path::Path;

use super::SignalError;
use super::description::UrdfChain;
#[cfg(feature = "urdf")]
use parse::parse;

/// Reads the chain from the base to `tip_link`, or to the link at the end of the longest chain.
///
/// Fixed joints are folded into their neighbours. Branches off the chain are left out.
///
/// # Errors
/// [`SignalError::Urdf`] with the file and the reason: unreadable, no such link, a loop, a joint of
/// a kind that a serial chain cannot hold (floating, planar, spherical) or that mimics another; always where
/// the crate is built without the feature `urdf`.
pub fn read_urdf(file: &Path, tip_link: Option<&str>) -> Result<UrdfChain, SignalError> {
    let refuse = |reason: String| SignalError::Urdf {
        file: file.to_path_buf(),
        reason,
    };
    let text = std::fs::read_to_string(file).map_err(|error| refuse(error.to_string()))?;
    parse(&text, tip_link).map_err(refuse)
}

#[cfg(not(feature = "urdf"))]
fn parse(_: &str, _: Option<&str>) -> Result<UrdfChain, String> {
    Err("this program is built without URDF: build it with the feature `urdf`".into())
}
