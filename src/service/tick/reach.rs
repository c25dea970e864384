//! Where the commands of a joint may be: the last gate before the robot.
//!
//! Every plan was checked before, so that a command that leads out of the range is a fault of the service. The gate
//! does not wait until it is there. A state admits a motion within limits that stays in the range if, braked as hard
//! as these allow, it turns there ([`AxisState::reaches`]). Each command from which it would turn beyond is refused,
//! and so is one that is not a number. From the last command that was admitted a brake within the limits ends in the
//! range: no command is beyond it, and there is no step in position, velocity or acceleration. Holding the last
//! command instead would be a step of its velocity. After the brake the joint holds, until it is commanded anew.
//!
//! A command of a plan within limits and range is never refused: the rest of the plan is such a motion. So is a mean
//! of plans, as a train makes it, and a correction, which is held against limits and range before it begins.

use quell_shapers::Setpoint;
use quell_trajectories::{AxisState, Brake, Limits};

use crate::controller::setpoint;
use crate::service::between::{inexact, state};

/// Time for which the end of a brake is repeated, s, so that a lost setpoint is replaced.
const REPEATED: f64 = 0.1;

/// Where the commands of a joint may be. No allocation.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    range: [f64; 2],
    /// The range, and where the joint was when its plan began: it may come back from beyond.
    allowed: [f64; 2],
    limits: Limits,
    period: f64,
    /// The last command that was admitted.
    admitted: AxisState,
    /// The brake since a command was not, and its time, s.
    brake: Option<(Brake, f64)>,
}

impl Reach {
    /// A range (rad) for commands within limits every `period` (s).
    pub fn new(range: [f64; 2], limits: Limits, period: f64) -> Self {
        Self {
            range,
            allowed: range,
            limits,
            period,
            admitted: AxisState::default(),
            brake: None,
        }
    }

    /// A plan begins while the command is at this position; returns where commands may be from now on.
    pub fn begin(&mut self, position: f64) -> [f64; 2] {
        let [low, high] = self.range;
        self.allowed = [low.min(position), high.max(position)];
        self.allowed
    }

    /// The joint is commanded anew, from rest.
    pub fn restart(&mut self, position: f64) {
        self.begin(position);
        self.admitted = AxisState::at_rest(position);
        self.brake = None;
    }

    /// The command instead of the one that is wanted: that one, or one of the brake. A refusal is told once, by the
    /// position to which the command would have led at least, rad.
    pub fn take(&mut self, wanted: Setpoint) -> (Setpoint, Option<f64>) {
        let mut refused = None;
        let (brake, time) = match &mut self.brake {
            Some(braking) => braking,
            None => {
                let inexact = inexact(self.limits, self.period);
                let [low, high] = self.allowed;
                let within = [low - inexact, high + inexact];
                refused = beyond(state(wanted), self.limits, within);
                if refused.is_none() {
                    self.admitted = state(wanted);
                    return (wanted, None);
                }
                let brake = Brake::within(self.admitted, self.limits, within);
                self.brake.insert((brake, 0.0))
            }
        };
        *time += self.period;
        (setpoint(brake.after(*time)), refused)
    }

    /// Whether a brake is still to be sent.
    pub fn is_braking(&self) -> bool {
        self.brake
            .is_some_and(|(brake, time)| time < brake.duration() + REPEATED)
    }
}

/// The position beyond a range to which a state leads within the limits; what is no number is itself beyond.
fn beyond(state: AxisState, limits: Limits, [low, high]: [f64; 2]) -> Option<f64> {
    let numbers = [state.position, state.velocity, state.acceleration];
    if let Some(&number) = numbers.iter().find(|number| !number.is_finite()) {
        return Some(number);
    }
    let reached = state.reaches(limits);
    reached
        .into_iter()
        .find(|position| !(low..=high).contains(position))
}
