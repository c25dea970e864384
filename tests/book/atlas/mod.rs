//! The atlas: one page an effect, made by simulation.

mod arm;
mod article;
mod drawing;
mod symptoms;

use super::reference::{MADE, codes, table};
use super::{keep, root, tell_stale};
use arm::{Arm, Fingerprint, arms, stamps, without};
use drawing::{Panel, row, short};
use nalgebra::DVector;
use quell::effects::{Catalogue, Effect, curve};
use quell::model::curves::points;
use quell::model::{ModelEffect, Term};
use quell::signal::{Window, spectrum};
use std::f64::consts::TAU;
use symptoms::{SYMPTOMS, symptoms};

/// Where the first two moves end.
const SHOWN: f64 = 2.6;
/// Highest frequency of a spectrum, Hz.
const HIGHEST: f64 = 40.0;
/// Others with which an effect is compared, at most, and the share of its misfit from which they are told.
const OTHERS: usize = 4;
const ALIKE: f64 = 0.5;

/// An effect in the machine that shows it.
struct Entry<'a> {
    arm: &'a Arm,
    term: Term,
    seen: Fingerprint,
    symptoms: Vec<&'static str>,
}

#[test]
fn the_atlas_is_what_the_simulation_says() {
    let arms = arms();
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
        let (file, page, svg) = (folder.join(name), page(own, &entries), row(&pictures(own)));
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
    let by_symptom = SYMPTOMS.iter().map(|symptom| {
        let own = entries.iter().filter(|own| own.symptoms.contains(symptom));
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
         come from two machines: a {}, and for what only a drive does a {}.\n\n\
         ## By symptom\n\nWhat somebody notices who watches the machine, at the typical size of the effect.\n\n{}\
         ## By place\n\n{}\
         ## How small an effect can be seen\n\nEach page tells the misfit `r` of the effect at its typical size `s`, when the \
         parameters of the model and an offset have been refitted. With noise `n` and `N` samples the \
         log evidence of a size `a` is about `N (a r / s)^2 / (2 T n^2)`, \
         `T = 4`, and it must exceed some 10 ([how the diagnosis decides](../theory/evidence.md)). So the least size is about \
         `9 s n / (r sqrt N)`.\n",
        entries[0].arm.name,
        entries.last().map_or("", |own| own.arm.name),
        table(["symptom", "effects"], by_symptom),
        table(["place", "effects"], by_place),
    )
}

fn page(own: &Entry, entries: &[Entry]) -> String {
    let effect = own.term.effect;
    let noticed = match own.symptoms.as_slice() {
        [] => String::new(),
        some => format!(
            "Who watches the machine notices: it {}.\n\n",
            some.join("; it ").replace("it frequency", "its frequency")
        ),
    };
    format!(
        "# {}\n\n`{}`, at: {}.\n\n{}\n\n{noticed}![Fingerprint of {}]({}.svg)\n\n*{}, at the typical size. Left: what the sensor shows \
         with the effect minus what the refitted model predicts, over the first two moves. {}*\n\n\
         ## What sees it\n\n{}## What it is mistaken for\n\n{}## What to do\n\n{}\n\n## In `model.toml`\n\n```toml,model\n{}```\n",
        capital(effect.title),
        effect.name,
        codes(effect.places.iter().map(|place| place.name())),
        effect.physics,
        effect.title,
        effect.name,
        capital(own.arm.name),
        captions(own),
        sensors(own),
        mistaken(own, entries),
        effect.remedy,
        written(own),
    )
}

fn captions(own: &Entry) -> String {
    let middle = match own.term.effect.slot() {
        Some(slot) => format!(
            "Middle: the {} of the law over the {}.",
            slot.law(),
            slot.coordinate().name()
        ),
        None => "Middle: the misfit over the velocity.".into(),
    };
    format!("{middle} Right: the spectrum of the misfit.")
}

/// What each sensor of the machine shows of it.
fn sensors(own: &Entry) -> String {
    let rows = own
        .arm
        .sensors
        .iter()
        .enumerate()
        .map(|(index, experiment)| {
            let seen = own.arm.fingerprint(index, &own.term);
            let rms = |series: &DVector<f64>| series.norm() / (series.len() as f64).sqrt();
            let unit = &experiment.outputs[0].unit;
            let left = 100.0 * rms(&seen.misfit) / rms(&seen.change).max(f64::MIN_POSITIVE);
            [
                format!("`{}`", experiment.outputs[0].channel.name()),
                format!("{} {unit}", short(rms(&seen.misfit))),
                format!("{left:.0} %"),
            ]
        });
    table(
        ["sensor", "misfit after a refit, rms", "of what it changes"],
        rows,
    )
}

/// Effects in the same machine that explain most of the misfit.
fn mistaken(own: &Entry, entries: &[Entry]) -> String {
    let refit = own.arm.refit(0);
    let square = own.seen.misfit.norm_squared();
    let same = entries
        .iter()
        .filter(|other| std::ptr::eq(other.arm, own.arm) && other.term.effect != own.term.effect);
    let mut others: Vec<(&Entry, f64)> = same
        .map(|other| {
            let mut columns = refit.clone();
            columns.push(other.seen.change.clone());
            let left = without(&own.seen.change, &columns);
            (other, 1.0 - left.norm_squared() / square)
        })
        .filter(|other| other.1 > ALIKE)
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    others.truncate(OTHERS);
    if others.is_empty() {
        return "No other effect explains half of its misfit in this motion.\n\n".into();
    }
    let rows = others.into_iter().map(|(other, share)| {
        let both = [own.term.effect, other.term.effect];
        let alike = quell::effects::LIKENESSES.iter();
        let mut alike = alike.filter(|own| both.iter().all(|effect| effect.is_alike(**own)));
        let tells = alike
            .next()
            .map_or("other moves: `quell diagnose` plans them", |own| {
                own.remedy()
            });
        [
            format!(
                "[{}]({}.md)",
                other.term.effect.title, other.term.effect.name
            ),
            format!("{:.0} %", 100.0 * share),
            tells.to_string(),
        ]
    });
    table(
        ["effect", "explains of the misfit", "what tells them apart"],
        rows,
    )
}

/// The effect in a model file.
fn written(own: &Entry) -> String {
    let mut model = own.arm.model.clone();
    let digits = |value: &f64| format!("{value:.2e}").parse::<f64>().unwrap_or(*value);
    model.effects.push(ModelEffect {
        effect: own.term.effect,
        place: own.term.place,
        parameters: own
            .term
            .values
            .iter()
            .map(|value| digits(value).into())
            .collect(),
    });
    model.to_toml()
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
            title: format!(
                "{} over the {}",
                capital(slot.law()),
                slot.coordinate().name()
            ),
            x,
            y,
            along: slot.coordinate().name().into(),
            up: slot.law().into(),
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
