//! A joint with several modes that depend on pose and payload, by Runge-Kutta: it shares nothing with what is tested.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Integration steps of a control period.
const STEPS: usize = 4;
/// Servo of the motor side: rad/s, damping ratio; it follows constant velocity without lag.
pub const SERVO: (f64, f64) = (380.0, 0.9);

/// A mode of the joint at position 0 without payload.
#[derive(Clone, Copy, Debug)]
pub struct PlantMode {
    pub hertz: f64,
    pub damping: f64,
    /// Share of the motor's acceleration that drives it.
    pub participation: f64,
    /// Relative change of the frequency at 1 rad, and by the square.
    pub slope: f64,
    pub bend: f64,
    /// Whether the inertia makes that change, as of an arm that folds, and not the stiffness.
    pub folds: bool,
    /// Inertia that a payload of 1 adds, over that without.
    pub payload: f64,
}

impl PlantMode {
    pub fn new(hertz: f64, damping: f64, participation: f64) -> Self {
        Self {
            hertz,
            damping,
            participation,
            slope: 0.0,
            bend: 0.0,
            folds: false,
            payload: 0.0,
        }
    }

    fn pose(&self, position: f64) -> f64 {
        1.0 + self.slope * position + self.bend * position * position
    }

    /// Natural frequency (rad/s) at a position and payload.
    pub fn frequency(&self, position: f64, payload: f64) -> f64 {
        let pose = self.pose(position);
        std::f64::consts::TAU * self.hertz * pose / (1.0 + self.payload * payload).sqrt()
    }

    /// `-J' / (2 J)` of the inertia over the pose: `J` is as `1 / w^2`.
    fn folding(&self, position: f64) -> f64 {
        let slope = self.slope + 2.0 * self.bend * position;
        if self.folds {
            slope / self.pose(position)
        } else {
            0.0
        }
    }
}

/// What a real joint and its sensors add.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faults {
    /// Noise of the deformation, rad.
    pub noise: f64,
    /// Step of the encoder, rad.
    pub resolution: f64,
    /// Share of samples that are spikes of a hundred times the noise.
    pub spikes: f64,
    /// Share of samples that are lost.
    pub lost: f64,
    /// The sensor's lag that nobody knows, s.
    pub lag: f64,
    /// Dry friction of the link, as deformation that it holds, rad.
    pub friction: f64,
    /// Half of the backlash, rad.
    pub backlash: f64,
}

impl Faults {
    /// Sensors as they usually are, and nothing else.
    pub const USUAL: Self = Self {
        noise: 10e-6,
        resolution: 1e-6,
        spikes: 0.0,
        lost: 0.0,
        lag: 0.0,
        friction: 0.0,
        backlash: 0.0,
    };
}

/// What the controller hears.
#[derive(Clone, Copy, Debug)]
pub struct Heard {
    pub time: f64,
    pub motor: f64,
    pub deformation: Option<f64>,
}

#[derive(Clone)]
pub struct Plant {
    pub modes: Vec<PlantMode>,
    pub faults: Faults,
    pub payload: f64,
    period: f64,
    time: f64,
    /// Motor position and velocity, then deformation and its velocity of each mode.
    state: Vec<f64>,
    command: [f64; 2],
    past: std::collections::VecDeque<f64>,
    random: ChaCha8Rng,
}

impl Plant {
    pub fn new(modes: &[PlantMode], faults: Faults, period: f64, start: f64, seed: u64) -> Self {
        let mut state = vec![0.0; 2 + 2 * modes.len()];
        state[0] = start;
        Self {
            modes: modes.to_vec(),
            faults,
            payload: 0.0,
            period,
            time: 0.0,
            state,
            command: [start, 0.0],
            past: std::collections::VecDeque::new(),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    pub fn motor(&self) -> f64 {
        self.state[0]
    }

    /// True deformation, rad.
    pub fn deformation(&self) -> f64 {
        self.state[2..].iter().step_by(2).sum()
    }

    fn slope(&self, state: &[f64], command: [f64; 2]) -> Vec<f64> {
        let (w, z) = SERVO;
        let acceleration = w * w * (command[0] - state[0]) + 2.0 * z * w * (command[1] - state[1]);
        let mut slope = vec![state[1], acceleration];
        for (mode, own) in self.modes.iter().zip(state[2..].chunks(2)) {
            let w = mode.frequency(state[0], self.payload);
            let (b, f) = (self.faults.backlash, self.faults.friction);
            // The spring of a joint with backlash pulls only beyond its play.
            let stretch = (own[0].abs() - b).max(0.0).copysign(own[0]);
            let rub = f * (own[1] / (10.0 * w * f.max(1e-9))).tanh();
            let pull = w * w * (stretch + rub) + 2.0 * mode.damping * w * own[1];
            // Lagrange: J a + J' v^2 / 2 is the torque at the link.
            let pushed = mode.folding(state[0]) * (state[1] + own[1]).powi(2);
            slope.extend([own[1], -pull + mode.participation * (pushed - acceleration)]);
        }
        slope
    }

    /// One control period towards a commanded position and velocity.
    pub fn step(&mut self, position: f64, velocity: f64) -> Heard {
        let h = self.period / STEPS as f64;
        let [from, from_velocity] = self.command;
        let at = |part: f64| {
            // A cubic in between.
            let (s, p) = (part, self.period);
            let (a, b) = (from, position);
            let (va, vb) = (from_velocity * p, velocity * p);
            let (s2, s3) = (s * s, s * s * s);
            let x = a * (2.0 * s3 - 3.0 * s2 + 1.0)
                + va * (s3 - 2.0 * s2 + s)
                + b * (3.0 * s2 - 2.0 * s3)
                + vb * (s3 - s2);
            let v = (a * (6.0 * s2 - 6.0 * s)
                + va * (3.0 * s2 - 4.0 * s + 1.0)
                + b * (6.0 * s - 6.0 * s2)
                + vb * (3.0 * s2 - 2.0 * s))
                / p;
            [x, v]
        };
        let add = |x: &[f64], y: &[f64], c: f64| -> Vec<f64> {
            x.iter().zip(y).map(|(x, y)| x + c * y).collect()
        };
        for k in 0..STEPS {
            let part = |c: f64| at((k as f64 + c) / STEPS as f64);
            let x = self.state.clone();
            let a = self.slope(&x, part(0.0));
            let b = self.slope(&add(&x, &a, 0.5 * h), part(0.5));
            let c = self.slope(&add(&x, &b, 0.5 * h), part(0.5));
            let d = self.slope(&add(&x, &c, h), part(1.0));
            for (n, value) in self.state.iter_mut().enumerate() {
                *value += h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]);
            }
        }
        self.command = [position, velocity];
        self.time += self.period;
        self.hear()
    }

    fn hear(&mut self) -> Heard {
        let faults = self.faults;
        self.past.push_front(self.deformation());
        self.past.truncate(64);
        let lag = ((faults.lag / self.period).round() as usize).min(self.past.len() - 1);
        let z: f64 = self.random.sample(StandardNormal);
        let spike = match self.random.random_bool(faults.spikes) {
            true => 100.0 * faults.noise,
            false => 0.0,
        };
        let lost = self.random.random_bool(faults.lost);
        let measured = self.past[lag] + faults.noise * z + spike;
        let q = faults.resolution;
        let motor = match q > 0.0 {
            true => (self.motor() / q).round() * q,
            false => self.motor(),
        };
        Heard {
            time: self.time,
            motor,
            deformation: (!lost).then_some(measured),
        }
    }
}
