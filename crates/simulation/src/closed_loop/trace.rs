//! The record of one move, and its key figures.

use quell_shapers::{ImpulseTrain, PeakRatios, Setpoint, UncertainMode, peak_ratios};
use quell_trajectories::Limits;

use quell_control::controller::motion_limits;
use quell_control::estimators::Estimate;
use quell_control::learning::{ModeOnWay, Prescription};
use quell_recording::Recording;
use quell_signal::{ArcRegistration, JointArc};

/// One tick of a move, with true values of the simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Time since the move began, s.
    pub time: f64,
    /// Planned, unshaped position, rad.
    pub planned: f64,
    /// Planned, unshaped acceleration, rad/s^2.
    pub planned_acceleration: f64,
    /// Commanded position, rad.
    pub position: f64,
    /// Commanded velocity, rad/s.
    pub velocity: f64,
    /// Commanded acceleration, rad/s^2.
    pub acceleration: f64,
    /// True motor-side position, rad.
    pub motor_position: f64,
    /// True deformation at the tip, along its arc, m.
    pub tip_deformation: f64,
    /// Deformation at the tip as measured last, m.
    pub measured: Option<f64>,
    /// The estimate after this tick.
    pub estimate: Option<Estimate>,
}

/// One move in the closed loop.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveTrace {
    /// Every tick, from the first of the plan until the end of the observation.
    pub ticks: Vec<Tick>,
    /// Control period, s.
    pub period: f64,
    /// Target of the move, rad.
    pub target: f64,
    /// End of the plan, s after its start.
    pub planned_end: f64,
    /// Last change of the command, s after the start.
    pub command_end: f64,
    /// Time from which the motor side's distance from the target is below 1 um at the tip, s.
    pub motor_end: f64,
    /// The tip's arc in the robot's base frame.
    pub arc: JointArc,
    /// Frame and clock of the tracker, as commissioning found them.
    pub registration: ArcRegistration,
    /// The samples of encoder and tracker, each on its own clock, and the command.
    pub recording: Recording,
    /// Train in force when the move ended.
    pub train: ImpulseTrain,
    /// Length of the longest train that was in force during the move, s.
    pub longest_train: f64,
    /// Mode of its design, with its uncertainty.
    pub shaped_for: UncertainMode,
    /// Speed to which the move was slowed so that the shaped command keeps its limits, 0 to 1.
    pub slowed_to: Option<f64>,
    /// Trains changed during the move.
    pub retunes: u32,
    /// Corrections refused during the move.
    pub refused: u32,
    /// Corrections sent during the move.
    pub corrections: u32,
    /// The prescription from earlier moves, if the train follows the estimate.
    pub prescribed: Option<Prescription>,
}

impl MoveTrace {
    /// Peak of the true deformation at the tip, m, after the command has ended and the motor side has followed
    /// (to 1 um). Before that the deformation is still forced.
    pub fn residual(&self) -> f64 {
        self.ticks
            .iter()
            .filter(|tick| tick.time >= self.motor_end)
            .fold(0.0, |peak, tick| peak.max(tick.tip_deformation.abs()))
    }

    /// Peak of the true deformation at the tip without planned acceleration, m: in cruise and at the end.
    ///
    /// A phase of planned acceleration is extended by the length of the longest train, and by the time in which
    /// the motor side follows at the end of the command: until then the deformation is forced.
    pub fn vibration(&self) -> f64 {
        let quiet = self.quiet();
        let seen = self.ticks.iter().zip(quiet).filter(|(_, quiet)| *quiet);
        seen.fold(0.0, |peak, (tick, _)| peak.max(tick.tip_deformation.abs()))
    }

    /// For each tick, whether the plan neither accelerates nor has done so shortly before, as in
    /// [`MoveTrace::vibration`].
    pub fn quiet(&self) -> Vec<bool> {
        let follows = self.longest_train + (self.motor_end - self.command_end).max(0.0);
        let mut until = f64::NEG_INFINITY;
        let quiet = |tick: &Tick| {
            if tick.planned_acceleration != 0.0 {
                until = tick.time + follows;
            }
            tick.time > until
        };
        self.ticks.iter().map(quiet).collect()
    }

    /// Time from the start of the move until the tip stays within `tolerance` (m) of its target, s;
    /// `None` if it does not within the trace.
    pub fn settling_time(&self, tolerance: f64) -> Option<f64> {
        let outside = |tick: &Tick| {
            let rigid = (tick.motor_position - self.target) * self.arc.radius();
            (rigid + tick.tip_deformation).abs() > tolerance
        };
        match self.ticks.iter().rposition(outside) {
            None => Some(0.0),
            Some(last) => self.ticks.get(last + 1).map(|tick| tick.time),
        }
    }

    /// `|last commanded position - target|`, rad.
    pub fn final_error(&self) -> f64 {
        self.ticks
            .last()
            .map_or(f64::INFINITY, |tick| (tick.position - self.target).abs())
    }

    /// The delay that shaping and corrections added to the command, s.
    pub fn added_delay(&self) -> f64 {
        self.command_end - self.planned_end
    }

    /// Largest velocity, acceleration and jerk of the command over their limits.
    pub fn peak_ratios(&self, limits: Limits) -> PeakRatios {
        let command = self.ticks.iter().map(|tick| Setpoint {
            position: tick.position,
            velocity: tick.velocity,
            acceleration: tick.acceleration,
        });
        peak_ratios(command, &motion_limits(limits), self.period)
    }

    /// The modes known after the move, each for all places of the way: the learned ones, else the one that is
    /// shaped for.
    pub fn known_modes(&self) -> Vec<UncertainMode> {
        let learned = self.prescribed.iter().flat_map(|one| &one.modes);
        let learned: Vec<_> = learned.map(ModeOnWay::anywhere).collect();
        match learned.is_empty() {
            true => vec![self.shaped_for],
            false => learned,
        }
    }

    /// The first tick at which the estimate had converged, and that estimate.
    pub fn converged(&self) -> Option<(f64, Estimate)> {
        self.ticks.iter().find_map(|tick| {
            let estimate = tick.estimate.filter(|estimate| estimate.converged)?;
            Some((tick.time, estimate))
        })
    }

    /// The last estimate of the move.
    pub fn last_estimate(&self) -> Option<Estimate> {
        self.ticks.iter().rev().find_map(|tick| tick.estimate)
    }
}
