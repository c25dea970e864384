//! A jerk-limited move and a mode to test against, both in closed form.

use quell_shapers::{Mode, MotionLimits, Setpoint};

/// A move from 0 to `distance` with trapezoidal acceleration: phases of constant jerk.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    pub distance: f64,
    /// Duration of each jerk phase, of constant acceleration, of constant velocity, s.
    pub phases: [f64; 3],
}

impl Move {
    fn sequence(&self) -> [(f64, f64); 7] {
        let [j, a, v] = self.phases;
        [
            (j, 1.0),
            (a, 0.0),
            (j, -1.0),
            (v, 0.0),
            (j, -1.0),
            (a, 0.0),
            (j, 1.0),
        ]
    }

    pub fn duration(&self) -> f64 {
        self.sequence().iter().map(|phase| phase.0).sum()
    }

    /// With jerk 1: position, velocity and acceleration after `time`.
    fn unit(&self, time: f64) -> [f64; 3] {
        let [mut p, mut v, mut a] = [0.0; 3];
        let mut left = time;
        for (duration, jerk) in self.sequence() {
            let t = duration.min(left.max(0.0));
            p += t * (v + t * (a / 2.0 + t * jerk / 6.0));
            v += t * (a + t * jerk / 2.0);
            a += t * jerk;
            left -= duration;
        }
        [p, v, a]
    }

    fn jerk(&self) -> f64 {
        self.distance / self.unit(self.duration())[0]
    }

    /// Limits that the move just reaches.
    pub fn limits(&self) -> MotionLimits {
        let [j, a, _] = self.phases;
        MotionLimits {
            velocity: self.jerk() * j * (j + a),
            acceleration: self.jerk() * j,
            jerk: self.jerk(),
        }
    }

    pub fn at(&self, time: f64) -> Setpoint {
        if time >= self.duration() {
            return Setpoint::at_rest(self.distance);
        }
        let [position, velocity, acceleration] = self.unit(time).map(|x| x * self.jerk());
        Setpoint {
            position,
            velocity,
            acceleration,
        }
    }

    /// Ticks after which the move is over.
    pub fn ticks(&self, tick: f64) -> usize {
        (self.duration() / tick - 1e-9).ceil() as usize
    }
}

/// `delta'' + 2 xi omega delta' + omega^2 delta = -u''`, with `u` linear between the ticks: then
/// `u''` is an impulse at each tick, and the motion between is known in closed form.
pub struct Joint {
    mode: Mode,
    tick: f64,
    pub delta: f64,
    rate: f64,
    position: f64,
    slope: f64,
}

impl Joint {
    pub fn new(mode: Mode, tick: f64) -> Self {
        Self {
            mode,
            tick,
            delta: 0.0,
            rate: 0.0,
            position: 0.0,
            slope: 0.0,
        }
    }

    /// The command goes linearly to `position` within the next tick.
    pub fn step(&mut self, position: f64) {
        let slope = (position - self.position) / self.tick;
        self.rate -= slope - self.slope;
        (self.position, self.slope) = (position, slope);
        let (sigma, wd) = (self.mode.decay_rate(), self.mode.damped_frequency());
        let decay = (-sigma * self.tick).exp();
        let (sin, cos) = (wd * self.tick).sin_cos();
        let b = (self.rate + sigma * self.delta) / wd;
        let a = self.delta;
        self.delta = decay * (a * cos + b * sin);
        self.rate = decay * ((b * wd - a * sigma) * cos - (a * wd + b * sigma) * sin);
    }

    /// Amplitude of the free vibration from here.
    pub fn amplitude(&self) -> f64 {
        let (sigma, wd) = (self.mode.decay_rate(), self.mode.damped_frequency());
        self.delta.hypot((self.rate + sigma * self.delta) / wd)
    }
}
