//! The values that physics allows a parameter in a file.

use crate::effects::{Parameter, Scales};

/// The signs that physics allows a parameter, whatever the motion's scales are.
pub fn signs(parameter: &Parameter) -> (f64, f64) {
    let (low, high) = (parameter.bounds)(&Scales::default());
    (
        if low >= 0.0 { 0.0 } else { -f64::MAX },
        if high <= 0.0 { 0.0 } else { f64::MAX },
    )
}
