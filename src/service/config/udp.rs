//! The key of the UDP link, and where it may be omitted.

use std::net::SocketAddr;

use super::keys::UdpKeys;
use super::{Check, ConfigError};
use crate::service::signature::Key;

/// The shortest key of datagrams, characters: 128 bits where they are random bytes.
const SHORTEST_KEY: usize = 16;

/// The key of a link that listens at an address, which is from `at`, if it is `used`.
///
/// # Errors
/// [`ConfigError`] for a key that is too short, and for a missing key where other machines reach the address:
/// any datagram could then pass for one of the robot's.
pub fn key(
    keys: &UdpKeys,
    (at, address): (Check, SocketAddr),
    used: bool,
    check: &Check,
) -> Result<Option<Key>, ConfigError> {
    let Some(secret) = &keys.key else {
        let ours = address.ip().to_canonical().is_loopback();
        if used && !ours && !keys.allow_unsigned {
            let expected = "loopback, or else datagrams must be signed: set udp.key, on the robot as well \
                 (`openssl rand -hex 32` makes one). On a network that nobody else reaches, \
                 udp.allow_unsigned = true goes without";
            return Err(at.refuse("udp.address", address, expected));
        }
        return Ok(None);
    };
    if secret.len() < SHORTEST_KEY {
        // A key is never shown, not even an invalid one.
        let given = format!("({} characters)", secret.len());
        let expected = format!("at least {SHORTEST_KEY} characters");
        return Err(check.refuse("udp.key", given, expected));
    }
    Ok(Key::new(secret))
}
