//! Random sequences of everything that a client, a robot, a clock, a disk and a killer can do to the service.
//!
//! The output is judged: setpoints, answers, the state that is shown, what is on disk. A few
//! hundred sequences here; `QUELL_SEQUENCES=10000` makes the campaign.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use proptest::prelude::*;
use quell::recording::Recording;
use quell::service::contract::{Request, ShapingChange};
use quell::service::disk::Disk;
use quell::service::recorder::Recorder;
use quell::service::state::StateFile;

use super::faulty::Faulty;
use super::oracle::Oracle;
use super::world::{Asked, STANDSTILL, World, config};

/// Sequences where nobody asks for more.
const SEQUENCES: u32 = 400;
const JOINT: &str = "joint_1";
const MCAP: &str = "recording.mcap";

/// An action of somebody.
#[derive(Clone, Debug)]
enum Op {
    Move {
        target: f64,
        shaper: Option<&'static str>,
    },
    Stop,
    /// A fault is taken back, and moves are enabled.
    Enable,
    Disable,
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
    /// The messages of so many ticks come at once.
    Burst(usize),
    Garbage(Vec<u8>),
    TicksMissed(usize),
    EngineSleeps(usize),
    WallJumps(f64),
    DiskRefuses(Refusal),
    /// The file of the state is cut.
    StateIsCut(usize),
    /// The process is killed, and another one started.
    Kill,
}

/// The writes that the disk refuses.
#[derive(Clone, Copy, Debug)]
enum Refusal {
    Nothing,
    Everything,
    State,
    Recordings,
    /// One call in so many.
    Each(u64),
    /// Everything after so many calls more: it is full in the middle of something. What a kill leaves at
    /// that call is the same.
    After(u64),
}

impl Refusal {
    /// Whether a call is refused, where `calls` came before this was so.
    fn refuses(self, calls: u64, call: u64, path: &Path) -> bool {
        let recordings = path.iter().any(|part| part == "recordings");
        match self {
            Self::Nothing => false,
            Self::Everything => true,
            Self::State => !recordings,
            Self::Recordings => recordings,
            Self::Each(count) => call.is_multiple_of(count),
            Self::After(count) => call - calls >= count,
        }
    }
}

fn refusal() -> impl Strategy<Value = Refusal> {
    prop_oneof![
        4 => Just(Refusal::Nothing),
        1 => Just(Refusal::Everything),
        1 => Just(Refusal::State),
        1 => Just(Refusal::Recordings),
        1 => (2..9u64).prop_map(Refusal::Each),
        4 => (0..60u64).prop_map(Refusal::After),
    ]
}

fn op() -> impl Strategy<Value = Op> {
    let shaper = prop_oneof![4 => Just(None), 1 => Just(Some("none")), 1 => Just(Some("zv"))];
    let kind = prop_oneof![Just(None), Just(Some("zv")), Just(Some("zvd"))];
    let targets = prop_oneof![Just(0.0), Just(0.3), Just(-0.4), -0.6..0.6f64];
    prop_oneof![
        6 => (targets, shaper).prop_map(|(target, shaper)| Op::Move { target, shaper }),
        4 => Just(Op::Stop),
        4 => Just(Op::Enable),
        1 => Just(Op::Disable),
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
        2 => refusal().prop_map(Op::DiskRefuses),
        1 => (0..400usize).prop_map(Op::StateIsCut),
        2 => Just(Op::Kill),
    ]
}

/// The same, with more of what concerns the disk: long enough runs that recordings come onto the shelf.
fn op_with_disk() -> impl Strategy<Value = Op> {
    prop_oneof![
        4 => op(),
        4 => (-0.6..0.6f64).prop_map(|target| Op::Move { target, shaper: None }),
        4 => (20..350usize).prop_map(Op::Run),
        4 => refusal().prop_map(Op::DiskRefuses),
        2 => Just(Op::Kill),
    ]
}

/// A life of the service after the other over one folder.
struct Lives {
    data: tempfile::TempDir,
    disk: Faulty,
    world: World,
    oracle: Oracle,
    recorder: Option<(tokio::runtime::Runtime, Recorder)>,
    /// Recordings that some life has told of.
    told: BTreeSet<String>,
    records: bool,
}

impl Lives {
    fn new(timed: bool, records: bool) -> Self {
        let data = tempfile::tempdir().expect("a folder");
        let disk = Faulty::new(|_, _| false);
        let mut lives = Self {
            world: begin(&disk, own(data.path(), records), 1e9, 0.0, timed),
            data,
            disk,
            oracle: Oracle::new(timed),
            recorder: None,
            told: BTreeSet::new(),
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

    /// The recorder takes what has come before it answers.
    fn catch_up(&self) {
        if let Some((runtime, recorder)) = &self.recorder {
            let ended = runtime.block_on(recorder.end());
            assert!(ended.is_err(), "none runs on demand: {ended:?}");
        }
    }

    fn step(&mut self) -> Result<(), TestCaseError> {
        let is_move = |asked: &Asked| matches!(asked.request, Request::Move { .. });
        self.oracle.asked = self.world.waiting().iter().any(is_move);
        let answered = self.world.step();
        let now = self.world.clock.now();
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
            let snapshot = self.world.snapshot();
            let named = snapshot.moves.iter();
            self.told
                .extend(named.filter_map(|result| result.recording.clone()));
        }
        Ok(())
    }

    fn run(&mut self, steps: usize) -> Result<(), TestCaseError> {
        (0..steps).try_for_each(|_| self.step())
    }

    /// The files on disk at this instant are all that the next life finds.
    fn kill(&mut self) -> Result<(), TestCaseError> {
        let left = tempfile::tempdir().expect("a folder");
        copy(self.data.path(), left.path());
        self.recorder = None;
        let before = &self.world;
        let (unix_time, position) = (before.clock.unix_time(), before.robot.position);
        let (timed, silent) = (self.oracle.timed, before.robot.silent);
        let config = own(left.path(), self.records);
        self.world = begin(&self.disk, config, unix_time, position, timed);
        self.world.robot.silent = silent;
        self.data = left;
        self.oracle = Oracle::new(timed);
        self.record();
        self.judge_recordings()?;
        self.run(if silent { 10 } else { STANDSTILL })
    }

    /// A recording that was told of is there: on the shelf, or beside it as far as it came.
    fn judge_recordings(&mut self) -> Result<(), TestCaseError> {
        let folder = self.data.path().join("recordings");
        for name in &self.told {
            let shelved = folder.join(name);
            let read = match shelved.exists() {
                true => Recording::from_path(shelved),
                false => Recording::from_path(folder.join(format!(".unfinished-{name}/{MCAP}"))),
            };
            prop_assert!(read.is_ok(), "{name}: {:?}", read.err());
        }
        self.told.extend(self.shelved()?);
        Ok(())
    }

    fn shelved(&self) -> Result<BTreeSet<String>, TestCaseError> {
        let Some((_, recorder)) = &self.recorder else {
            return Ok(BTreeSet::new());
        };
        let list = recorder.shelf().list();
        let list = list.map_err(|error| TestCaseError::fail(error.to_string()))?;
        Ok(list.into_iter().map(|entry| entry.name).collect())
    }

    /// With room on the disk, and some time after the last move, all are whole on the shelf.
    fn judge_shelf(&mut self) -> Result<(), TestCaseError> {
        self.judge_recordings()?;
        let shelved = self.shelved()?;
        let missing: Vec<_> = self.told.difference(&shelved).collect();
        prop_assert!(missing.is_empty(), "not on the shelf: {missing:?}");
        Ok(())
    }

    fn refuse(&self, refusal: Refusal) {
        let calls = self.disk.calls();
        self.disk
            .refuse(move |call, path| refusal.refuses(calls, call, path));
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
            Op::Enable => world.enable(),
            Op::Disable => world.ask(Request::Disable),
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
                self.oracle.delayed(*ticks, now);
            }
            Op::EngineSleeps(ticks) => world.engine_sleeps = *ticks,
            Op::WallJumps(by) => world.time.jump_wall(*by),
            Op::DiskRefuses(refusal) => self.refuse(*refusal),
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

/// A life over what is on this disk.
fn begin(
    disk: &Faulty,
    config: quell::service::config::Config,
    unix_time: f64,
    position: f64,
    timed: bool,
) -> World {
    let disk = Disk::new(Arc::new(disk.clone()));
    World::start_on(disk, config, unix_time, position, timed)
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
    lives.apply(&Op::Enable)?;
    for op in ops {
        lives.apply(op)?;
        lives.step()?;
        lives.judge_recordings()?;
    }
    lives.refuse(Refusal::Nothing);
    lives.world.robot.silent = false;
    lives.world.robot.holds = 0;
    lives.run(300)?;
    lives.oracle.judge_end(&lives.world)?;
    if records {
        // Twice what a recording takes after its move.
        lives.run(500)?;
        lives.judge_shelf()?;
        lives.kill()?;
        lives.judge_shelf()?;
    }
    let file = StateFile::within(lives.data.path(), Disk::default());
    let _ = file.load(0.001);
    Ok(())
}

#[test]
fn a_joint_may_count_as_not_heard_where_measurements_find_no_room() {
    let far = Op::Move {
        target: 0.3,
        shaper: None,
    };
    let missed = Op::TicksMissed(700);
    let nothing = Op::Shaping {
        enabled: None,
        kind: None,
    };
    let before = [
        far.clone(),
        missed.clone(),
        missed.clone(),
        Op::RobotIsSilent,
        Op::RobotClockStartsAnew,
    ];
    live(&before, false, false).expect("a move that was asked for before");
    let after = [
        missed.clone(),
        missed,
        Op::Burst(8),
        Op::Enable,
        far,
        nothing.clone(),
        Op::Run(3),
        nothing,
    ];
    live(&after, false, false).expect("a move that was asked for after");
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
    fn no_recording_is_lost_that_was_told_of(
        ops in prop::collection::vec(op_with_disk(), 1..20),
    ) {
        live(&ops, true, true)?;
    }
}
