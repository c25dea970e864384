//! Identifies the mode of an arm from a recording of encoder and laser tracker.

use quell::closed_loop::Scenario;
use quell::identification::{NominalModel, Prior, identify, prepare};
use quell::plant::Robot;
use quell::shapers::Mode;
use quell::signal::TipRegistration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mode = Mode::from_hertz(10.15, 0.084)?;
    // Instead: quell::recording::Recording::from_path("my_recording.toml")?.
    let recording = Scenario::new(Robot::rx170(), mode).unshaped()?.recording;
    let arm = NominalModel {
        mode,
        lever_arm: Some(1.8),
        tip_height: 0.9,
    };
    let series = prepare(recording, Some(&arm), TipRegistration::Arc)?;
    let found = identify(&series.samples, Prior::default())?;
    let best = found.reference().batch().ok_or("nothing rings")?;
    println!(
        "{:.3} Hz, damping ratio {:.4}",
        best.mode.hertz(),
        best.mode.damping_ratio()
    );
    Ok(())
}
