//! `quell serve`: commands a robot in real time, learns its modes, and keeps what it learned.

mod outside;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;

use tokio::signal::unix::{SignalKind, signal};

use super::{CliError, output, values};
use crate::service::config::{Config, Overrides, RobotKind, listed};
use crate::service::disk::{Disk, FileSystem};
use crate::service::{self, StartError};
use outside::Outside;

/// Commands a robot in real time: targets in, shaped setpoints out, its modes learned on the way.
///
/// Without arguments: the embedded arm, at 1 kHz.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell serve
  quell serve --robot udp --udp 127.0.0.1:7871 --rate 1000
  quell serve --demo
  quell serve --config quell.toml
  quell serve --print-config > quell.toml

Ctrl-C or SIGTERM brings every joint to a jerk-limited stop first. What was learned is kept in the \
data folder and is in force again after the next start, however this one ended.")]
pub struct Args {
    /// The configuration, TOML; what is given here as an option overrides it.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Where page and interface listen [default: 127.0.0.1:7870].
    #[arg(long, value_name = "ADDRESS")]
    pub http: Option<SocketAddr>,
    /// Where the UDP link listens [default: 127.0.0.1:7871].
    #[arg(long, value_name = "ADDRESS")]
    pub udp: Option<SocketAddr>,
    /// Ticks a second, Hz, 250 to 4000 [default: 1000].
    #[arg(long, value_name = "HZ", value_parser = values::positive, allow_negative_numbers = true)]
    pub rate: Option<f64>,
    /// The robot; `zenoh` (ROS 2) needs a build with --features zenoh [default: embedded].
    #[arg(long, value_parser = robots())]
    pub robot: Option<RobotKind>,
    /// Shows what shaping is for, on the simulated arm: unshaped, wrong belief, adapted. Enables moves.
    #[arg(long, conflicts_with_all = ["robot", "udp"])]
    pub demo: bool,
    /// Prints every key of the configuration, with default, unit, range and a sentence, and ends.
    #[arg(long)]
    pub print_config: bool,
    /// Folder of state and recordings [default: quell-data].
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// All robots are accepted: one that is not in the build is refused later with a sentence. It is not listed.
fn robots() -> impl clap::builder::TypedValueParser<Value = RobotKind> {
    use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
    let built = |kind: RobotKind| service::ZENOH || kind != RobotKind::Zenoh;
    let value = |kind: &RobotKind| PossibleValue::new(kind.name()).hide(!built(*kind));
    let values = RobotKind::ALL.iter().map(value);
    PossibleValuesParser::new(values).try_map(|name| {
        let found = RobotKind::ALL.iter().find(|kind| kind.name() == name);
        found.copied().ok_or("there is no such robot")
    })
}

/// Runs the verb, until it is told to end.
///
/// # Errors
/// [`CliError::Input`] where the configuration is refused; [`CliError::Failure`] where a socket, a thread or
/// the data folder is not available.
pub fn run(args: Args) -> Result<(), CliError> {
    if args.print_config {
        return output::text(&listed());
    }
    let demo = args.demo;
    let overrides = Overrides {
        robot: args.robot.or(demo.then_some(RobotKind::Embedded)),
        data: args.data,
        rate: args.rate,
        http: args.http,
        udp: args.udp,
    };
    let config = Config::load(args.config.as_deref(), &overrides).map_err(CliError::input)?;
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(CliError::failure)?;
    let ended = runtime.block_on(serve(config, demo));
    // All that is to be kept is on the disk. What still runs only reads: a slow medium must not hold the end.
    runtime.shutdown_background();
    ended
}

async fn serve(config: Config, demo: bool) -> Result<(), CliError> {
    // Before any motion: no signal is lost in the meantime.
    let mut terminated = signal(SignalKind::terminate())?;
    let mut interrupted = signal(SignalKind::interrupt())?;
    let (robot, rate) = (config.robot, 1.0 / config.period);
    // Before the ports, which another service on the same folder probably holds, too.
    let disk = Disk::of(&config.data, Arc::new(FileSystem));
    let disk = disk.map_err(CliError::failure)?;
    let listener = outside::listen(&config).await?;
    let page = listener.local_addr()?;
    let service = service::start_on(config.clone(), disk).map_err(refused)?;
    let outside = Outside::start(listener, &config, &service);
    let link = match service.udp_address() {
        Some(address) => format!(", UDP at {address}"),
        None => String::new(),
    };
    output::text(&format!(
        "quell: robot {}, {rate:.0} Hz{link}, page at http://{page}/\n",
        robot.name()
    ))?;
    if demo {
        let handle = service.handle();
        tokio::spawn(async move {
            if let Err(error) = service::demo::run(&handle).await {
                tracing::warn!("the demonstration ended early: {error}");
            }
        });
    }
    tokio::select! {
        _ = terminated.recv() => {}
        _ = interrupted.recv() => {}
    }
    output::text("quell: stopping\n")?;
    // The stop waits for the robot to come to rest.
    tokio::task::spawn_blocking(move || service.stop())
        .await
        .map_err(CliError::failure)?;
    outside.end().await
}

fn refused(error: StartError) -> CliError {
    match error {
        StartError::System { .. }
        | StartError::Folder(_)
        | StartError::Shelf(_)
        | StartError::Planner(_) => CliError::failure(error),
        _ => CliError::input(error),
    }
}
