//! `quell doctor`: features of this build and this machine.

mod lateness;

use super::{CliError, next, output};
use serde::Serialize;
use std::fs;
use std::thread::available_parallelism;

/// Says what this build has in it, and what the machine offers to a robot's tick.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell doctor
  quell doctor --json

It asks for what `quell serve` asks for, a real-time priority and locked memory, and says what it got. \
Then a loop that sleeps and does nothing runs at 1 kHz for a second: no tick can come earlier than it \
does. Run it as the user, and in the container, that will run the service.")]
pub struct Args {
    /// Prints JSON instead of a table.
    #[arg(long)]
    json: bool,
}

/// An optional part of the program.
#[derive(Serialize)]
struct Feature {
    name: &'static str,
    built: bool,
    what: &'static str,
}

/// All optional parts.
const FEATURES: [Feature; 6] = [
    feature("serve", cfg!(feature = "serve"), "quell serve: the service"),
    feature("urdf", cfg!(feature = "urdf"), "robots described in URDF"),
    feature(
        "parquet",
        cfg!(feature = "parquet"),
        "recordings in Parquet files",
    ),
    feature(
        "nats",
        cfg!(feature = "nats"),
        "quell work, quell results: batches over NATS",
    ),
    feature(
        "zenoh",
        cfg!(feature = "zenoh"),
        "robots on ROS 2 over Zenoh",
    ),
    feature(
        "foxglove",
        cfg!(feature = "foxglove"),
        "a live view in Foxglove",
    ),
];

const fn feature(name: &'static str, built: bool, what: &'static str) -> Feature {
    Feature { name, built, what }
}

/// The whole report.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    features: [Feature; 6],
    machine: Machine,
    tick: Tick,
}

/// The system's description of itself; an entry is absent if the system does not give it.
#[derive(Serialize)]
struct Machine {
    cores: Option<usize>,
    isolated_cores: Option<String>,
    kernel: Option<String>,
    preempt_rt: bool,
    governor: Option<String>,
}

/// The requested rights (empty without the service in the build), and the lateness of a bare loop with them.
#[derive(Serialize)]
struct Tick {
    real_time_priority: Option<bool>,
    memory_locked: Option<bool>,
    lateness_us: lateness::Lateness,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError`] where no thread can be started.
pub fn run(args: Args) -> Result<(), CliError> {
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        features: FEATURES,
        machine: machine(),
        tick: tick()?,
    };
    match args.json {
        true => output::json(&report),
        false => output::text(&text(&report)),
    }
}

fn machine() -> Machine {
    let read = |path: &str| {
        let text = fs::read_to_string(path).ok()?;
        let text = text.trim();
        (!text.is_empty()).then(|| text.to_string())
    };
    Machine {
        cores: available_parallelism().ok().map(usize::from),
        isolated_cores: read("/sys/devices/system/cpu/isolated"),
        kernel: read("/proc/sys/kernel/osrelease"),
        preempt_rt: read("/sys/kernel/realtime").as_deref() == Some("1"),
        governor: read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
    }
}

/// Measures on a separate thread, as the tick has one.
fn tick() -> Result<Tick, CliError> {
    let tried = || {
        let [real_time_priority, memory_locked] = rights();
        Tick {
            real_time_priority,
            memory_locked,
            lateness_us: lateness::measured(),
        }
    };
    let thread = std::thread::Builder::new().spawn(tried)?;
    let told = thread.join();
    told.map_err(|_| CliError::failure("the loop of the measurement ended early"))
}

/// Whether this thread gets a real-time priority, and the process its memory locked.
#[cfg(feature = "serve")]
fn rights() -> [Option<bool>; 2] {
    use crate::service::tick::real_time;
    use tracing::subscriber::{NoSubscriber, with_default};
    // A refused right is in the table, and the log need not repeat it.
    with_default(NoSubscriber::default(), || {
        [real_time::raise_priority(), real_time::lock_memory()].map(Some)
    })
}

/// This build has no tick that would ask for them.
#[cfg(not(feature = "serve"))]
fn rights() -> [Option<bool>; 2] {
    [None; 2]
}

fn text(report: &Report) -> String {
    let yes = |is: bool| if is { "yes" } else { "no" }.to_string();
    let or = |value: &Option<String>, none: &str| value.clone().unwrap_or(none.into());
    let mut text = format!("quell {}\n\nBuilt in:\n", report.version);
    for one in &report.features {
        let how = match one.built {
            true => String::new(),
            false => format!(" (cargo build --release --features {})", one.name),
        };
        text += &line(one.name, &format!("{:4}{}{how}", yes(one.built), one.what));
    }
    let machine = &report.machine;
    let cores = machine.cores.map_or("unknown".into(), |n| n.to_string());
    text += "\nMachine:\n";
    text += &line("cores", &cores);
    text += &line("isolated cores", &or(&machine.isolated_cores, "none"));
    text += &line("kernel", &or(&machine.kernel, "unknown"));
    text += &line("PREEMPT_RT", &yes(machine.preempt_rt));
    text += &line("governor", &or(&machine.governor, "unknown"));
    let tick = &report.tick;
    let late = &tick.lateness_us;
    let granted = |right: Option<bool>| right.map_or("not asked for".into(), yes);
    text += "\nWhat the tick of `quell serve` gets:\n";
    text += &line("real-time priority", &granted(tick.real_time_priority));
    text += &line("locked memory", &granted(tick.memory_locked));
    let [median, p99, max] = [late.median, late.p99, late.max];
    let late =
        format!("late by {median:.0} us in the median, {p99:.0} us at 99 %, {max:.0} us at most");
    text += &line("a bare loop at 1 kHz", &late);
    text += if tick.lacks() { ADVICE } else { "" };
    text + "\n" + &next::command(["move"])
}

/// A name and its description.
fn line(name: &str, what: &str) -> String {
    format!("  {name:22}{what}\n")
}

impl Tick {
    fn lacks(&self) -> bool {
        [self.real_time_priority, self.memory_locked].contains(&Some(false))
    }
}

/// Advice for a missing right.
const ADVICE: &str = "\n\
The system refused a right that the tick of `quell serve` asks for. It runs without, and can come late when the\n\
machine is busy. For a robot give the user `rtprio 80` and `memlock unlimited` in /etc/security/limits.conf, or run\n\
packaging/quell.service.\n";
