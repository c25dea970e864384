//! The record of a move on a path, and its departure from the path.

use super::{MoveTrace, Tick};

/// One move of all joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTrace {
    /// Start positions of the joints, rad.
    pub from: Vec<f64>,
    /// The move of each joint; all have the same ticks.
    pub joints: Vec<MoveTrace>,
}

impl PathTrace {
    /// Largest distance of the command from the straight line between start and target in joint space, rad.
    pub fn command_departure(&self) -> f64 {
        self.departure(|_, tick| tick.position)
    }

    /// Largest distance of the links, vibration included, from the same line, rad.
    pub fn link_departure(&self) -> f64 {
        self.departure(|joint, tick| {
            tick.motor_position + tick.tip_deformation / joint.arc.radius()
        })
    }

    /// Distance of the command from the line at every tick, rad.
    pub fn command_departures(&self) -> Vec<f64> {
        self.departures(|_, tick| tick.position)
    }

    /// Last change of any joint's command, s after the start.
    pub fn command_end(&self) -> f64 {
        let ends = self.joints.iter().map(|joint| joint.command_end);
        ends.fold(0.0, f64::max)
    }

    /// The delay that shaping and corrections added to the command, s.
    pub fn added_delay(&self) -> f64 {
        let planned = self.joints.iter().map(|joint| joint.planned_end);
        self.command_end() - planned.fold(0.0, f64::max)
    }

    fn departure(&self, of: impl Fn(&MoveTrace, &Tick) -> f64) -> f64 {
        self.departures(of).into_iter().fold(0.0, f64::max)
    }

    fn departures(&self, of: impl Fn(&MoveTrace, &Tick) -> f64) -> Vec<f64> {
        let ends = self.from.iter().zip(&self.joints);
        let line: Vec<f64> = ends.map(|(from, joint)| joint.target - from).collect();
        let length = dot(&line, &line);
        let count = self.joints.iter().map(|joint| joint.ticks.len()).min();
        let distance = |tick: usize| {
            let at = self.joints.iter().zip(&self.from);
            let at: Vec<f64> = at
                .map(|(joint, from)| of(joint, &joint.ticks[tick]) - from)
                .collect();
            let share = dot(&at, &line) / length;
            let beside = at.iter().zip(&line).map(|(at, line)| at - share * line);
            beside.map(|away| away * away).sum::<f64>().sqrt()
        };
        (0..count.unwrap_or(0)).map(distance).collect()
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
