//! What stands on the page of an effect.

use super::arm::without;
use super::drawing::short;
use super::elements;
use super::least::{Seen, noise, seen};
use super::mjcf::Mjcf;
use super::mujoco::{Form, form};
use super::{Entry, capital};
use crate::reference::{codes, table};
use nalgebra::DVector;
use quell::model::ModelEffect;

/// Others with which an effect is compared, at most, and the share of its misfit from which they are told.
const OTHERS: usize = 4;
const ALIKE: f64 = 0.5;

/// The page in Markdown.
pub fn page(own: &Entry, entries: &[Entry]) -> String {
    let effect = own.term.effect;
    let noticed: Vec<String> = own.symptoms.iter().map(|own| clause(own)).collect();
    format!(
        "# {}\n\n`{}`, at: {}.\n\n{}\n\nWho watches the machine notices: {}.\n\n![Fingerprint of {}]({}.svg)\n\n*{}, at the typical size. Left: what the sensor shows \
         with the effect minus what the refitted model predicts, over the first two moves. {}*\n\n\
         ## What sees it\n\n{}## What it is mistaken for\n\n{}## What to do\n\n{}\n\n## In `model.toml`\n\n```toml,model\n{}```\n\n\
         ## In MuJoCo\n\n{}\n",
        capital(effect.title),
        effect.name,
        codes(effect.places.iter().map(|place| place.name())),
        effect.physics,
        noticed.join("; "),
        effect.title,
        effect.name,
        capital(own.arm.name),
        captions(own),
        sensors(own),
        mistaken(own, entries),
        effect.remedy,
        written(own),
        in_mujoco(own),
    )
}

/// A symptom with its subject: the machine, or something of it.
fn clause(symptom: &str) -> String {
    const OWNED: [&str; 4] = ["frequency", "error", "reading", "vibration"];
    let owned = OWNED.iter().any(|own| symptom.starts_with(own));
    format!("{} {symptom}", if owned { "its" } else { "it" })
}

/// The elements of MuJoCo that hold it, or what to do.
fn in_mujoco(own: &Entry) -> String {
    let base = elements::plain(own.arm);
    let block = |mjcf: &Mjcf| {
        format!(
            "In the [model of the {}](index.md#in-mujoco):\n\n```xml\n{}```",
            own.arm.short,
            mjcf.beside(&base)
        )
    };
    match form(own.arm, &own.term) {
        Form::Same(mjcf) => block(&mjcf),
        Form::Like(mjcf, note) => format!("{}\n\n{note}", block(&mjcf)),
        Form::None(note) => note.into(),
    }
}

fn captions(own: &Entry) -> String {
    let middle = match own.term.effect.slot() {
        Some(slot) => format!(
            "Middle: the law of the effect, {} over {}.",
            slot.law(),
            slot.coordinate().name()
        ),
        None => "Middle: the misfit over velocity.".into(),
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
            let print = own.arm.fingerprint(index, &own.term);
            let rms = |series: &DVector<f64>| series.norm() / (series.len() as f64).sqrt();
            let unit = &experiment.outputs[0].unit;
            let name = experiment.outputs[0].channel.name();
            let left = 100.0 * rms(&print.misfit) / rms(&print.change).max(f64::MIN_POSITIVE);
            [
                format!("`{name}`, {}", noise(name).1),
                told(&seen(own.arm, index, &own.term)),
                format!("{} {unit}", short(rms(&print.misfit))),
                format!("{left:.0} %"),
            ]
        });
    let size = &own.term.effect.parameters[own.term.effect.size()];
    let sees = own.arm.with_unit(
        &format!("sees {}", size.name.replace('_', " ")),
        size.quantity,
    );
    table(
        [
            "sensor, its noise",
            &sees,
            "misfit after a refit, rms",
            "of what it changes",
        ],
        rows,
    )
}

/// Two digits.
fn shorter(value: f64) -> String {
    let rounded = format!("{value:.1e}");
    match (1e-3..1e3).contains(&value.abs()) {
        true => short(rounded.parse().unwrap_or(value)),
        false => rounded.replace(".0e", "e"),
    }
}

/// Which sizes are seen.
fn told(seen: &Seen) -> String {
    match seen {
        Seen::From(0.0) | Seen::UpTo(f64::INFINITY) => "at any size".into(),
        Seen::From(f64::INFINITY) | Seen::UpTo(0.0) => "at no size".into(),
        Seen::From(size) => format!("from {}", shorter(*size)),
        Seen::UpTo(size) => format!("up to {}", shorter(*size)),
    }
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
    model.to_toml_in(&own.arm.units())
}
