//! How long a robot may go on without a setpoint.

/// How long a robot goes on without a setpoint, s: 20 missing in succession at 1 kHz stop it. Source: Franka
/// Control Interface, which predicts at constant acceleration until then and reports a violation of the
/// communication after it.
pub const BRIDGED: f64 = 0.02;

/// Number of successive missed ticks of `period` (s) that the command makes up for.
pub fn bridged(period: f64) -> u64 {
    // A period that divides the time exactly may come out a rounding below.
    (BRIDGED / period + 1e-9) as u64
}
