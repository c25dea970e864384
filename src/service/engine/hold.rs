//! State of a joint that is jogged.

/// A hold.
#[derive(Clone, Copy, Debug)]
pub struct Jog {
    /// Its number, another one for each press of a button.
    pub hold: u64,
    /// Wanted velocity, rad/s.
    pub velocity: f64,
    /// Time at which it ends unless renewed, s.
    pub until: f64,
    /// Whether it has ended.
    pub over: bool,
}

impl Jog {
    /// Ends the hold.
    pub fn end(&mut self) {
        self.over = true;
    }

    /// Whether it still moves the joint.
    pub fn holds(&self) -> bool {
        !self.over
    }
}
