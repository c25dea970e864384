//! A joint that is held moving, as it is remembered.

/// A hold.
#[derive(Clone, Copy, Debug)]
pub struct Jog {
    /// Its number, another one for each press of a button.
    pub hold: u64,
    /// Wanted velocity, rad/s.
    pub velocity: f64,
    /// When it is over unless it is renewed, s.
    pub until: f64,
    /// Whether it moves nothing any more.
    pub over: bool,
}

impl Jog {
    /// It moves nothing any more.
    pub fn end(&mut self) {
        self.over = true;
    }

    /// Whether it still does.
    pub fn holds(&self) -> bool {
        !self.over
    }
}
