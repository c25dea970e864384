//! Sensors that are some samples late or early.

use super::concealed::{conceal, typical};
use super::machines::{Machine, PERIOD, angle, commanded, gauge, joint_at, position, stamps};
use super::{Found, found, outcome};
use quell::effects::{Effect, Place};
use quell::recording::{Recording, Role};

/// The sensor of a machine of one clock, as late as this; the encoder of its motor side is later by a whole number of
/// samples.
fn late(machine: &Machine, delay: f64, encoder: i32) -> Recording {
    let effect = Effect::from_name("sensor_delay").unwrap();
    let mut term = typical(machine, effect, Place::Sensor, 1.0);
    term.values[effect.size()] = delay;
    let mut recording = conceal(machine, term, 1).recording;
    let shift = f64::from(encoder) * PERIOD;
    if shift != 0.0 {
        let channels = recording.channels.iter_mut();
        for channel in channels.filter(|channel| channel.role == Role::MotorPosition) {
            *channel = angle(channel.role, &channel.time, |t| position(t - shift));
        }
    }
    recording
}

/// Whether the delay is told, or in the set, with the size that it has.
fn is_told(machine: &Machine, recording: Recording, delay: f64) -> Result<(), String> {
    let effect = Effect::from_name("sensor_delay").unwrap();
    let said = outcome(machine, &[recording]).diagnosis;
    let miss = || Err(format!("{}: {delay} s: {}", machine.name, said.summary));
    let place = found(&said, effect, Place::Sensor);
    let told = said.findings.iter().find(|own| own.effect == effect.name);
    match (place, told) {
        (Found::First, Some(finding)) => {
            let value = finding.parameters[0].value;
            let right = (value - delay).abs() < 0.1 * PERIOD;
            if right { Ok(()) } else { miss() }
        }
        (Found::InSet, _) => Ok(()),
        _ => miss(),
    }
}

/// One clock stamps all channels of these recordings: no offset can stand for the delay.
#[test]
fn sensors_that_are_some_samples_late_or_early_are_found() {
    let shared = stamps(PERIOD);
    let mut missed = Vec::new();
    for machine in [joint_at(&shared, &shared), gauge(), commanded()] {
        for samples in [-3i32, -2, -1, 1, 2, 3] {
            let delay = f64::from(samples) * PERIOD;
            let mut told = vec![is_told(&machine, late(&machine, delay, 0), delay)];
            if samples.abs() == 1 && machine.name != "commanded" {
                // What the encoder is late the other sensor is early.
                let encoder = late(&machine, 0.2 * delay, -samples);
                told.push(is_told(&machine, encoder, 1.2 * delay));
            }
            missed.extend(told.into_iter().filter_map(Result::err));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
