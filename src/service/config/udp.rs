//! The key of the UDP link, and where the link may go without one.

use std::net::SocketAddr;

use super::keys::UdpKeys;
use super::{Check, ConfigError};
use crate::service::signature::Key;

/// The shortest key of datagrams, characters: 128 bits where they are random bytes.
const SHORTEST_KEY: usize = 16;

/// The key of a link that listens at `address`, if it is `used`.
///
/// # Errors
/// [`ConfigError`] for a key that is too short, and for none where others than this machine reach the address: a
/// datagram of anybody would pass for one of the robot's.
pub fn key(
    keys: &UdpKeys,
    address: SocketAddr,
    used: bool,
    check: &Check,
) -> Result<Option<Key>, ConfigError> {
    let Some(secret) = &keys.key else {
        let ours = address.ip().to_canonical().is_loopback();
        if used && !ours && !keys.allow_unsigned {
            let expected = "loopback, or else datagrams must be signed: set udp.key, on the robot as well \
                 (`openssl rand -hex 32` makes one). On a network that nobody else reaches, \
                 udp.allow_unsigned = true goes without";
            return Err(check.refuse("udp.address", address, expected));
        }
        return Ok(None);
    };
    if secret.len() < SHORTEST_KEY {
        // A key is not shown, not even one that is of no use.
        let given = format!("({} characters)", secret.len());
        let expected = format!("at least {SHORTEST_KEY} characters");
        return Err(check.refuse("udp.key", given, expected));
    }
    Ok(Key::new(secret))
}
