//! Lateness of the tick at 1 kHz with the embedded arm, beside a bare loop that sleeps and does
//! nothing. Both take turns, so that they meet the same machine. Takes 40 s.

use std::net::SocketAddr;
use std::time::Duration;

use quell::service::clock::ServiceClock;
use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::contract::TickStatistics;
use quell::service::start;
use quell::service::tick::{Histogram, real_time};

const PERIOD: f64 = 0.001;
const TURNS: usize = 4;
const TURN: f64 = 5.0;

fn main() {
    let (mut bare, mut tick) = (Vec::new(), Vec::new());
    for _ in 0..TURNS {
        bare.push(std::thread::spawn(sleeper).join().expect("the bare loop"));
        tick.push(service());
    }
    println!("lateness, us          median      p99      max");
    for (name, turns) in [("bare loop", &bare), ("tick of quell serve", &tick)] {
        for [median, p99, most] in turns {
            let [median, p99, most] = [median, p99, most].map(|time| time * 1e6);
            println!("{name:20} {median:8.1} {p99:8.1} {most:8.1}");
        }
    }
    let middle = |turns: &[[f64; 3]], what: usize| {
        let mut values: Vec<_> = turns.iter().map(|turn| turn[what]).collect();
        values.sort_by(f64::total_cmp);
        0.5 * (values[(TURNS - 1) / 2] + values[TURNS / 2])
    };
    for (name, what) in [("median", 0), ("p99", 1)] {
        let ratio = middle(&tick, what) / middle(&bare, what);
        println!("ratio of {name}: {ratio:.2}");
    }
}

/// Sleeps from tick to tick.
fn sleeper() -> [f64; 3] {
    real_time::raise_priority();
    let clock = ServiceClock::start();
    let mut lateness = Histogram::default();
    let mut due = clock.now() + PERIOD;
    while due < TURN {
        clock.sleep_until(due);
        lateness.add(clock.now() - due);
        due += PERIOD;
    }
    [
        lateness.quantile(0.5),
        lateness.quantile(0.99),
        lateness.longest(),
    ]
}

fn service() -> [f64; 3] {
    let data = tempfile::tempdir().expect("a folder");
    let overrides = Overrides {
        robot: Some(RobotKind::Embedded),
        data: Some(data.path().to_path_buf()),
        rate: Some(1.0 / PERIOD),
        http: Some(SocketAddr::from(([127, 0, 0, 1], 0))),
        ..Overrides::default()
    };
    let service = start(Config::load(None, &overrides).expect("defaults")).expect("a service");
    std::thread::sleep(Duration::from_secs_f64(TURN));
    let TickStatistics {
        lateness_p50_s,
        lateness_p99_s,
        lateness_max_s,
        ..
    } = service.handle().snapshot().tick;
    service.stop();
    [lateness_p50_s, lateness_p99_s, lateness_max_s]
}
