//! A share of a batch, for job arrays that have no queue.

use std::fmt;
use std::str::FromStr;

use super::error::BatchError;

/// The i-th of n shares, written `i/n`.
///
/// A job belongs to the share that its key gives, `key mod n`: whatever the order in which recordings are
/// found and wherever they lie, the n shares are disjoint, and together the whole.
///
/// # Example
/// ```
/// use quell::batch::Shard;
/// let shares: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| text.parse().unwrap()).into();
/// let key = "00000000000000050123";
/// assert_eq!(shares.iter().filter(|share| share.has(key)).count(), 1);
/// assert!("4/3".parse::<Shard>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    count: u64,
}

impl Shard {
    /// Whether a job with this key belongs to it: by the first 64 bits, which a hash spreads evenly.
    pub fn has(&self, key: &str) -> bool {
        let first = key.get(..16).unwrap_or_default();
        u64::from_str_radix(first, 16).unwrap_or(0) % self.count == self.index
    }
}

impl fmt::Display for Shard {
    /// `3 of 8`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.index + 1, self.count)
    }
}

impl FromStr for Shard {
    type Err = BatchError;

    fn from_str(text: &str) -> Result<Self, BatchError> {
        let refused = || BatchError::Shard(text.into());
        let (index, count) = text.split_once('/').ok_or_else(refused)?;
        let number = |text: &str| text.parse::<u64>().map_err(|_| refused());
        let (index, count) = (number(index)?, number(count)?);
        if !(1..=count).contains(&index) {
            return Err(refused());
        }
        Ok(Self {
            index: index - 1,
            count,
        })
    }
}
