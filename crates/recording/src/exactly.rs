//! Lists of so many numbers.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Reads a list of `N` numbers. For an array `toml` takes the first `N` of a longer list, too.
///
/// # Errors
/// The length, where it is another.
pub fn exactly<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
    let given = Vec::<f64>::deserialize(from)?;
    let length = given.len();
    let wanted = format!("a list of {N} numbers");
    given
        .try_into()
        .map_err(|_| D::Error::invalid_length(length, &wanted.as_str()))
}
