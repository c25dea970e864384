//! The atlas: one page an effect, made by simulation.

mod arm;
mod article;
mod drawing;
mod elements;
mod in_mujoco;
mod least;
mod lines;
mod mjcf;
mod mujoco;
mod page;
mod symptoms;
mod told;

use super::reference::{MADE, table};
use super::{keep, root, tell_stale};
use arm::{Arm, Fingerprint, arms, stamps};
use drawing::{Panel, row};
use quell::effects::{Catalogue, Effect, curve};
use quell::model::Term;
use quell::model::curves::points;
use quell::signal::{Window, spectrum};
use std::f64::consts::TAU;
use symptoms::symptoms;

/// Where the first two moves end.
const SHOWN: f64 = 2.6;
/// Highest frequency of a spectrum, Hz.
const HIGHEST: f64 = 40.0;

/// An effect in the machine that shows it.
struct Entry<'a> {
    arm: &'a Arm,
    term: Term,
    seen: Fingerprint,
    symptoms: Vec<&'static str>,
}

/// Each effect in the first machine that shows it.
fn entries(arms: &[Arm; 2]) -> Vec<Entry<'_>> {
    let entry = |arm, own| {
        let arm: &Arm = arm;
        let term = arm.typical(own);
        Entry {
            seen: arm.fingerprint(0, &term),
            symptoms: symptoms(arm, &term),
            arm,
            term,
        }
    };
    let of = |arm| {
        let arm: &Arm = arm;
        arm.effects().into_iter().map(move |own| entry(arm, own))
    };
    let mut entries: Vec<Entry> = of(&arms[0]).collect();
    // What the joint shows is not shown again by the axis.
    let known: Vec<&Effect> = entries.iter().map(|own| own.term.effect).collect();
    entries.extend(of(&arms[1]).filter(|own| !known.contains(&own.term.effect)));
    entries
}

#[test]
fn the_atlas_is_what_the_simulation_says() {
    let arms = arms();
    let entries = entries(&arms);
    let mute = entries.iter().filter(|own| own.symptoms.is_empty());
    let mute: Vec<&str> = mute.map(|own| own.term.effect.name).collect();
    assert!(mute.is_empty(), "no symptom leads to {mute:?}");
    let idle = entries.iter().filter(|own| own.seen.misfit.amax() == 0.0);
    let idle: Vec<&str> = idle.map(|own| own.term.effect.name).collect();
    assert!(
        idle.is_empty(),
        "{idle:?} do not act in the standard motion"
    );
    let folder = root().join("docs/src/atlas");
    let mut stale = Vec::new();
    keep(
        &folder.join("index.md"),
        &format!("{MADE}{}", index(&entries)),
        &mut stale,
    );
    let mut articles = String::new();
    for own in &entries {
        let name = own.term.effect.name;
        let (file, page, svg) = (
            folder.join(name),
            page::page(own, &entries),
            row(&pictures(own)),
        );
        articles += &article::article(name, &page, &svg);
        let page = format!("{MADE}{page}");
        keep(&file.with_extension("md"), &page, &mut stale);
        keep(&file.with_extension("svg"), &svg, &mut stale);
    }
    let carried = root().join("crates/report/assets/atlas.html");
    keep(&carried, &articles, &mut stale);
    tell_stale(&stale);
}

fn index(entries: &[Entry]) -> String {
    let link = |own: &Entry| format!("[{}]({}.md)", own.term.effect.title, own.term.effect.name);
    let links = |own: Vec<&Entry>| own.into_iter().map(link).collect::<Vec<_>>().join(", ");
    let by_symptom = symptoms::all().map(|symptom| {
        let own = entries.iter().filter(|own| own.symptoms.contains(&symptom));
        [symptom.to_string(), links(own.collect())]
    });
    let by_symptom = by_symptom.filter(|row| !row[1].is_empty());
    let by_place = Catalogue::default().by_place().into_iter();
    let by_place = by_place.map(|(place, names)| {
        let own = entries
            .iter()
            .filter(|own| names.contains(&own.term.effect.name));
        [place.name().to_string(), links(own.collect())]
    });
    format!(
        "# The atlas of effects\n\nOne page for each effect of the catalogue. Each shows the effect at its typical size in a standard \
         motion: two large moves there and back, then two small ones. The pictures and figures are simulated. They \
         come from two machines: a {}, and, for the effects of a drive, a {}.\n\n\
         ## By symptom\n\nWhat somebody notices who watches the machine or its reading. Ringing, stops and delays are read from the \
         standard motion, at the typical size of the effect. The other symptoms follow from its physics.\n\n{}\
         ## By place\n\n{}\
         ## How small an effect can be seen\n\nEach page tells the least size that each sensor sees in the standard motion, \
         above a white noise that it names. The misfit `r` is that of the effect \
         when the parameters of the model and an offset have been refitted. With noise `n` and `N` samples its \
         log evidence is about `N r^2 / (2 T n^2)`, \
         `T = 4`, and it must exceed some 10 ([how the diagnosis decides](../theory/evidence.md)). With another noise or \
         another number of samples: the misfit of an effect of size `s` is nearly in proportion to `s`, so that the least size is about \
         `9 s n / (r sqrt N)`.\n\n\
         ## In MuJoCo\n\nEach page says which elements of [MuJoCo](https://mujoco.org) 4.0 hold the effect, or what to do where none does. \
         The elements replace those of the same name in one of two models, or are added. The flexible joint, for a link of 1 kg m^2:\n\n```xml\n{}```\n\n\
         The axis under a position loop:\n\n```xml\n{}```\n",
        entries[0].arm.name,
        entries.last().map_or("", |own| own.arm.name),
        table(["symptom", "effects"], by_symptom),
        table(["place", "effects"], by_place),
        elements::plain(entries[0].arm).whole(),
        entries
            .last()
            .map_or_else(String::new, |own| elements::plain(own.arm).whole()),
    )
}

fn pictures(own: &Entry) -> [Panel; 3] {
    let arm = own.arm;
    let (effect, unit) = (own.term.effect, &arm.sensors[0].outputs[0].unit);
    let (time, misfit) = (stamps(), own.seen.misfit.as_slice());
    let count = time.partition_point(|stamp| *stamp < SHOWN);
    let law = effect.slot().and_then(|slot| {
        let x = points(slot, arm.range(slot.coordinate()));
        let y = curve(effect, &own.term.values, &arm.model.still(), &x)?;
        Some(Panel {
            title: format!("{} over {}", capital(slot.law()), slot.coordinate().name()),
            x,
            y,
            along: arm.with_unit(slot.coordinate().name(), slot.quantities()[0]),
            up: arm.with_unit(slot.law(), slot.quantities()[1]),
        })
    });
    let over_velocity = || {
        let shown = arm.shown(0, &arm.model.keys(), &[]);
        let rate = |k: usize| (shown[k + 1] - shown[k]) / (time[k + 1] - time[k]);
        Panel {
            title: "Misfit over velocity".into(),
            x: (0..count).map(rate).collect(),
            y: misfit[..count].to_vec(),
            along: format!("velocity, {}/s", arm.unit),
            up: format!("misfit, {unit}"),
        }
    };
    let lines = spectrum(misfit, time[1], Window::Rectangular, 1).unwrap();
    let highest = (HIGHEST * TAU / lines.resolution) as usize;
    [
        Panel {
            title: "Misfit over time".into(),
            x: time[..count].to_vec(),
            y: misfit[..count].to_vec(),
            along: "time, s".into(),
            up: format!("misfit, {unit}"),
        },
        law.unwrap_or_else(over_velocity),
        Panel {
            title: "Spectrum of the misfit".into(),
            x: (1..highest)
                .map(|k| lines.resolution / TAU * k as f64)
                .collect(),
            y: lines.amplitude[1..highest].to_vec(),
            along: "frequency, Hz".into(),
            up: format!("amplitude, {unit}"),
        },
    ]
}

fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters
        .next()
        .map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + characters.as_str()
}
