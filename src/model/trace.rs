//! A simulated motion at the nodes of its grid.

use super::chain::{Instant, RESONANCES, State};

/// Position, velocity and acceleration.
pub type Kinematics = [f64; 3];

/// A simulated motion; all series have one entry a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Node times, s.
    pub time: Vec<f64>,
    /// Motor side, as the transmission sees it.
    pub motor: Vec<Kinematics>,
    /// Link; the motor side again where there is none.
    pub link: Vec<Kinematics>,
    /// Further modes.
    pub modes: Vec<[Kinematics; RESONANCES]>,
}

impl Trace {
    pub(super) fn with_capacity(nodes: usize) -> Self {
        Self {
            time: Vec::with_capacity(nodes),
            motor: Vec::with_capacity(nodes),
            link: Vec::with_capacity(nodes),
            modes: Vec::with_capacity(nodes),
        }
    }

    pub(super) fn push(&mut self, instant: &Instant, state: &State) {
        let motion = &instant.motion;
        let [u, v] = motion.motor;
        let [y, rate] = motion.link;
        self.time.push(motion.time);
        self.motor.push([u, v, instant.motor]);
        self.link.push([y, rate, instant.link]);
        let mut modes = [[0.0; 3]; RESONANCES];
        for (k, mode) in modes.iter_mut().enumerate() {
            *mode = [state[4 + 2 * k], state[5 + 2 * k], instant.modes[k]];
        }
        self.modes.push(modes);
    }
}

/// The value at `t` of the cubic through values and rates at two ends.
pub fn hermite(t0: f64, t1: f64, from: [f64; 2], to: [f64; 2], t: f64) -> f64 {
    let h = t1 - t0;
    let s = (t - t0) / h;
    let (a, b) = (h * from[1], h * to[1]);
    let rise = to[0] - from[0];
    let (c2, c3) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
    from[0] + s * (a + s * (c2 + s * c3))
}
