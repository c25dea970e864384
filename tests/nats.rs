//! The queue in a real NATS server: skipped where `nats-server` is not installed.
#![cfg(feature = "nats")]

mod small;

#[path = "absent/skipped.rs"]
mod skipped;

use skipped::skipped;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use async_nats::jetstream;
use futures_util::StreamExt;
use quell::batch::{Job, MOST_DELIVERIES, Taken, Work, connect, pack, work};
use quell::service::config::{Config, Overrides};
use quell::service::contract::{Phase, Request};
use quell::service::start;
use serde_json::Value;
use tokio::runtime::Runtime;

/// Longest that anything here is waited for.
const PATIENCE: Duration = Duration::from_secs(300);
/// Recordings of the long test, or as many as `QUELL_NATS_RECORDINGS` says.
const RECORDINGS: u64 = 1000;
const WORKERS: usize = 3;

/// A server on loopback, its files in a folder.
struct Server<'a> {
    folder: &'a Path,
    port: u16,
    process: Child,
}

impl<'a> Server<'a> {
    /// None where there is no such program.
    fn start(folder: &'a Path) -> Option<Self> {
        let free = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = free.local_addr().expect("an address").port();
        drop(free);
        let Ok(process) = Self::run(folder, port) else {
            skipped("nats-server is not installed");
            return None;
        };
        let server = Self {
            folder,
            port,
            process,
        };
        server.is_up();
        Some(server)
    }

    fn run(folder: &Path, port: u16) -> std::io::Result<Child> {
        let mut command = Command::new("nats-server");
        command.args(["-js", "-a", "127.0.0.1", "-p", &port.to_string(), "-sd"]);
        command
            .arg(folder.join("jetstream"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
    }

    fn address(&self) -> String {
        format!("nats://127.0.0.1:{}", self.port)
    }

    fn is_up(&self) {
        wait("the server", || {
            std::net::TcpStream::connect(("127.0.0.1", self.port)).is_ok()
        });
    }

    /// Kills it, and starts it again with the files that it left.
    fn restart(&mut self) {
        self.process.kill().expect("it runs");
        self.process.wait().expect("it ends");
        self.process = Self::run(self.folder, self.port).expect("it starts");
        self.is_up();
    }
}

impl Drop for Server<'_> {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn wait(what: &str, done: impl Fn() -> bool) {
    let since = Instant::now();
    while !done() {
        assert!(since.elapsed() < PATIENCE, "{what} is waited for in vain");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn quell(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args(arguments).current_dir(folder);
    command
}

fn submit(address: &str, folder: &Path) -> Value {
    let arguments = [
        "diagnose",
        "--queue",
        address,
        "submit",
        "--model",
        "model.toml",
        "--json",
    ];
    let ran = quell(&[&arguments[..], &["fleet"]].concat(), folder)
        .output()
        .expect("it runs");
    assert!(ran.status.success(), "{ran:?}");
    serde_json::from_slice(&ran.stdout).expect("JSON")
}

/// Messages in a stream, and how many ever were.
fn counted(address: &str, name: &str) -> (u64, u64) {
    let runtime = Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let client = async_nats::connect(address).await.expect("a server");
        let stream = jetstream::new(client).get_stream(name).await;
        let state = stream
            .expect("a stream")
            .get_info()
            .await
            .expect("it says")
            .state;
        (state.messages, state.last_sequence)
    })
}

/// Many recordings, a few workers, one of which is killed at work, and a server that is killed and started
/// again: every recording has its result, and has it once.
#[test]
fn every_result_exactly_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let Some(mut server) = Server::start(here) else {
        return;
    };
    let address = server.address();
    let count = std::env::var("QUELL_NATS_RECORDINGS").ok();
    let count = count
        .and_then(|text| text.parse().ok())
        .unwrap_or(RECORDINGS);
    fs::write(here.join("model.toml"), small::MODEL).expect("a file");
    small::fleet(&here.join("fleet"), count);
    small::poison(&here.join("fleet"));
    let jobs = count + 1;

    let told = submit(&address, here);
    assert_eq!(told["queued"], jobs, "{told}");
    let again = submit(&address, here);
    assert_eq!(
        (&again["queued"], &again["waiting"]),
        (&0.into(), &jobs.into())
    );

    let worker = |number: usize| {
        let told = File::create(here.join(format!("worker-{number}"))).expect("a file");
        let arguments = ["work", "--queue", &address, "--jobs", "1", "--drain"];
        quell(&arguments, here)
            .stdout(told)
            .spawn()
            .expect("it runs")
    };
    let mut workers: Vec<_> = (0..WORKERS).map(worker).collect();
    let queue = connect(&address).expect("a queue");
    let left = |share: f64| {
        let most = (jobs as f64 * share) as u64;
        wait("work", || queue.left().expect("it says") < most);
    };
    left(0.75);
    let mut killed = workers.remove(0);
    killed.kill().expect("it runs");
    killed.wait().expect("it ends");
    left(0.5);
    server.restart();
    for worker in &mut workers {
        assert!(worker.wait().expect("it ends").success());
    }

    let (mut keys, mut errors) = (BTreeSet::new(), Vec::new());
    queue
        .answers(&mut |answer| {
            assert!(
                keys.insert(answer.about.key.clone()),
                "twice: {}",
                answer.about.name
            );
            assert!(answer.about.error.is_some() || answer.said("verdict").is_some());
            errors.extend(answer.about.error);
            Ok(())
        })
        .expect("answers");
    let submitted = told["keys"].as_array().expect("keys").iter();
    let submitted: BTreeSet<_> = submitted
        .filter_map(Value::as_str)
        .map(String::from)
        .collect();
    assert_eq!(keys, submitted);
    assert!(
        matches!(&errors[..], [error] if error.starts_with("recording.toml:4:")),
        "{errors:?}"
    );
    // Nothing was ever written a second time, and nothing is left of what was worked at.
    assert_eq!(counted(&address, "KV_QUELL_ANSWERS"), (jobs, jobs));
    assert_eq!(counted(&address, "QUELL_RECORDINGS").0, 0);
    assert_eq!(queue.left().expect("it says"), 0);
    let mut lines = Vec::new();
    for number in 0..WORKERS {
        let text = fs::read_to_string(here.join(format!("worker-{number}"))).expect("text");
        let names = text.lines().filter_map(|line| line.split(' ').next());
        let names: Vec<_> = names.map(String::from).collect();
        println!("worker {number}: {} results", names.len());
        lines.extend(names);
    }
    let once: BTreeSet<_> = lines.iter().collect();
    assert_eq!(
        once.len(),
        lines.len(),
        "each is told by the worker that stored it"
    );
    let done = submit(&address, here);
    assert_eq!(
        (&done["queued"], &done["answered"]),
        (&0.into(), &jobs.into())
    );
    assert_eq!(counted(&address, "QUELL_JOBS").0, 0);
}

/// A job that no worker survives is set aside; what is no job is thrown away; a recording of several parts
/// arrives whole.
#[test]
fn what_cannot_be_done_holds_nobody_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let Some(server) = Server::start(here) else {
        return;
    };
    let queue = connect(&server.address()).expect("a queue");
    let runtime = Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let client = async_nats::connect(server.address())
            .await
            .expect("a server");
        let jetstream = jetstream::new(client);
        let sent = jetstream
            .publish("quell-queue.job.junk", "no job".into())
            .await;
        sent.expect("sent").await.expect("taken");
    });
    let path = &small::fleet(here, 1)[0];
    let packed = pack(path).expect("a recording");
    let deadly = Job::new("deadly", &packed, small::MODEL, 1);
    queue.submit(&deadly, packed).expect("it is taken");
    let mut deliveries = 0;
    while deliveries < MOST_DELIVERIES {
        if let Ok(Taken::Job(claim)) = queue.take() {
            deliveries = claim.deliveries;
            claim.ticket.give_back();
        }
    }
    // A comment of a few parts' length, in a file that is read.
    let text = fs::read_to_string(path.join("recording.toml")).expect("text");
    let comment = "# nothing\n".repeat(150_000);
    fs::write(path.join("recording.toml"), text + &comment).expect("a file");
    let packed = pack(path).expect("a recording");
    let long = Job::new("long", &packed, small::MODEL, 1);
    queue.submit(&long, packed).expect("it is taken");
    let settings = Work {
        at_once: 1,
        threads: 1,
        drain: true,
    };
    work(&*queue, settings, &AtomicBool::new(false), &|_| {}).expect("it works");
    let mut told = Vec::new();
    queue
        .answers(&mut |answer| {
            told.push((answer.about.name.clone(), answer.about.error));
            Ok(())
        })
        .expect("answers");
    told.sort();
    let [(_, Some(error)), (long, None)] = &told[..] else {
        panic!("{told:?}")
    };
    assert!(
        error.contains("its workers died") && long == "long",
        "{error}"
    );
}

/// A job stays with the worker that says it is alive, and goes to another one when it falls silent.
#[test]
fn a_long_job_is_not_handed_out_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(server) = Server::start(folder.path()) else {
        return;
    };
    let queue = connect(&server.address()).expect("a queue");
    let packed = pack(&small::fleet(folder.path(), 1)[0]).expect("a recording");
    let job = Job::new("long", &packed, small::MODEL, 1);
    queue.submit(&job, packed).expect("it is taken");
    let Ok(Taken::Job(claim)) = queue.take() else {
        panic!("it waits")
    };
    // Each try waits for some seconds: together more than what a queue waits for a sign of life.
    for _ in 0..5 {
        claim.ticket.alive();
        assert!(matches!(queue.take(), Ok(Taken::Nothing)));
    }
    let silent = Instant::now();
    let again = loop {
        assert!(silent.elapsed() < PATIENCE, "nobody gets it");
        if let Ok(Taken::Job(again)) = queue.take() {
            break again;
        }
    };
    assert_eq!((again.job.key, again.deliveries), (job.key, 2));
    again.ticket.done();
    assert_eq!(queue.left().expect("it says"), 0);
}

/// A fleet hears what a robot learns: the train in force, and estimates while it moves.
#[test]
fn estimates_and_trains_are_published() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(server) = Server::start(folder.path()) else {
        return;
    };
    let file = folder.path().join("quell.toml");
    let config = |robot: &str| {
        let text = format!(
            "[tick]\nreal_time = false\n[nats]\nserver = \"{}\"\nrobot = \"{robot}\"\n",
            server.address()
        );
        fs::write(&file, text).expect("a file");
        let overrides = Overrides {
            data: Some(folder.path().join("data")),
            ..Overrides::default()
        };
        Config::load(Some(&file), &overrides)
    };
    assert!(config("a.b").is_err(), "a word of a subject has no dot");
    let runtime = Runtime::new().expect("a runtime");
    // A subscription is dropped within a runtime, too.
    let _within = runtime.enter();
    let mut heard = runtime.block_on(async {
        let client = async_nats::connect(server.address())
            .await
            .expect("a server");
        let heard = client.subscribe("quell.arm7.>").await.expect("it listens");
        client.flush().await.expect("it listens");
        heard
    });
    let service = start(config("arm7").expect("fine")).expect("a service");
    let handle = service.handle();
    wait("the robot", || {
        let snapshot = handle.snapshot();
        snapshot
            .joints
            .iter()
            .any(|joint| joint.phase == Phase::Rest)
    });
    let request = Request::Move {
        joint: "joint_1".into(),
        target: 0.3,
        shaper: None,
    };
    runtime
        .block_on(handle.ask(Request::Enable))
        .expect("enabled");
    runtime.block_on(handle.ask(request)).expect("a move");
    let (mut train, mut estimate) = (None, None);
    while train.is_none() || estimate.is_none() {
        let message = runtime.block_on(tokio::time::timeout(PATIENCE, heard.next()));
        let message = message.expect("in time").expect("a message");
        let value: Value = serde_json::from_slice(&message.payload).expect("JSON");
        match message.subject.as_str() {
            "quell.arm7.joint_1.train" => train = Some(value),
            "quell.arm7.joint_1.estimate" => estimate = Some(value),
            other => panic!("{other}"),
        }
    }
    let (train, estimate) = (train.expect("heard"), estimate.expect("heard"));
    let amplitudes = train["amplitudes"].as_array().expect("impulses").iter();
    let sum: f64 = amplitudes.filter_map(Value::as_f64).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{train}");
    assert!(
        estimate["frequency_hz"].as_f64().is_some_and(|f| f > 0.0),
        "{estimate}"
    );
}
