//! The range of values that were seen: the least and the greatest.

/// The empty range.
pub const EMPTY: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// Extends a range to a value; a value that is not finite is ignored.
pub fn widen(range: &mut (f64, f64), value: f64) {
    if value.is_finite() {
        *range = (range.0.min(value), range.1.max(value));
    }
}
