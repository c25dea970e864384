//! The motion of the motor side: jerk-limited moves with pauses between them.

use super::random::Draw;
use quell_trajectories::{AxisState, Limits, PlanError, Planner};

/// A stretch of constant jerk.
#[derive(Clone, Copy, Debug)]
struct Phase {
    start: f64,
    state: AxisState,
    jerk: f64,
}

/// Moves one after the other, from rest to rest, known at every instant.
#[derive(Clone, Debug, Default)]
pub struct Programme {
    phases: Vec<Phase>,
    /// Pauses, s: from the end of a move to the start of the next one.
    pub pauses: Vec<[f64; 2]>,
    /// Length of the recording, s.
    pub duration: f64,
}

/// The ranges of an arm's moves.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// Natural frequency of the arm, rad/s: it scales the jerk.
    pub natural_frequency: f64,
    /// Greatest acceleration, rad/s^2 or m/s^2.
    pub acceleration: f64,
    /// Greatest speed, rad/s or m/s.
    pub velocity: f64,
    /// Positions stay within this, rad or m.
    pub range: f64,
    /// One move, or a programme of 4 to 10.
    pub rich: bool,
}

/// Shortest pause that lets the trackers see a rest, s.
const LONG_PAUSE: f64 = 0.8;

impl Programme {
    /// A programme in this style.
    ///
    /// # Errors
    /// [`PlanError`] where a move cannot be planned.
    pub fn draw(draw: &mut Draw, style: &Style) -> Result<Self, PlanError> {
        let mut programme = Self::default();
        let mut time = draw.uniform(0.5, 0.9);
        programme.pauses.push([0.0, time]);
        let moves = if style.rich { 4 + draw.below(7) } else { 1 };
        let mut position = 0.0;
        for index in 0..moves {
            let target = next(draw, style, position);
            time = programme.add_move(time, [position, target], limits(draw, style))?;
            position = target;
            let pause = match index {
                _ if index + 1 == moves => draw.uniform(1.0, 1.8),
                1 => LONG_PAUSE,
                _ => draw.uniform(0.15, LONG_PAUSE),
            };
            programme.pauses.push([time, time + pause]);
            time += pause;
        }
        programme.duration = time;
        Ok(programme)
    }

    fn add_move(
        &mut self,
        start: f64,
        [from, to]: [f64; 2],
        limits: Limits,
    ) -> Result<f64, PlanError> {
        let (from, to) = (AxisState::at_rest(from), AxisState::at_rest(to));
        let planned = Planner::new(1)?.plan(&[from], &[to], &[limits])?;
        for phase in planned.axes().iter().flat_map(|axis| axis.phases()) {
            self.phases.push(Phase {
                start: start + phase.start,
                state: phase.state,
                jerk: phase.jerk,
            });
        }
        let end = start + planned.duration();
        self.phases.push(Phase {
            start: end,
            state: to,
            jerk: 0.0,
        });
        Ok(end)
    }

    /// Position, velocity and acceleration.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let index = self.phases.partition_point(|phase| phase.start <= time);
        let Some(phase) = index.checked_sub(1).map(|index| &self.phases[index]) else {
            return [
                self.phases.first().map_or(0.0, |p| p.state.position),
                0.0,
                0.0,
            ];
        };
        let state = phase.state.after(time - phase.start, phase.jerk);
        [state.position, state.velocity, state.acceleration]
    }

    /// Instants at which the jerk steps.
    pub fn corners(&self) -> impl Iterator<Item = f64> + '_ {
        self.phases.iter().map(|phase| phase.start)
    }

    /// Least and greatest position.
    pub fn span(&self) -> [f64; 2] {
        let ends = self.phases.iter().map(|phase| phase.state.position);
        ends.fold([0.0, 0.0], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// The same moves, stretched or shrunk in position by a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        for phase in &mut scaled.phases {
            phase.state.position *= factor;
            phase.state.velocity *= factor;
            phase.state.acceleration *= factor;
            phase.jerk *= factor;
        }
        scaled
    }
}

/// Another position, at least a twelfth of the range away.
fn next(draw: &mut Draw, style: &Style, position: f64) -> f64 {
    let (range, far) = (style.range, style.range / 12.0);
    let from = if style.rich { far } else { 0.6 * range };
    let size = draw.log_uniform(from, 1.6 * range);
    let (up, down) = (position + size, position - size);
    match (up <= range, down >= -range) {
        (true, true) => position + draw.sign() * size,
        (true, false) => up,
        (false, true) => down,
        (false, false) => -position.signum() * range * draw.uniform(0.3, 1.0),
    }
}

fn limits(draw: &mut Draw, style: &Style) -> Limits {
    let slowest = if style.rich { 0.35 } else { 0.7 };
    let acceleration = style.acceleration * draw.uniform(slowest, 1.0);
    Limits {
        velocity: style.velocity * draw.uniform(slowest, 1.0),
        acceleration,
        jerk: acceleration * style.natural_frequency * draw.log_uniform(0.3, 2.0),
    }
}
