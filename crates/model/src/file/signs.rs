//! Allowed values of a parameter in a file.

use crate::effects::{Parameter, Scales};

/// The allowed signs of a parameter, at any scale of the motion.
pub fn signs(parameter: &Parameter) -> (f64, f64) {
    let (low, high) = (parameter.bounds)(&Scales::default());
    (
        if low >= 0.0 { 0.0 } else { -f64::MAX },
        if high <= 0.0 { 0.0 } else { f64::MAX },
    )
}
