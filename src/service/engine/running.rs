//! A move from its first tick until its vibration has decayed.

use quell_shapers::{Mode, Setpoint};
use quell_trajectories::{AxisState, SampledTrajectory};

use super::cruise::Cruise;
use super::learned::WITHIN;
use super::pacing::Pacing;
use crate::controller::setpoint;
use crate::estimators::Sample;
use crate::service::contract::{MoveEnd, MoveResult, MoveStart, TickRow};
use crate::service::following::FOLLOWED;
use crate::service::ringing;

/// Number of periods for which a joint is observed after its command has ended: the amplitude is taken over two
/// of them, after the motor side has followed.
const WATCHED: f64 = 3.0;
/// Rounding of velocities and accelerations by the planner and of differences over one tick.
pub const ROUNDING: f64 = 1e-9;
/// Most planned positions that are kept for the unshaped vibration; a minute at 4 kHz.
const LONGEST: usize = 240_000;

/// A move.
pub struct Running {
    /// The entry that was made when it began.
    pub start: MoveStart,
    /// Name of its recording, once it is on the disk.
    pub recording: Option<String>,
    /// Its present plan: the move's own, or that of a stop.
    pub plan: SampledTrajectory,
    /// Number of that plan.
    pub ticket: u64,
    /// Tick with which the present plan began.
    pub tick: u64,
    /// The sample of the plan that was sent then.
    pub first: usize,
    /// The rate of its plan.
    pub pacing: Pacing,
    /// Largest speed that was asked for, rad/s; infinite where only the limits bound it.
    pub speed: f64,
    /// Whether it began in motion.
    pub turned: bool,
    /// Number of the move of several joints that it is part of.
    pub together: Option<u64>,
    /// Whether a train other than the identity was in force.
    pub shaped: bool,
    /// Whether the train followed the estimate.
    pub adaptive: bool,
    /// Payload of the embedded arm, kg.
    pub payload: Option<f64>,
    /// Whether it is being stopped.
    pub stopping: bool,
    /// Why it ends: at its target, unless something interrupts it.
    pub ends: MoveEnd,
    /// The fault that is to stop it, in a sentence.
    pub fault: Option<String>,
    /// Time at which its command stopped, s.
    pub settled: Option<f64>,
    /// Planned positions, one for each tick.
    pub planned: Vec<f64>,
    /// Deformation after its end: stamp, rad, m.
    pub after: Vec<(f64, f64, f64)>,
    /// Deformation in cruise.
    pub cruise: Cruise,
    /// Samples since its start.
    pub heard: Vec<Sample>,
    /// Positions of the joints at its start, rad.
    pub before: Vec<f64>,
    /// Whether a sensor of it was at fault during the move.
    pub frozen: bool,
    /// Whether its train was solved for it.
    pub prescribed: bool,
}

/// Most samples of a move that are kept: the longest window of an estimator.
const MOST_HEARD: usize = 65_536;

impl Running {
    /// State of the plan at the tick before `tick`, at which another plan begins.
    pub fn state_before(&self, tick: u64) -> AxisState {
        let end = AxisState::at_rest(self.target());
        self.plan.state(0, self.sample_before(tick)).unwrap_or(end)
    }

    /// The sample of the plan that is sent at the tick before `tick`.
    pub fn sample_before(&self, tick: u64) -> usize {
        let passed = tick.saturating_sub(1).saturating_sub(self.tick) as usize;
        self.first.saturating_add(passed)
    }

    /// Positions of the plan from the tick before `tick` to its end.
    pub fn positions_from(&self, tick: u64) -> &[f64] {
        let positions = self.plan.positions(0);
        let last = positions.len().saturating_sub(1);
        &positions[self.sample_before(tick).min(last)..]
    }

    /// The plan at a sample.
    pub fn planned_at(&self, sample: usize) -> Setpoint {
        let end = AxisState::at_rest(self.target());
        setpoint(self.plan.state(0, sample).unwrap_or(end))
    }

    /// Whether the plan has not ended by the tick before `tick`.
    pub fn goes_on(&self, tick: u64) -> bool {
        self.settled.is_none() && self.sample_before(tick) + 1 < self.plan.samples()
    }

    /// Replaces the rest of the plan from a tick on, at which this sample of it is sent.
    pub fn go_on(&mut self, rest: &SampledTrajectory, (tick, first): (u64, usize)) {
        let sample = self.sample_before(tick);
        self.plan = self.plan.then(sample, rest);
        (self.tick, self.first) = (tick, sample + first);
    }

    /// End of the present plan, rad.
    pub fn target(&self) -> f64 {
        let last = self.plan.positions(0).last();
        last.copied().unwrap_or(self.start.target_rad)
    }

    /// Whether it does not end at its target.
    pub fn is_interrupted(&self) -> bool {
        self.ends != MoveEnd::Target
    }

    /// A plan that is not its own takes over. The first reason counts.
    pub fn interrupt(&mut self, why: MoveEnd) {
        if self.settled.is_none() && !self.is_interrupted() {
            self.ends = why;
        }
    }

    /// It is brought to rest: for its fault, if there is one, else on request.
    pub fn stop(&mut self) {
        self.stopping = self.settled.is_none();
        self.interrupt(match self.fault {
            Some(_) => MoveEnd::Fault,
            None => MoveEnd::Stopped,
        });
    }

    /// Takes command and measurement of a tick.
    pub fn take(&mut self, row: &TickRow) {
        match self.settled {
            None if self.planned.len() < LONGEST => {
                self.planned.push(row.planned);
                self.cruise.take(row);
            }
            Some(settled) if row.time > settled + FOLLOWED => self.listen(row),
            _ => {}
        }
    }

    /// Takes a sample of the deformation.
    pub fn hear(&mut self, sample: Sample) {
        if self.heard.len() < MOST_HEARD {
            self.heard.push(sample);
        }
    }

    fn listen(&mut self, row: &TickRow) {
        let newer = self
            .after
            .last()
            .is_none_or(|last| row.deformation_time > last.0);
        if newer && row.deformation.is_finite() {
            let sample = (row.deformation_time, row.deformation, row.tip_deformation);
            self.after.push(sample);
        }
    }

    /// Whether it has been observed long enough at `now` (s).
    pub fn has_rung_out(&self, now: f64, mode: Mode) -> bool {
        let watch = FOLLOWED + WATCHED * mode.damped_period();
        self.settled.is_some_and(|settled| now - settled > watch)
    }

    /// Planned positions up to the end of the plan; later rows belong to the train.
    pub fn planned_motion(&self) -> &[f64] {
        let end = self.planned.windows(2).rposition(|pair| pair[0] != pair[1]);
        &self.planned[..end.map_or(0, |last| last + 2)]
    }

    /// Its residual vibration. `mode` is the best known one; `sure` if it was learned.
    pub fn result(&self, mode: Mode, sure: bool, period: f64, radius: Option<f64>) -> MoveResult {
        let samples: Vec<_> = self
            .after
            .iter()
            .map(|&(time, value, _)| (time, value))
            .collect();
        let residual = ringing::amplitude(&samples, mode, sure);
        // The plan of a move within a tolerance is not that of the unshaped move.
        let within = self.start.shaper == WITHIN;
        let unshaped = match self.shaped {
            _ if within => None,
            true => Some(ringing::unshaped(self.planned_motion(), period, mode)),
            false => residual,
        };
        let cruise = self.cruise.vibration(mode, sure);
        let vibration = residual.map(|residual| cruise.map_or(residual, |most| most.max(residual)));
        let unshaped_vibration = match self.shaped {
            _ if within => None,
            true => Some(ringing::unshaped_in_all(
                self.planned_motion(),
                period,
                mode,
            )),
            false => vibration,
        };
        let along_arc = |angle: Option<f64>| Some(angle? * radius?);
        let end = self
            .settled
            .unwrap_or(self.start.time_s + self.planned.len() as f64 * period);
        MoveResult {
            id: self.start.id,
            joint: self.start.joint.clone(),
            unix_time_s: self.start.unix_time_s,
            from_rad: self.start.from_rad,
            target_rad: self.target(),
            duration_s: end - self.start.time_s,
            shaper: self.start.shaper.clone(),
            shaped: self.shaped,
            adaptive: self.adaptive,
            interrupted: self.is_interrupted(),
            ended: Some(self.ends),
            fault: self.fault.clone().filter(|_| self.ends == MoveEnd::Fault),
            mode: Some(mode.into()),
            payload_kg: self.payload,
            residual_rad: residual,
            residual_m: along_arc(residual),
            unshaped_rad: unshaped,
            unshaped_m: along_arc(unshaped),
            vibration_rad: vibration,
            vibration_m: along_arc(vibration),
            unshaped_vibration_rad: unshaped_vibration,
            unshaped_vibration_m: along_arc(unshaped_vibration),
            unshaped_std_rad: None,
            modes: Vec::new(),
            recording: self.recording.clone(),
        }
    }
}
