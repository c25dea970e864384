//! The campaign of sensor faults over the closed loop: `cargo bench --bench faults`, and
//! `QUELL_FAULTS=1000 cargo bench --bench faults` for as many programmes of each fault,
//! `QUELL_FAULTS_FROM=1000` for others.

#[path = "../tests/sensor_faults/campaign.rs"]
mod campaign;
#[path = "../tests/sensor_faults/fault.rs"]
mod fault;
#[path = "../tests/sensor_faults/joint.rs"]
mod joint;
#[path = "../tests/sensor_faults/rig.rs"]
mod rig;

use campaign::{campaign, table};

fn number(name: &str, otherwise: u64) -> u64 {
    let given = std::env::var(name).ok().and_then(|text| text.parse().ok());
    given.unwrap_or(otherwise)
}

fn main() {
    let programmes = number("QUELL_FAULTS", 100);
    let mut outcomes = campaign(number("QUELL_FAULTS_FROM", 0), programmes);
    println!("{}", table(&outcomes));
    outcomes.sort_by(|a, b| b.worst().total_cmp(&a.worst()));
    println!("The worst:");
    for outcome in outcomes.iter().take(20) {
        println!(
            "{:.2} of {:.2?}: {}",
            outcome.worst(),
            outcome.ratios,
            outcome.case
        );
    }
    for outcome in outcomes.iter().filter(|outcome| !outcome.is_kept()) {
        println!("limits or target: {outcome:?}");
    }
}
