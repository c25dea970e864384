//! Learns the modes of the joints from their moves, and solves trains for the next moves.
//!
//! It runs beside the engine, which does not wait for it: a fit takes from a few milliseconds to some tenths of
//! a second. The tick does not depend on it.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};

use quell_shapers::GridTrain;
use quell_trajectories::SampledTrajectory;

use super::contract::JointMap;
use super::following::FOLLOWED;
use crate::estimators::Sample;
use crate::learning::{
    Account, Learner, LearnerSettings, Memory, ModeOnWay, Prescription, Seen, Surroundings,
};

use crate::tolerance::{Moving, Tolerance, ToleranceError, fastest};

/// Number of positions of a map.
const DRAWN: usize = 64;

/// Engine to learner. Joints are counted from 0.
pub enum Job {
    /// Solve the train for a plan.
    Prescribe(Box<Wanted>),
    /// Solve a move within a tolerance.
    Within(Box<Within>),
    /// Evaluate a move during its motion.
    Along(Box<Along>),
    /// A move has ended and its vibration has decayed.
    Ended(Box<Ended>),
    /// Forget a joint.
    Forget(usize),
}

/// A plan for which a train is wanted.
pub struct Wanted {
    /// The joint.
    pub joint: usize,
    /// Number of the plan.
    pub ticket: u64,
    /// The plan.
    pub plan: SampledTrajectory,
    /// Conditions along its way besides the joint itself.
    pub surroundings: Surroundings,
    /// The train of the plan if none is prescribed.
    pub in_force: GridTrain,
    /// The train without adaptation.
    pub base: GridTrain,
    /// Whether the plan may be stopped anywhere on its way, as in a jog.
    pub anywhere: bool,
}

/// A move during its motion.
pub struct Along {
    /// The joint.
    pub joint: usize,
    /// Number of the question.
    pub ticket: u64,
    /// Its samples so far.
    pub heard: Vec<Sample>,
    /// The plan.
    pub plan: SampledTrajectory,
    /// Conditions along its way besides the joint itself.
    pub surroundings: Surroundings,
    /// The train in force.
    pub in_force: GridTrain,
}

/// A move within a tolerance.
pub struct Within {
    /// Number of the move.
    pub ticket: u64,
    /// Its joints.
    pub members: Vec<Member>,
    /// The allowed residual and deviation.
    pub tolerance: Tolerance,
    /// Control period, s.
    pub period: f64,
}

/// A joint of a move within a tolerance.
pub struct Member {
    /// The joint.
    pub joint: usize,
    /// Its plan at the limits.
    pub plan: SampledTrajectory,
    /// Conditions along its way besides the joint itself.
    pub surroundings: Surroundings,
    /// Its ends and limits, with the mode that is known during motion.
    pub moving: Moving,
}

/// A move that has ended.
pub struct Ended {
    /// The joint.
    pub joint: usize,
    /// Number of the move.
    pub id: u64,
    /// Its samples, from its start until it has rung out.
    pub heard: Vec<Sample>,
    /// Its plan.
    pub plan: SampledTrajectory,
    /// Conditions along its way besides the joint itself.
    pub surroundings: Surroundings,
    /// Planned positions, one each control period, rad.
    pub planned: Vec<f64>,
    /// Stamps and deformations in each stretch in which the command did not accelerate.
    pub cruise: Vec<Vec<(f64, f64)>>,
    /// The same after the command had stopped and the motor side had followed.
    pub after: Vec<(f64, f64)>,
    /// Whether the learner learns from it; otherwise it is only judged.
    pub teaches: bool,
    /// Whether it used the train that was prescribed last.
    pub prescribed: bool,
}

/// Learner to engine.
pub enum Said {
    /// The train for a plan.
    Prescribed {
        /// The joint.
        joint: usize,
        /// Number of the plan.
        ticket: u64,
        /// The prescription for it.
        prescription: Box<Prescription>,
    },
    /// The evaluation of a move during its motion; no prescription if nothing is to be changed.
    Along {
        /// The joint.
        joint: usize,
        /// Number of the question.
        ticket: u64,
        /// The prescription for the rest of the move.
        prescription: Option<Box<Prescription>>,
    },
    /// The move within a tolerance, or the reason why there is none.
    Within {
        /// Number of the move.
        ticket: u64,
        /// The conditions of the solution, joint by joint.
        moving: Vec<Moving>,
        /// The motion of each joint.
        found: Result<Vec<SampledTrajectory>, ToleranceError>,
    },
    /// A move was judged.
    Judged(Box<Judged>),
    /// The present knowledge of a joint.
    Known {
        /// The joint.
        joint: usize,
        /// Number of its modes.
        modes: usize,
        /// For storage.
        memory: Memory,
        /// For display.
        map: Arc<JointMap>,
    },
}

/// A move that was judged.
pub struct Judged {
    /// The joint.
    pub joint: usize,
    /// Number of the move.
    pub id: u64,
    /// Its account, if its modes explain it.
    pub account: Option<Account>,
    /// The known modes on its way.
    pub modes: Vec<ModeOnWay>,
}

/// A joint that is to learn.
pub struct Pupil {
    /// Name.
    pub name: String,
    /// How it learns.
    pub settings: LearnerSettings,
    /// Lowest and highest target, rad.
    pub range: [f64; 2],
    /// Stored knowledge of it.
    pub memory: Option<Memory>,
}

/// The learners of all joints.
pub struct Learners {
    joints: Vec<(Learner, Pupil)>,
    jobs: Receiver<Job>,
    said: Sender<Said>,
    /// Gone with the engine.
    engine: Weak<()>,
}

/// The engine's end of the channels to the learners.
pub struct Lessons {
    /// To the learners.
    pub jobs: Sender<Job>,
    /// From them.
    pub said: Receiver<Said>,
    /// Tells them that somebody listens.
    _listens: Arc<()>,
}

impl Learners {
    /// Learners with their stored knowledge, and the engine's end of the channels.
    pub fn new(pupils: Vec<Pupil>) -> (Self, Lessons) {
        let ((jobs, taken), (told, said)) = (channel(), channel());
        let joints = pupils.into_iter().map(|mut pupil| {
            let mut learner = Learner::new(pupil.settings.clone());
            if let Some(memory) = pupil.memory.take() {
                // It was checked when the state was read.
                learner.remember(&memory);
            }
            (learner, pupil)
        });
        let listens = Arc::new(());
        let learners = Self {
            joints: joints.collect(),
            jobs: taken,
            said: told,
            engine: Arc::downgrade(&listens),
        };
        let all = 0..learners.joints.len();
        all.for_each(|joint| learners.tell(joint, &Surroundings::default()));
        let lessons = Lessons {
            jobs,
            said,
            _listens: listens,
        };
        (learners, lessons)
    }

    /// Learns until the engine is gone; what still waits then is for nobody.
    pub fn run(mut self) {
        while let Ok(job) = self.jobs.recv() {
            if self.engine.strong_count() == 0 {
                return;
            }
            self.do_one(job);
        }
    }

    /// One pass of [`Learners::run`], without waiting.
    pub fn work(&mut self) {
        while let Ok(job) = self.jobs.try_recv() {
            self.do_one(job);
        }
    }

    fn do_one(&mut self, job: Job) {
        match job {
            Job::Prescribe(wanted) => {
                let (learner, _) = &mut self.joints[wanted.joint];
                learner.set_base(wanted.base);
                let (plan, around) = (&wanted.plan, &wanted.surroundings);
                let prescription = match wanted.anywhere {
                    true => learner.prescribe_anywhere(plan, around, &wanted.in_force),
                    false => learner.prescribe(plan, around, &wanted.in_force),
                };
                // The engine may have ended, here and below.
                let _ = self.said.send(Said::Prescribed {
                    joint: wanted.joint,
                    ticket: wanted.ticket,
                    prescription: Box::new(prescription),
                });
            }
            Job::Within(within) => self.within(*within),
            Job::Along(along) => {
                let (learner, _) = &self.joints[along.joint];
                let (plan, around) = (&along.plan, &along.surroundings);
                let found = learner.along(&along.heard, plan, around, &along.in_force);
                let _ = self.said.send(Said::Along {
                    joint: along.joint,
                    ticket: along.ticket,
                    prescription: found.map(Box::new),
                });
            }
            Job::Ended(ended) => self.hear(&ended),
            Job::Forget(joint) => {
                self.joints[joint].0.forget();
                self.tell(joint, &Surroundings::default());
            }
        }
    }

    /// Solves a move within a tolerance, with the modes of its ways if they are known.
    fn within(&self, within: Within) {
        let each = within.members.into_iter().map(|member| {
            let (learner, _) = &self.joints[member.joint];
            let modes = learner.on_way(&member.plan, &member.surroundings);
            let mut moving = member.moving;
            if !modes.is_empty() {
                moving.modes = modes.iter().map(ModeOnWay::anywhere).collect();
            }
            moving
        });
        let moving: Vec<Moving> = each.collect();
        let found = fastest(&moving, within.tolerance, within.period);
        let _ = self.said.send(Said::Within {
            ticket: within.ticket,
            moving,
            found: found.map(|found| found.plans),
        });
    }

    fn hear(&mut self, ended: &Ended) {
        let (learner, pupil) = &mut self.joints[ended.joint];
        if !ended.prescribed {
            learner.withdraw();
        }
        let mut aside;
        // A move that is only judged does not change the knowledge.
        let learner = match ended.teaches {
            true => learner,
            false => {
                aside = learner.clone();
                &mut aside
            }
        };
        let explained = learner.learn(&ended.heard, &ended.plan, &ended.surroundings);
        let seen = Seen {
            planned: &ended.planned,
            period: ended.plan.period(),
            cruise: &ended.cruise,
            after: &ended.after,
            follows: FOLLOWED,
        };
        let judged = Judged {
            joint: ended.joint,
            id: ended.id,
            account: explained.map(|explained| explained.account(&seen)),
            modes: learner.on_way(&ended.plan, &ended.surroundings),
        };
        tracing::debug!(joint = pupil.name, modes = judged.modes.len(), account = ?judged.account, "judged");
        let _ = self.said.send(Said::Judged(Box::new(judged)));
        if ended.teaches {
            self.tell(ended.joint, &ended.surroundings);
        }
    }

    fn tell(&self, joint: usize, surroundings: &Surroundings) {
        let (learner, pupil) = &self.joints[joint];
        let [low, high] = pupil.range;
        let step = (high - low) / (DRAWN - 1) as f64;
        let positions: Vec<f64> = (0..DRAWN).map(|k| low + step * k as f64).collect();
        let chart = learner.chart(&positions, surroundings);
        let map = JointMap::new(&pupil.name, surroundings.payload, &chart);
        let _ = self.said.send(Said::Known {
            joint,
            modes: learner.modes(),
            memory: learner.memory(),
            map: Arc::new(map),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_learned_for_an_engine_that_is_gone() {
        let (learners, lessons) = Learners::new(Vec::new());
        // There is no such joint: whoever did this job would break down.
        lessons.jobs.send(Job::Forget(0)).expect("a listener");
        drop(lessons);
        learners.run();
    }
}
