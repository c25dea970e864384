//! Tolerances of a motor side's tracking of its command.

/// Distance of the motor side from a command at rest, rad, from which after a silence it counts as moved by
/// something else: more than the static error of a servo, less than a deliberate move.
pub const MOVED: f64 = 1e-3;
/// Time in which the motor side follows its command, s: seven time constants of a servo of 20 Hz, to 1 in 1000.
pub const FOLLOWED: f64 = 0.06;

/// Following error that a joint may have if the configuration gives none, rad: the largest of a healthy joint.
///
/// The slowest servo that follows within `T` = [`FOLLOWED`] is a first-order lag of that time constant. Under
/// an acceleration `a` it is `a T^2 / 2` beyond the command of `T` ago. If `a` brakes, that is outside of all
/// commands since. [`MOVED`] covers the static error.
pub fn healthy(acceleration: f64) -> f64 {
    MOVED + 0.5 * acceleration * FOLLOWED * FOLLOWED
}
