//! How closely a motor side follows its command.

/// Distance of the motor side from a command at rest from which, after a silence, it counts as moved by
/// something else, rad: more than the static error of a servo, less than anybody would call a move.
pub const MOVED: f64 = 1e-3;
/// Within this time the motor side has followed its command, s: seven time constants of a servo of
/// 20 Hz, to 1 in 1000.
pub const FOLLOWED: f64 = 0.06;

/// The following error that a joint may have where the configuration names none, rad: the most that a healthy one
/// can have.
///
/// The slowest servo that follows within `T` = [`FOLLOWED`] is a first-order lag of that time constant. Under an
/// acceleration `a` it is where the command was `T` ago, and `a T^2 / 2` beyond; where `a` brakes, that is outside
/// of all that was commanded since. [`MOVED`] covers the static error.
pub fn healthy(acceleration: f64) -> f64 {
    MOVED + 0.5 * acceleration * FOLLOWED * FOLLOWED
}
