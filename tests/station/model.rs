//! Random sequences of everything that a client, a robot, a clock, a disk and a killer can do to the service.
//!
//! What is judged is what comes out: setpoints, answers, the state that is shown, what is on disk. A few
//! hundred sequences here; `QUELL_SEQUENCES=10000` makes the campaign.

use std::path::Path;

use proptest::prelude::*;
use quell::recording::Recording;
use quell::service::contract::{Accepted, Phase, Request, ServiceError, ShapingChange};
use quell::service::disk::Disk;
use quell::service::recorder::Recorder;
use quell::service::state::StateFile;
use quell_shapers::Setpoint;

use super::world::{
    Answered, Asked, PERIOD, STANDSTILL, Sent, WATCHDOG, World, beyond_limits, config,
};

/// Sequences where nobody asks for more.
const SEQUENCES: u32 = 400;
/// Seconds after an answer within which a stop begins, beside its own duration: it is planned 20 ms
/// ahead, and the train of four periods at most lasts on.
const STOP_SLACK: f64 = 0.02 + 0.4 + 3.0 * PERIOD;
/// A slow start after a long gap falls back by so much, s: 1 / k of the limits, rounded up.
const SLOW_START: f64 = 0.25;
/// Steps after which what is told of is written down: a quarter of a second, and the engine may sleep.
const WRITTEN: usize = 120;
const JOINT: &str = "joint_1";

/// What somebody does.
#[derive(Clone, Debug)]
enum Op {
    Move {
        target: f64,
        shaper: Option<&'static str>,
    },
    Stop,
    Shaping {
        enabled: Option<bool>,
        kind: Option<&'static str>,
    },
    Payload(f64),
    Nonsense,
    Run(usize),
    RobotIsSilent,
    RobotSpeaks,
    /// The robot is switched off, moved by hand, and speaks again.
    RobotIsMoved(f64),
    RobotClockStartsAnew,
    /// What the robot says for so many ticks comes at once.
    Burst(usize),
    Garbage(Vec<u8>),
    TicksMissed(usize),
    EngineSleeps(usize),
    WallJumps(f64),
    /// The state cannot be written, or can be again.
    DiskRefuses(bool),
    /// The file of the state is cut.
    StateIsCut(usize),
    /// The process is killed, and another one started.
    Kill,
}

fn op() -> impl Strategy<Value = Op> {
    let shaper = prop_oneof![4 => Just(None), 1 => Just(Some("none")), 1 => Just(Some("zv"))];
    let kind = prop_oneof![Just(None), Just(Some("zv")), Just(Some("zvd"))];
    let targets = prop_oneof![Just(0.0), Just(0.3), Just(-0.4), -0.6..0.6f64];
    prop_oneof![
        6 => (targets, shaper).prop_map(|(target, shaper)| Op::Move { target, shaper }),
        4 => Just(Op::Stop),
        1 => (prop::option::of(any::<bool>()), kind)
            .prop_map(|(enabled, kind)| Op::Shaping { enabled, kind }),
        1 => (-1.0..50.0f64).prop_map(Op::Payload),
        1 => Just(Op::Nonsense),
        10 => prop_oneof![1..5usize, 1..40usize, 60..140usize].prop_map(Op::Run),
        2 => Just(Op::RobotIsSilent),
        2 => Just(Op::RobotSpeaks),
        1 => (-0.3..0.3f64).prop_map(Op::RobotIsMoved),
        1 => Just(Op::RobotClockStartsAnew),
        1 => (1..40usize).prop_map(Op::Burst),
        1 => prop::collection::vec(any::<u8>(), 0..40).prop_map(Op::Garbage),
        2 => prop_oneof![1..6usize, 6..100usize, 700..900usize].prop_map(Op::TicksMissed),
        1 => (1..40usize).prop_map(Op::EngineSleeps),
        1 => prop_oneof![Just(-1e7), Just(1e7), -5.0..5.0f64].prop_map(Op::WallJumps),
        1 => any::<bool>().prop_map(Op::DiskRefuses),
        1 => (0..400usize).prop_map(Op::StateIsCut),
        2 => Just(Op::Kill),
    ]
}

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

/// What a service that does as it is told would do.
struct Oracle {
    licence: Licence,
    /// Whether a move was asked for and not answered before the last step.
    asked: bool,
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
    timed: bool,
}

impl Oracle {
    fn new(timed: bool) -> Self {
        Self {
            licence: Licence::None,
            seen: 0,
            last: None,
            asked: false,
            obeyed: 0,
            silent: f64::NEG_INFINITY,
            asked_at: 0.0,
            slow_until: 0.0,
            timed,
        }
    }

    fn hear(&mut self, answered: &Answered, now: f64) -> Result<(), TestCaseError> {
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
            (_, Err(ServiceError::Gone)) => prop_assert!(false, "the engine has ended"),
            _ => {}
        }
        Ok(())
    }

    /// Judges what was sent since.
    fn judge(&mut self, world: &World) -> Result<(), TestCaseError> {
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

    /// What the state shows is what was sent.
    fn compare(&mut self, world: &World) -> Result<(), TestCaseError> {
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

    /// What the robot's silence, or time without a tick, means for what runs.
    fn watch(&mut self, world: &World) {
        let now = world.clock.now();
        let silence = now - world.heard;
        if silence > WATCHDOG - 2.0 * PERIOD {
            self.silent = now;
        }
        let noticed = silence > WATCHDOG + 3.0 * PERIOD && world.engine_sleeps == 0;
        if noticed && let Licence::Move { .. } = self.licence {
            // The longest stop from full speed, within the limits.
            let slow = if now < self.slow_until {
                SLOW_START
            } else {
                0.0
            };
            let until = now + 0.2 + STOP_SLACK + slow;
            self.licence = Licence::Stop { until };
        }
    }

    fn delayed(&mut self, by: f64, now: f64) {
        self.slow_until = now + 2.0 * SLOW_START;
        if let Licence::Stop { until } = &mut self.licence {
            *until += by + SLOW_START;
        }
    }

    /// Everything rests, and where it should.
    fn judge_end(&self, world: &World) -> Result<(), TestCaseError> {
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

/// A life of the service after the other over one folder.
struct Lives {
    data: tempfile::TempDir,
    world: World,
    oracle: Oracle,
    recorder: Option<(tokio::runtime::Runtime, Recorder)>,
    /// Recordings that some life has told of, and after how many steps.
    told: Vec<(String, usize)>,
    steps: usize,
    records: bool,
}

impl Lives {
    fn new(timed: bool, records: bool) -> Self {
        let data = tempfile::tempdir().expect("a folder");
        let mut lives = Self {
            world: World::start(own(data.path(), records), 1e9, 0.0, timed),
            data,
            oracle: Oracle::new(timed),
            recorder: None,
            told: Vec::new(),
            steps: 0,
            records,
        };
        lives.record();
        lives
    }

    fn record(&mut self) {
        if self.records {
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_time()
                .build();
            let runtime = runtime.expect("a runtime");
            let shelf = self.world.station.shelf().expect("a shelf");
            let recorder = {
                let _inside = runtime.enter();
                Recorder::start(&self.world.handle, shelf)
            };
            self.recorder = Some((runtime, recorder));
        }
    }

    /// The recorder takes what has come: it answers nothing before.
    fn catch_up(&self) {
        if let Some((runtime, recorder)) = &self.recorder {
            for _ in 0..3 {
                assert!(
                    runtime.block_on(recorder.end()).is_err(),
                    "none runs on demand"
                );
            }
        }
    }

    fn step(&mut self) -> Result<(), TestCaseError> {
        let is_move = |asked: &Asked| matches!(asked.request, Request::Move { .. });
        self.oracle.asked = self.world.waiting().iter().any(is_move);
        let answered = self.world.step();
        let now = self.world.clock.now();
        self.steps += 1;
        self.catch_up();
        // What is sent before the answer is heard is of the tick before it.
        self.oracle.judge(&self.world)?;
        for answered in &answered {
            self.oracle.hear(answered, now)?;
        }
        self.oracle.watch(&self.world);
        if self.world.engine_sleeps == 0 {
            self.oracle.compare(&self.world)?;
        }
        if self.records {
            for result in &self.world.snapshot().moves {
                let known = |name: &&String| self.told.iter().all(|(told, _)| told != *name);
                let news = result.recording.as_ref().filter(known).cloned();
                self.told.extend(news.map(|name| (name, self.steps)));
            }
        }
        Ok(())
    }

    fn run(&mut self, steps: usize) -> Result<(), TestCaseError> {
        (0..steps).try_for_each(|_| self.step())
    }

    /// What is on disk at this instant is all that the next life finds.
    fn kill(&mut self) -> Result<(), TestCaseError> {
        let left = tempfile::tempdir().expect("a folder");
        copy(self.data.path(), left.path());
        self.recorder = None;
        self.told.retain(|(_, since)| self.steps - since > WRITTEN);
        let before = &self.world;
        let (unix_time, position) = (before.clock.unix_time(), before.robot.position);
        let (timed, silent) = (self.oracle.timed, before.robot.silent);
        self.world = World::start(own(left.path(), self.records), unix_time, position, timed);
        self.world.robot.silent = silent;
        self.data = left;
        self.oracle = Oracle::new(timed);
        self.record();
        self.judge_shelf()?;
        self.run(if silent { 10 } else { STANDSTILL })
    }

    fn judge_shelf(&self) -> Result<(), TestCaseError> {
        if let Some((_, recorder)) = &self.recorder {
            for (name, _) in &self.told {
                let folder = recorder.shelf().path(name);
                let folder = folder.map_err(|error| TestCaseError::fail(error.to_string()))?;
                let read = Recording::from_path(folder);
                prop_assert!(read.is_ok(), "{name}: {:?}", read.err());
            }
        }
        Ok(())
    }

    fn apply(&mut self, op: &Op) -> Result<(), TestCaseError> {
        let world = &mut self.world;
        match op {
            Op::Move { target, shaper } => world.ask(Request::Move {
                joint: JOINT.into(),
                target: *target,
                shaper: shaper.map(Into::into),
            }),
            Op::Stop => world.ask(Request::Stop),
            Op::Shaping { enabled, kind } => world.ask(Request::Shaping(ShapingChange {
                enabled: *enabled,
                kind: kind.map(Into::into),
                ..ShapingChange::default()
            })),
            Op::Payload(mass) => world.ask(Request::Payload { mass: *mass }),
            Op::Nonsense => {
                world.go(f64::NAN);
                world.go(1e3);
            }
            Op::Run(ticks) => self.run(*ticks)?,
            Op::RobotIsSilent => world.robot.silent = true,
            Op::RobotSpeaks => world.robot.silent = false,
            Op::RobotIsMoved(by) => self.move_by_hand(*by)?,
            Op::RobotClockStartsAnew => world.restart_robot_clock(),
            Op::Burst(ticks) => world.robot.holds = *ticks,
            Op::Garbage(bytes) => world.hear(bytes),
            Op::TicksMissed(ticks) => {
                world.miss(*ticks);
                let now = world.clock.now();
                self.oracle.delayed(*ticks as f64 * PERIOD, now);
            }
            Op::EngineSleeps(ticks) => world.engine_sleeps = *ticks,
            Op::WallJumps(by) => world.time.jump_wall(*by),
            Op::DiskRefuses(refuses) => refuse(self.data.path(), *refuses),
            Op::StateIsCut(length) => cut(self.data.path(), *length),
            Op::Kill => self.kill()?,
        }
        Ok(())
    }

    fn move_by_hand(&mut self, by: f64) -> Result<(), TestCaseError> {
        let robot = &mut self.world.robot;
        (robot.silent, robot.off) = (true, true);
        self.run(80)?;
        let robot = &mut self.world.robot;
        (robot.silent, robot.off) = (false, false);
        robot.position += by;
        Ok(())
    }
}

fn own(data: &Path, records: bool) -> quell::service::config::Config {
    let mut config = config(data);
    config.recording.enabled = records;
    config
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).expect("a folder").flatten() {
        let target = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => {
                std::fs::create_dir(&target).expect("a folder");
                copy(&entry.path(), &target);
            }
            false => drop(std::fs::copy(entry.path(), &target).expect("a file")),
        }
    }
}

/// A folder stands where the new state would be written.
fn refuse(data: &Path, refuses: bool) {
    let beside = data.join("state.json.new");
    // It may be so already.
    let _ = match refuses {
        true => std::fs::create_dir(&beside),
        false => std::fs::remove_dir(&beside),
    };
}

fn cut(data: &Path, length: usize) {
    let path = data.join("state.json");
    if let Ok(text) = std::fs::read(&path) {
        std::fs::write(&path, &text[..length.min(text.len())]).expect("a file");
    }
}

fn sequences() -> ProptestConfig {
    let asked = std::env::var("QUELL_SEQUENCES").ok();
    let asked = asked.and_then(|number| number.parse().ok());
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(asked.unwrap_or(SEQUENCES))
    }
}

fn live(ops: &[Op], timed: bool, records: bool) -> Result<(), TestCaseError> {
    let mut lives = Lives::new(timed, records);
    lives.run(STANDSTILL)?;
    for op in ops {
        lives.apply(op)?;
        lives.step()?;
    }
    lives.world.robot.silent = false;
    lives.world.robot.holds = 0;
    lives.run(300)?;
    lives.oracle.judge_end(&lives.world)?;
    if records {
        // Twice what a recording takes after its move.
        lives.run(500)?;
        lives.kill()?;
    }
    let file = StateFile::within(lives.data.path(), Disk::default());
    let _ = file.load();
    Ok(())
}

proptest! {
    #![proptest_config(sequences())]

    #[test]
    fn it_moves_only_as_it_was_told_whatever_happens(
        ops in prop::collection::vec(op(), 1..14),
        timed in prop::bool::weighted(0.8),
    ) {
        live(&ops, timed, false)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: sequences().cases.div_ceil(20), ..sequences() })]

    #[test]
    fn no_recording_is_lost_that_was_told_of(ops in prop::collection::vec(op(), 1..14)) {
        live(&ops, true, true)?;
    }
}
