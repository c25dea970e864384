//! Moves that may be proposed: within what was seen, of every sort that brings effects to light.
//!
//! Fast moves and their settling show modes, damping, stiffness and lags; half and small ones what is
//! not linear; slow ones friction, ripple and gravity; repeated ones what is lost and gained in a
//! reversal; long pauses creep, drift and clocks.

use super::seen::Seen;
use crate::diagnosis::document::ProposedMove;
use quell_trajectories::{AxisState, Limits, PlanError, Planner, SampledTrajectory};

/// Moves one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Programme {
    /// The moves.
    pub moves: Vec<ProposedMove>,
    /// How they follow each other, such as `there and back 3 times`.
    pub manner: String,
}

/// Lengths of pauses, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pauses {
    /// In which nothing settles.
    pub short: f64,
    /// In which vibration dies away.
    pub settled: f64,
    /// In which what is slow shows.
    pub long: f64,
}

/// Shares of the greatest speed and acceleration.
const PACES: &[(f64, f64)] = &[(1.0, 1.0), (1.0, 0.3), (0.3, 1.0), (0.1, 1.0), (0.03, 1.0)];
/// Shares of the way to the farther end of the range.
const DISTANCES: &[f64] = &[1.0, 0.5, 0.125];
/// Share of the range that must lie on either side for a move from end to end.
const BOTH_SIDES: f64 = 0.1;
/// Steps of a staircase.
const STEPS: usize = 4;

/// All candidates that last no longer than `longest`, s, for an axis whose moves are told in `unit`.
pub fn candidates(seen: &Seen, pauses: Pauses, longest: f64, unit: &str) -> Vec<Programme> {
    let (down, up) = (seen.range.0 - seen.start, seen.range.1 - seen.start);
    let (far, near) = if up >= -down { (up, down) } else { (down, up) };
    let mut found: Vec<Programme> = Vec::new();
    let mut add = |distances: &[f64], limits: &Limits, pause: f64, manner: &str| {
        let moves = distances
            .iter()
            .map(|d| proposed(*d, limits, pause, unit))
            .collect::<Result<Vec<_>, _>>();
        let Ok(moves) = moves else { return };
        let manner = manner.to_string();
        let programme = Programme { moves, manner };
        let new = found.iter().all(|other| other.moves != programme.moves);
        if new && programme.duration().is_some_and(|d| d <= longest) {
            found.push(programme);
        }
    };
    for &(speed, acceleration) in PACES {
        let limits = Limits {
            velocity: speed * seen.limits.velocity,
            acceleration: acceleration * seen.limits.acceleration,
            jerk: seen.limits.jerk,
        };
        for d in DISTANCES.iter().map(|share| share * far) {
            add(&[d, -d], &limits, pauses.settled, "there and back");
            add(
                &[d, -d],
                &limits,
                pauses.long,
                "there and back with long pauses",
            );
            let times = [d, -d].repeat(3);
            add(
                &times,
                &limits,
                pauses.short,
                "there and back 3 times without rest",
            );
            add(&times, &limits, pauses.settled, "there and back 3 times");
        }
        let mut stairs = vec![far / STEPS as f64; STEPS];
        stairs.push(-far);
        add(&stairs, &limits, pauses.settled, "in steps and back");
        if near.abs() > BOTH_SIDES * (up - down) {
            let sweep = [far, near - far, -near];
            add(&sweep, &limits, pauses.settled, "from end to end and back");
        }
    }
    found
}

/// A move whose numbers are short ones: what it reaches at most, no more than the limits.
fn proposed(d: f64, limits: &Limits, pause: f64, unit: &str) -> Result<ProposedMove, PlanError> {
    let distance = shortened(d);
    let reached = plan(0.0, distance, limits)?;
    let most = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    // Fine enough that the greatest values are met within a hundredth.
    let sampled = reached.sample(reached.duration() / 1000.0)?;
    let above = |peak: f64, limit: f64| shortened((1.01 * peak).min(limit));
    Ok(ProposedMove {
        distance,
        speed: above(most(sampled.velocities(0)), limits.velocity),
        acceleration: above(most(sampled.accelerations(0)), limits.acceleration),
        jerk: shortened(limits.jerk),
        pause_s: (100.0 * pause).ceil() / 100.0,
        unit: unit.to_string(),
    })
}

fn plan(from: f64, to: f64, limits: &Limits) -> Result<quell_trajectories::Trajectory, PlanError> {
    let ends = [from, to].map(AxisState::at_rest);
    Planner::new(1)?.plan(&ends[..1], &ends[1..], std::slice::from_ref(limits))
}

/// Towards zero, to three digits.
fn shortened(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    let (up, down) = (10f64.powi(digits.max(0)), 10f64.powi((-digits).max(0)));
    // A product a hair below a whole number is that number.
    (value * up / down * (1.0 + 1e-12)).trunc() * down / up
}

impl Programme {
    /// How long it lasts, s.
    pub fn duration(&self) -> Option<f64> {
        let lasts = |one: &ProposedMove| {
            let planned = plan(0.0, one.distance, &limits(one)).ok()?;
            Some(planned.duration() + one.pause_s)
        };
        self.moves.iter().map(lasts).sum()
    }

    /// Positions of the motor side at multiples of `period` (s): a rest of `lead` seconds at `start`,
    /// and the moves.
    ///
    /// # Errors
    /// [`PlanError`] where a move cannot be planned or is too long.
    pub fn positions(&self, start: f64, lead: f64, period: f64) -> Result<Vec<f64>, PlanError> {
        let mut position = start;
        let mut all = vec![position; rest(lead, period)];
        for one in &self.moves {
            let target = position + one.distance;
            let planned = plan(position, target, &limits(one))?;
            let sampled: SampledTrajectory = planned.sample(period)?;
            all.extend(sampled.positions(0));
            all.extend(vec![target; rest(one.pause_s, period)]);
            position = target;
        }
        Ok(all)
    }
}

fn rest(seconds: f64, period: f64) -> usize {
    (seconds / period).ceil() as usize
}

fn limits(one: &ProposedMove) -> Limits {
    Limits {
        velocity: one.speed,
        acceleration: one.acceleration,
        jerk: one.jerk,
    }
}
