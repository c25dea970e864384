//! Conformance of the whole catalogue: each effect, simulated at its typical size at each of its places, is
//! found again, or told in a set that holds it; or no motion of that machine tells it from another one,
//! and the table says why.

mod concealed;
mod machines;

use concealed::conceal;
use machines::machines;
use quell::diagnosis::{Diagnosis, Options, diagnose};
use quell::effects::{EFFECTS, Effect, Place};

#[test]
fn each_effect_is_found_again() {
    let only = std::env::var("ONLY").ok();
    let factor = std::env::var("FACTOR").ok().map_or(1.0, |f| f.parse().unwrap());
    let seed = std::env::var("SEED").ok().map_or(1, |f| f.parse().unwrap());
    for effect in EFFECTS.iter().copied() {
        if only.as_ref().is_some_and(|only| !only.split(',').any(|o| o == effect.name)) {
            continue;
        }
        for &place in effect.places {
            for machine in machines().iter().filter(|m| m.can_have(effect, place)).filter(|m| std::env::var("ON").ok().is_none_or(|on| m.name == on)) {
                let start = std::time::Instant::now();
                let hidden = conceal(machine, effect, place, factor, seed);
                if hidden.residual == 0.0 { println!("UNSEEN {}/{} on {}", effect.name, place.name(), machine.name); continue; }
                let train = [hidden.recording];
                let outcome = diagnose(&machine.model, &train, &[], &Options::default(), &|_, _| {}).unwrap();
                let said = outcome.diagnosis;
                println!("{} {}/{} on {}: {} | {:?} {} | ratio {:.1} noise {:.2e}/{:.2e} true {:?} fit {:.2}->{:.2} | {:.1} s",
                    verdict(&said, effect, place), effect.name, place.name(), machine.name, said.verdict.name(),
                    said.findings.iter().map(|f| (f.effect.clone(), f.place.clone(), f.alternatives.clone(), f.parameters.iter().map(|p| p.value).collect::<Vec<_>>())).collect::<Vec<_>>(),
                    said.candidates.iter().take(std::env::var("TOP").ok().map_or(4, |t| t.parse().unwrap())).map(|c| format!("{}@{}:{:.0}/{:.3}", c.effect, c.place, c.delta_bic, c.held_out_ratio)).collect::<Vec<_>>().join(" "),
                    hidden.residual, hidden.noise, said.fit.noise_std, hidden.values, said.fit.before.held_out_over_noise, said.fit.after.held_out_over_noise, start.elapsed().as_secs_f64());
            }
        }
    }
}

fn verdict(said: &Diagnosis, effect: &Effect, place: Place) -> &'static str {
    let Some(first) = said.findings.first() else { return "MISSED" };
    if first.effect == effect.name && first.place == place.name() { 
        if said.findings.len() > 1 {return "FIRST+"};
        return "FIRST" }
    if said.findings.iter().any(|f| f.effect == effect.name) { return "SECOND" }
    if said.findings.iter().any(|f| f.alternatives.iter().any(|a| a == effect.name)) { return "SET" }
    "WRONG"
}
