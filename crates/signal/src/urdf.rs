//! A chain from a robot description in URDF, from the base to a link.

#[cfg(feature = "urdf")]
mod parse;
#[cfg(feature = "urdf")]
mod tree;

use std::path::Path;

use super::SignalError;
use super::description::{Tree, UrdfChain};
#[cfg(feature = "urdf")]
use {parse::parse, tree::tree};

/// Reads the chain from the base to `tip_link`, or to the link at the end of the longest chain.
///
/// Fixed joints are folded into their neighbours. Branches off the chain are left out.
///
/// # Errors
/// [`SignalError::Urdf`] with the file and the reason: unreadable, no such link, a loop, a joint type that a
/// serial chain cannot represent (floating, planar, spherical), or a mimic joint. Always, if the crate is built
/// without the feature `urdf`.
pub fn read_urdf(file: &Path, tip_link: Option<&str>) -> Result<UrdfChain, SignalError> {
    let refuse = |reason: String| SignalError::Urdf {
        file: file.to_path_buf(),
        reason,
    };
    let text = std::fs::read_to_string(file).map_err(|error| refuse(error.to_string()))?;
    parse(&text, tip_link).map_err(refuse)
}

/// Reads all moving joints and links, branches too. Mimic, floating and planar joints are refused.
///
/// # Errors
/// As [`read_urdf`], and where no joint moves or several links have no parent.
pub fn read_urdf_tree(file: &Path) -> Result<Tree, SignalError> {
    let refuse = |reason: String| SignalError::Urdf {
        file: file.to_path_buf(),
        reason,
    };
    let text = std::fs::read_to_string(file).map_err(|error| refuse(error.to_string()))?;
    tree(&text).map_err(refuse)
}

#[cfg(not(feature = "urdf"))]
fn tree(_: &str) -> Result<Tree, String> {
    Err(ABSENT.into())
}

#[cfg(not(feature = "urdf"))]
const ABSENT: &str = "this program is built without URDF: build it with the feature `urdf`";

#[cfg(not(feature = "urdf"))]
fn parse(_: &str, _: Option<&str>) -> Result<UrdfChain, String> {
    Err(ABSENT.into())
}
