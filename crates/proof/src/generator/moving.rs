//! A flexible joint in motion: bodies, springs and surfaces.
//!
//! `m` is the motor side (prescribed, seen by the encoder), `y` the link, `b` the base on which the
//! motor stands, `z` a body that hangs on the link by a further spring. The transmission works on
//! `x = y - b - m`.

use super::integrate::{Contact, Plant, STATES, State};
use super::joint::{Joint, Lag, Seen};
use super::programme::Programme;

const Y: usize = 0;
const Y_RATE: usize = 1;
const B: usize = 2;
const B_RATE: usize = 3;
const Z: usize = 4;
const Z_RATE: usize = 5;
const BRISTLE: usize = 6;
const LOOP: usize = 7;
const CREEP: usize = 8;
const SWING: usize = 9;
const SWING_RATE: usize = 10;
const LAG: usize = 11;
const LAG_RATE: usize = 12;
/// The first of the sliders.
const SLIDER: usize = 13;

/// A joint on its way through a programme.
pub struct Moving<'a> {
    /// The joint.
    pub joint: &'a Joint,
    /// The motion of the motor.
    pub programme: &'a Programme,
    /// The motion that the sensor sees.
    pub seen: Seen,
}

/// Everything the equations share at one instant.
struct Instant {
    motor: [f64; 3],
    position: f64,
    x: f64,
    x_rate: f64,
    /// Torque of springs and dampers across the transmission against `x`.
    elastic: f64,
    /// Other torques on the link.
    load: f64,
    /// Torques on the base other than the motor's.
    ground: f64,
    inertia: f64,
    /// One over the base's inertia, 0 where it is rigid.
    compliance: f64,
    swing: f64,
}

impl Moving<'_> {
    /// The state at rest at the start.
    pub fn start(&self) -> State {
        let mut state = [0.0; STATES];
        let angle = self.programme.at(0.0)[0];
        let [weight, phase] = self.joint.gravity;
        let mut x = 0.0;
        // The sag is small: each pass gains three digits.
        for _ in 0..20 {
            let torque = weight * (angle + x + phase).sin() + self.joint.laws.pull(angle + x);
            x = torque / self.joint.stiffness;
        }
        state[Y] = angle + x;
        state[Z] = state[Y];
        let lagging = match self.seen {
            Seen::Link => state[Y],
            Seen::Deformation => x,
        };
        state[LAG] = lagging;
        state
    }

    /// Instants at which something steps.
    pub fn breaks(&self) -> Vec<f64> {
        let knocks = self.joint.knocks.iter();
        let mut breaks: Vec<f64> = knocks.flat_map(|k| [k.start, k.start + k.length]).collect();
        breaks.extend(self.joint.payload.map(|[time, _]| time));
        breaks.extend(self.programme.corners());
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    /// The motor side as the transmission passes it on: position, velocity, acceleration.
    fn motor(&self, time: f64) -> ([f64; 3], f64) {
        let [u, v, a] = self.programme.at(time);
        let [size, ..] = self.joint.ripple;
        if size == 0.0 {
            return ([u, v, a], u);
        }
        let (mut offset, mut slope, mut bend) = (0.0, 1.0, 0.0);
        for [size, waves, phase] in [self.joint.ripple].iter().chain(&self.joint.harmonics) {
            let (sin, cos) = (waves * u + phase).sin_cos();
            slope += size * waves * cos;
            bend -= size * waves * waves * sin;
            // Assembled so that nothing is bent at the start.
            offset += size * (sin - phase.sin());
        }
        ([u + offset, v * slope, a * slope + bend * v * v], u)
    }

    fn instant(&self, time: f64, state: &State) -> Instant {
        let joint = self.joint;
        let (motor, position) = self.motor(time);
        let x = state[Y] - state[B] - motor[0];
        let x_rate = state[Y_RATE] - state[B_RATE] - motor[1];
        let (inertia, bend) = self.inertia(time, state[Y]);
        let (swing, hose, dragged) = self.hose(state);
        let base = joint.base.map_or((0.0, 0.0), |base| {
            let torque = base.stiffness * state[B] + base.damping * state[B_RATE];
            (-torque, 1.0 / base.inertia)
        });
        Instant {
            elastic: self.elastic(time, state, [x, x_rate], motor[1])
                + joint.laws.against(position, x_rate, &state[SLIDER..]),
            load: self.load(time, state) + hose - 0.5 * bend * state[Y_RATE].powi(2),
            ground: base.0,
            compliance: base.1,
            motor,
            position,
            x,
            x_rate,
            inertia: inertia + dragged,
            swing,
        }
    }

    /// Inertia of the link and its change with the angle.
    fn inertia(&self, time: f64, angle: f64) -> (f64, f64) {
        let joint = self.joint;
        let (mut factor, mut bend) = (1.0, 0.0);
        if joint.pose[0] != 0.0 {
            let (sin, cos) = (angle + joint.pose[1]).sin_cos();
            (factor, bend) = (1.0 + joint.pose[0] * sin, joint.pose[0] * cos);
        }
        if let Some([_, share]) = joint.payload.filter(|[at, _]| time >= *at) {
            factor += share;
        }
        if let Some((outer, _)) = joint.outer {
            factor -= outer.inertia / joint.inertia;
        }
        (joint.inertia * factor, joint.inertia * bend)
    }

    /// Springs, dampers, bristles and loops against the deformation.
    fn elastic(&self, time: f64, state: &State, [x, v]: [f64; 2], motor_speed: f64) -> f64 {
        let joint = self.joint;
        let (mut bent, touching) = joint.gap.map_or((x, true), |gap| gap.compression(x));
        let mut stiffness = joint.stiffness;
        if joint.warming[0] != 0.0 {
            stiffness *= 1.0 + joint.warming[0] * (1.0 - (-time / joint.warming[1]).exp());
        }
        stiffness *= 1.0 + joint.speed_stiffening * motor_speed.abs();
        let mut damping = joint.damping;
        if joint.damping_waves[0] != 0.0 {
            damping *= 1.0 + joint.damping_waves[0] * (joint.damping_waves[1] * time).sin();
        }
        if let Some(gap) = joint.gap.filter(|_| !touching) {
            damping *= gap.oil;
        }
        if let Some(gap) = joint.rounded_gap {
            let (compressed, share) = gap.compression(x);
            bent = compressed;
            damping *= gap.oil + (1.0 - gap.oil) * share;
        }
        damping += joint.bent_damping * bent * bent;
        let [up, down, knee] = joint.bilinear;
        let beyond = up * (bent - knee).max(0.0) + down * (bent + knee).min(0.0);
        let spring = bent * (1.0 + joint.cubic * bent * bent) + beyond + joint.uneven_spring(bent);
        let mut torque = stiffness * spring + damping * v;
        if joint.gap.is_some() && touching && torque * bent < 0.0 {
            // Teeth push, they do not pull.
            torque = 0.0;
        }
        torque += joint.quadratic_damping * v * v.abs();
        torque += joint.root_damping * v.signum() * v.abs().sqrt();
        torque += joint
            .bristles
            .map_or(0.0, |law| law.force(state[BRISTLE], v));
        torque += joint
            .hysteresis
            .map_or(0.0, |law| law.stiffness * state[LOOP]);
        torque
            + joint
                .creep
                .map_or(0.0, |[spring, _]| spring * (x - state[CREEP]))
    }

    /// Torques on the link from outside the transmission.
    fn load(&self, time: f64, state: &State) -> f64 {
        let joint = self.joint;
        let (y, v) = (state[Y], state[Y_RATE]);
        let mut torque = -v * (joint.viscous_drag + joint.quadratic_drag * v.abs());
        let [rub, speed] = joint.creeping_bearing;
        if rub != 0.0 {
            torque -= rub * (v / speed).tanh();
        }
        if joint.gravity[0] != 0.0 {
            torque += joint.gravity[0] * (y + joint.gravity[1]).sin();
        }
        if let Some((outer, _)) = joint.outer {
            torque += outer.stiffness * (state[Z] - y) + outer.damping * (state[Z_RATE] - v);
        }
        let [shakes, frequency, phase] = joint.shaking;
        if shakes != 0.0 {
            torque += shakes * (frequency * time + phase).sin();
        }
        torque += joint.laws.pull(y);
        torque += joint.stop.map_or(0.0, |stop| stop.force(y, v));
        torque + joint.knocks.iter().map(|knock| knock.at(time)).sum::<f64>()
    }

    /// The hose's own acceleration without the link's, its pull on the link, and the inertia that the link drags along
    /// the hose.
    fn hose(&self, state: &State) -> (f64, f64, f64) {
        let Some(hose) = self.joint.hose else {
            return (0.0, 0.0, 0.0);
        };
        let w = hose.frequency;
        let (angle, rate) = (state[SWING], state[SWING_RATE]);
        let (sin, cos) = angle.sin_cos();
        let back = w * w * sin + 2.0 * hose.damping_ratio * w * rate;
        let coupling = self.joint.inertia * hose.share;
        let pull = coupling * (back * cos + rate * rate * sin);
        (-back, pull, coupling * hose.length_ratio * sin * sin)
    }

    /// Speed of what the friction holds the link to.
    fn held_by(&self, time: f64, state: &State) -> f64 {
        match self.joint.dry_bearing {
            true => 0.0,
            false => state[B_RATE] + self.motor(time).0[1],
        }
    }

    /// Torque of the friction on the link that keeps the two sides of the transmission together, or the link at rest.
    fn holding(&self, now: &Instant) -> f64 {
        if self.joint.dry_bearing {
            return now.elastic - now.load;
        }
        let link = now.load / now.inertia;
        let base = now.ground * now.compliance;
        (now.motor[2] + base - link) / (1.0 / now.inertia + now.compliance) + now.elastic
    }
}

impl Plant for Moving<'_> {
    fn rates(&self, time: f64, state: &State, contact: Contact) -> State {
        let joint = self.joint;
        let now = self.instant(time, state);
        let rubbing = match (joint.dry, contact) {
            (None, _) => 0.0,
            (Some(_), Contact::Stuck) => self.holding(&now),
            (Some(dry), Contact::Sliding(sign)) => {
                let slip = if joint.dry_bearing {
                    state[Y_RATE]
                } else {
                    now.x_rate
                };
                dry.sliding(sign, (sign * slip).max(0.0), now.position)
            }
        };
        let bearing = if joint.dry_bearing { rubbing } else { 0.0 };
        let torque = rubbing - bearing - now.elastic;
        let mut rates = [0.0; STATES];
        rates[Y] = state[Y_RATE];
        rates[Y_RATE] = (torque + bearing + now.load) / now.inertia;
        rates[B] = state[B_RATE];
        rates[B_RATE] = (now.ground - torque) * now.compliance;
        if let Some((outer, _)) = joint.outer {
            let pull = outer.stiffness * (state[Z] - state[Y])
                + outer.damping * (state[Z_RATE] - state[Y_RATE]);
            rates[Z] = state[Z_RATE];
            rates[Z_RATE] = -pull / outer.inertia;
        }
        rates[BRISTLE] = joint
            .bristles
            .map_or(0.0, |law| law.rate(state[BRISTLE], now.x_rate));
        rates[LOOP] = joint
            .hysteresis
            .map_or(0.0, |law| law.rate(state[LOOP], now.x_rate));
        rates[CREEP] = joint
            .creep
            .map_or(0.0, |[_, tau]| (now.x - state[CREEP]) / tau);
        if let Some(hose) = joint.hose {
            rates[SWING] = state[SWING_RATE];
            rates[SWING_RATE] = now.swing - hose.length_ratio * rates[Y_RATE] * state[SWING].cos();
        }
        joint.laws.slide(now.x_rate, state, SLIDER, &mut rates);
        self.lag(time, state, &mut rates);
        rates
    }

    fn slip(&self, time: f64, state: &State) -> Option<f64> {
        self.joint.dry?;
        Some(state[Y_RATE] - self.held_by(time, state))
    }

    fn excess(&self, time: f64, state: &State) -> (f64, f64) {
        let Some(dry) = self.joint.dry else {
            return (0.0, 1.0);
        };
        let now = self.instant(time, state);
        dry.excess(self.holding(&now), now.position)
    }

    fn arrest(&self, time: f64, state: &mut State) {
        state[Y_RATE] = self.held_by(time, state);
    }

    fn edges(&self, time: f64, state: &State) -> [f64; 4] {
        let mut edges = [1.0; 4];
        if let Some(gap) = self.joint.gap {
            let motor = self.motor(time).0;
            let x = state[Y] - state[B] - motor[0];
            let rate = state[Y_RATE] - state[B_RATE] - motor[1];
            (edges[0], edges[1]) = (x - gap.half, x + gap.half);
            // Where teeth in contact stop pushing; 0 keeps it silent within the play.
            let (bent, touching) = gap.compression(x);
            let push = self.joint.stiffness * bent + self.joint.damping * rate;
            edges[3] = if touching { push } else { 0.0 };
        }
        if let Some(stop) = self.joint.stop {
            edges[2] = state[Y] - stop.position;
        }
        edges
    }

    fn shown(&self, time: f64, state: &State, rates: &State) -> [f64; 2] {
        match self.joint.lag {
            Some(_) => [state[LAG], rates[LAG]],
            None => self.tip(time, state),
        }
    }
}

impl Moving<'_> {
    /// The sensor's reading of its target, and the rate of that.
    fn lag(&self, time: f64, state: &State, rates: &mut State) {
        let behind = |time_constant: f64| (self.tip(time, state)[0] - state[LAG]) / time_constant;
        match self.joint.lag {
            None => {}
            Some(Lag::First { time_constant }) => rates[LAG] = behind(time_constant),
            Some(Lag::Second {
                time_constant,
                damping_ratio,
            }) => {
                rates[LAG] = state[LAG_RATE];
                rates[LAG_RATE] =
                    (behind(time_constant) - 2.0 * damping_ratio * state[LAG_RATE]) / time_constant;
            }
        }
    }

    /// Where the sensor's target is, and its rate.
    fn tip(&self, time: f64, state: &State) -> [f64; 2] {
        let tip = match self.joint.outer {
            Some((_, true)) => [state[Z], state[Z_RATE]],
            _ => [state[Y], state[Y_RATE]],
        };
        let [u, v, _] = self.programme.at(time);
        match self.seen {
            Seen::Link => tip,
            Seen::Deformation => [tip[0] - u, tip[1] - v],
        }
    }
}
