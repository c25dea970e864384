//! The behaviour of a service that does as it is told, held against this one.

use proptest::prelude::*;
use quell::service::contract::{Accepted, EnableState, Phase, Request, ServiceError};
use quell_shapers::Setpoint;

use super::world::{Answered, PERIOD, Sent, WATCHDOG, World, beyond_limits};

/// Seconds after an answer within which a stop begins, beside its own duration: it is planned 20 ms
/// ahead, and the train of four periods at most lasts on.
const STOP_SLACK: f64 = 0.02 + 0.4 + 3.0 * PERIOD;
/// A slow start after a long gap falls back by so much, s: 1 / k of the limits, rounded up.
const SLOW_START: f64 = 0.25;
/// Measurements that wait for a tick; one more is lost. And so many are taken in each.
const WAITING: usize = 8 * INBOX;
const INBOX: usize = 128;

/// Why the command may move.
#[derive(Clone, Debug, PartialEq)]
enum Licence {
    /// Nobody has asked for anything.
    None,
    /// A move runs to its target.
    Move { target: f64 },
    /// The joint was told to stop: by this time it rests, wherever that is.
    Stop { until: f64 },
}

/// The behaviour of a service that does as it is told.
pub struct Oracle {
    licence: Licence,
    /// Whether somebody has enabled moves, and neither fault nor disabling came since.
    enabled: bool,
    faults: u64,
    /// Whether a move was asked for and not answered before the last step.
    pub asked: bool,
    /// The last request that was obeyed.
    obeyed: usize,
    seen: usize,
    last: Option<Sent>,
    /// When the robot was silent last for about as long as the watchdog allows, s: it may have stopped what
    /// ran.
    silent: f64,
    /// When what runs was asked for, s.
    asked_at: f64,
    /// When a slow start after a gap may still go on, s.
    slow_until: f64,
    /// Measurements that no tick has taken yet, where some were lost for that.
    unread: usize,
    lost: bool,
    pub timed: bool,
}

impl Oracle {
    pub fn new(timed: bool) -> Self {
        Self {
            licence: Licence::None,
            enabled: false,
            faults: 0,
            seen: 0,
            last: None,
            asked: false,
            obeyed: 0,
            silent: f64::NEG_INFINITY,
            asked_at: 0.0,
            slow_until: 0.0,
            unread: 0,
            lost: false,
            timed,
        }
    }

    pub fn hear(&mut self, answered: &Answered, now: f64) -> Result<(), TestCaseError> {
        if let (Request::Move { .. }, Ok(_)) = (&answered.request, &answered.answer) {
            prop_assert!(self.enabled, "a move begins that nobody has enabled");
        }
        match (&answered.request, &answered.answer) {
            // One that began is ended by what was asked for later.
            (Request::Move { target, .. }, Ok(Accepted::Move { .. }))
                if answered.number >= self.obeyed =>
            {
                self.licence = Licence::Move { target: *target };
                self.asked_at = answered.at;
                self.obeyed = answered.number;
            }
            (Request::Stop, answer) => {
                let Ok(Accepted::Stop { duration_s, .. }) = answer else {
                    return Err(TestCaseError::fail(format!("a stop: {answer:?}")));
                };
                let slow = if now < self.slow_until {
                    SLOW_START
                } else {
                    0.0
                };
                let until = now + duration_s + STOP_SLACK + slow;
                self.licence = Licence::Stop { until };
                self.obeyed = answered.number;
            }
            (_, Ok(Accepted::EnableState { state })) => {
                self.enabled = *state == EnableState::Enabled;
                if answered.request == Request::Disable {
                    self.stop_within(now);
                    self.obeyed = answered.number;
                }
            }
            (_, Err(ServiceError::Gone)) => prop_assert!(false, "the engine has ended"),
            _ => {}
        }
        Ok(())
    }

    /// Judges what was sent since.
    pub fn judge(&mut self, world: &World) -> Result<(), TestCaseError> {
        let sent = world.sent();
        for &now in &sent[self.seen..] {
            self.take(now, world)?;
        }
        self.seen = sent.len();
        Ok(())
    }

    fn take(&mut self, now: Sent, world: &World) -> Result<(), TestCaseError> {
        let Some(before) = self.last.replace(now) else {
            prop_assert!(
                rests(&now.1) && now.1.position == world.robot.position,
                "{now:?}"
            );
            return Ok(());
        };
        if now.1.position == before.1.position && rests(&now.1) && rests(&before.1) {
            return Ok(());
        }
        // A joint that was moved by something else is commanded anew from where it stands.
        let anew = (now.1.position - world.robot.position).abs() < 1e-9 && rests(&now.1);
        if anew && now.0 - before.0 > 0.1 && rests(&before.1) {
            return Ok(());
        }
        prop_assert_eq!(beyond_limits(before, now, self.timed), None);
        match self.licence {
            _ if self.asked => {}
            Licence::None => prop_assert!(false, "nobody asked for {before:?} {now:?}"),
            Licence::Move { .. } => {}
            Licence::Stop { until } => {
                prop_assert!(
                    now.0 <= until,
                    "it goes on after a stop until {until}: {now:?}"
                );
            }
        }
        Ok(())
    }

    /// The state shows what was sent.
    pub fn compare(&mut self, world: &World) -> Result<(), TestCaseError> {
        let snapshot = world.snapshot();
        let (Some(joint), Some((_, last))) = (snapshot.joints.first(), self.last) else {
            return Ok(());
        };
        if let Some((_, shown)) = world
            .sent()
            .iter()
            .rfind(|(time, _)| *time == snapshot.time_s)
        {
            prop_assert_eq!(joint.command_rad, shown.position);
            prop_assert_eq!(joint.command_rad_s, shown.velocity);
        }
        // Published some ticks ago, it may be older than what was sent last.
        let fresh = world.clock.now() - snapshot.time_s < 0.5 * PERIOD;
        if fresh && joint.phase == Phase::Rest {
            prop_assert!(rests(&last), "it shows rest: {last:?}");
        }
        if let Licence::Move { target } = &self.licence
            && fresh
            && self.silent < self.asked_at
            && joint.phase == Phase::Moving
        {
            prop_assert_eq!(joint.target_rad, *target);
        }
        Ok(())
    }

    /// The effect of the robot's silence, or of time without a tick, on what runs.
    pub fn watch(&mut self, world: &World) {
        let now = world.clock.now();
        let silence = now - world.heard;
        if silence > WATCHDOG - 2.0 * PERIOD {
            self.silent = now;
        }
        // Of too many measurements the last are lost: the joint is not heard until one comes that is not.
        self.unread = self.unread.saturating_sub(INBOX - 1);
        if self.lost {
            self.silent = now;
            self.lost = self.unread > 0 || silence > 1.5 * PERIOD;
        }
        let faults = world.snapshot().enable.faults;
        if faults > self.faults {
            (self.faults, self.silent) = (faults, now);
            // It may have been enabled again since, in the same round of the engine.
            self.enabled &= world.snapshot().enable.state == EnableState::Enabled;
            if let Licence::Move { .. } = self.licence {
                self.stop_within(now);
            }
        }
        let noticed = silence > WATCHDOG + 3.0 * PERIOD && world.engine_sleeps == 0;
        if noticed && let Licence::Move { .. } = self.licence {
            self.stop_within(now);
        }
    }

    /// What runs is stopped from now on.
    fn stop_within(&mut self, now: f64) {
        if self.licence == Licence::None {
            return;
        }
        let slow = match now < self.slow_until {
            true => SLOW_START,
            false => 0.0,
        };
        // The longest stop from full speed, within the limits.
        let until = now + 0.2 + STOP_SLACK + slow;
        self.licence = Licence::Stop { until };
    }

    pub fn delayed(&mut self, ticks: usize, now: f64) {
        let by = ticks as f64 * PERIOD;
        self.unread += ticks;
        self.lost |= self.unread > WAITING;
        self.slow_until = now + 2.0 * SLOW_START;
        if let Licence::Stop { until } = &mut self.licence {
            *until += by + SLOW_START;
        }
    }

    /// Everything rests, and where it should.
    pub fn judge_end(&self, world: &World) -> Result<(), TestCaseError> {
        let Some((_, last)) = self.last else {
            return Ok(());
        };
        prop_assert!(rests(&last), "it does not come to rest: {last:?}");
        if let Licence::Move { target } = self.licence
            && self.silent < self.asked_at
        {
            prop_assert_eq!(last.position, target);
        }
        let joint = world.joint();
        prop_assert!(
            matches!(joint.phase, Phase::Rest | Phase::Waiting),
            "{:?}",
            joint.phase
        );
        Ok(())
    }
}

fn rests(setpoint: &Setpoint) -> bool {
    setpoint.velocity == 0.0 && setpoint.acceleration == 0.0
}
