//! Seconds of a whole diagnosis on one core, simulations in it and simulations per second, on concealed
//! cases that were sampled at 240 to 340 Hz; and the most memory that was held.

use quell::diagnosis::{Options, diagnose};
use quell::model::{Model, simulations};
use quell::proof::{Case, generate};
use quell::recording::Channel;
use rustix::time::{ClockId, clock_gettime};

const SEED: u64 = 2;
const CASES: usize = 16;

fn main() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let folder = tempfile::tempdir().expect("a folder for the models");
    println!(
        "hidden                               length_s  samples  seconds  simulations  a_second  s_for_13_s"
    );
    let mut each = Vec::new();
    one.expect("a thread").install(|| {
        let made = (0..).filter_map(|index| generate(SEED, index).ok());
        for case in made
            .filter(|case| (240.0..=340.0).contains(&rate(case)))
            .take(CASES)
        {
            let file = folder.path().join("model.toml");
            std::fs::write(&file, &case.model).expect("the model's file");
            let model = Model::from_path(&file).expect("a model");
            let (before, start) = (simulations(), seconds());
            let train = std::slice::from_ref(&case.train);
            if let Err(error) = diagnose(&model, train, &[], &Options::default(), &|_, _| {}) {
                println!("{error}");
                continue;
            }
            let (took, count) = (seconds() - start, (simulations() - before) as f64);
            let length = span(&case.train.channels[0]);
            let samples: usize = case.train.channels.iter().map(|c| c.time.len()).sum();
            let hidden = case
                .truth
                .effects
                .iter()
                .map(|hidden| hidden.effect.as_str());
            let name = hidden.collect::<Vec<_>>().join(" + ");
            let alike = took * 13.0 / length;
            println!(
                "{name:36} {length:8.1} {samples:8} {took:8.2} {count:12} {:9.0} {alike:11.2}",
                count / took
            );
            each.push(alike);
        }
    });
    each.sort_by(f64::total_cmp);
    let at = |share: f64| each[((each.len() - 1) as f64 * share).round() as usize];
    println!(
        "seconds for 13 s: median {:.2}, 90th percentile {:.2}",
        at(0.5),
        at(0.9)
    );
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(most) = status.lines().find_map(|line| line.strip_prefix("VmHWM:")) {
        println!("most memory: {}", most.trim());
    }
}

/// Samples a second of the motor side.
fn rate(case: &Case) -> f64 {
    let first = &case.train.channels[0];
    (first.time.len() - 1) as f64 / span(first)
}

fn span(channel: &Channel) -> f64 {
    channel.time[channel.time.len() - 1] - channel.time[0]
}

/// Time of this process on a core, which others on the machine do not lengthen.
fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
