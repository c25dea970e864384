//! A case of a driven axis.

use super::axis::{Axis, Command, Driven};
use super::axis_effects::Forces;
use super::axis_laws::{entries, shape_of};
use super::axis_refit::{Hidden, Recorded};
use super::integrate::{STATES, integrate};
use super::plan::{Plan, Table};
use super::programme::{Programme, Style};
use super::random::Draw;
use super::recorded::rounded;
use super::sensors::{Colour, Noise};
use super::size::SHARES;
use super::{Case, Oracle};
use crate::families::family;
use crate::kind::Kind;
use crate::truth::{HiddenEffect, Truth};
use quell_recording::{Channel, Recording, Role};
use quell_trajectories::PlanError;
use serde_json::json;
use std::f64::consts::TAU;

/// Step of the integration, s.
const STEP: f64 = 1e-4;

/// `None` where the axis does not show as many effects as the kind has.
pub(super) fn generate(draw: &mut Draw, kind: Option<Kind>) -> Result<Option<Case>, PlanError> {
    let plan = Plan::draw(draw, kind);
    let mut axis = axis(draw);
    let style = Style {
        natural_frequency: draw.uniform(20.0, 60.0),
        acceleration: draw.log_uniform(0.8, 5.0),
        velocity: draw.uniform(0.2, 0.8),
        range: draw.uniform(0.1, 0.4),
        rich: true,
    };
    let (train, test) = (
        Programme::draw(draw, &style)?,
        Programme::draw(draw, &style)?,
    );
    let model = model(draw, &axis);
    let nominal = [axis.mass, axis.viscous];
    let plain = axis.clone();
    let forces = forces(&plain, &train);
    let hidden = conceal(draw, plan);
    let effects = put_in(&mut axis, &forces, &hidden);
    if !plan.is_met_by(effects.len()) {
        return Ok(None);
    }
    let rate = draw.pick(&[500.0, 1000.0]).copied().unwrap_or(1000.0);
    let noise = Noise {
        std: draw.uniform(5e-6, 2e-5),
        colour: if draw.chance(0.6) {
            Colour::White
        } else {
            Colour::Quantised
        },
    };
    if kind.is_some() && !all_show([&plain, &axis], &forces, &train, &hidden, noise.std) {
        return Ok(None);
    }
    let mut truth = truth(&noise, effects, nominal);
    truth.in_catalogue = matches!(plan.table, Table::Catalogue | Table::Shaped);
    if plan.table == Table::Shaped {
        let shapes = hidden.iter().map(|one| shape_of(one.entry.0));
        let shapes: Vec<&str> = shapes.collect();
        truth.more.insert("shape".into(), shapes.join("+").into());
    }
    if let Some(kind) = kind {
        truth.more.insert("kind".into(), kind.name().into());
    }
    let (recorded, _) = record(draw, &axis, &train, (rate, &noise), "train");
    let (tested, predicted) = record(draw, &axis, &test, (rate, &noise), "test");
    Ok(Some(Case {
        model,
        train: recorded,
        test: tested,
        truth,
        oracle: Oracle::Axis { predicted },
    }))
}

fn axis(draw: &mut Draw) -> Axis {
    let mass = draw.log_uniform(5.0, 200.0);
    Axis {
        mass,
        viscous: mass / draw.log_uniform(0.2, 2.0),
        believed_mass: mass * draw.uniform(0.85, 1.15),
        bandwidth: TAU * draw.uniform(4.0, 12.0),
        ..Axis::default()
    }
}

fn conceal(draw: &mut Draw, plan: Plan) -> Vec<Hidden> {
    let mut hidden: Vec<Hidden> = Vec::new();
    while hidden.len() < plan.effects {
        let strange = |name: &str| {
            let other = |other: &Hidden| family(other.entry.0) != family(name);
            hidden.iter().all(other)
        };
        let suitable = entries(plan.table).filter(|entry| strange(entry.0));
        let Some(&entry) = draw.pick(&suitable.collect::<Vec<_>>()) else {
            break;
        };
        let share = draw.log_uniform(SHARES[0], SHARES[1]);
        let shape = [(); 3].map(|()| draw.uniform(0.0, 1.0));
        hidden.push(Hidden {
            entry,
            share,
            shape,
        });
    }
    hidden
}

/// Puts all of it into an axis.
fn put_in(axis: &mut Axis, forces: &Forces, hidden: &[Hidden]) -> Vec<HiddenEffect> {
    let effect = |one: &Hidden| {
        let parameters = (one.entry.2)(axis, forces, one.share, one.shape);
        let named = parameters.iter();
        HiddenEffect {
            effect: one.entry.0.into(),
            place: "drive".into(),
            parameters: named
                .map(|(name, value)| (name.to_string(), *value))
                .collect(),
        }
    };
    hidden.iter().map(effect).collect()
}

/// Whether each of several effects shows beside the others in the recording, and a deviating shape as more than
/// the textbook's law.
fn all_show(
    [plain, hurt]: [&Axis; 2],
    forces: &Forces,
    programme: &Programme,
    hidden: &[Hidden],
    noise: f64,
) -> bool {
    let cycle = 2e-3;
    let count = (programme.duration / cycle) as usize;
    let told = told(hurt, programme, cycle, count);
    let stamps: Vec<f64> = (1..count / 4).map(|k| 4.0 * k as f64 * cycle).collect();
    let recorded = Recorded {
        plain,
        forces,
        told: (&told, cycle),
        stamps: &stamps,
        positions: &run(hurt, programme, &stamps, false),
        noise,
    };
    let textbook = |one: &Hidden| {
        let entry = entries(Table::Catalogue).find(|entry| entry.0 == one.entry.0)?;
        Some(Hidden { entry, ..*one })
    };
    let shaped = hidden.iter().filter(|one| one.entry.1 == Table::Shaped);
    let mut textbooks = shaped.filter_map(textbook);
    recorded.all_show(hidden) && textbooks.all(|one| recorded.shows_beside(&[one]))
}

fn run(axis: &Axis, programme: &Programme, times: &[f64], shows_impulse: bool) -> Vec<f64> {
    let driven = Driven {
        axis,
        command: Command::Controller(programme),
        shows_impulse,
    };
    let mut breaks: Vec<f64> = programme.corners().collect();
    breaks.sort_by(f64::total_cmp);
    integrate(&driven, [0.0; STATES], STEP, &breaks, times)
}

fn forces(axis: &Axis, programme: &Programme) -> Forces {
    let spacing = 2e-3;
    let count = (programme.duration / spacing) as usize;
    let times: Vec<f64> = (1..count).map(|k| k as f64 * spacing).collect();
    let force = told(axis, programme, spacing, count - 1);
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|x| x * x).sum::<f64>() / count as f64).sqrt()
    };
    let greatest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(1e-9, |most: f64, value| most.max(value.abs()))
    };
    let level = rms(&mut force.iter().copied());
    Forces {
        rms: level,
        most: greatest(&mut force.iter().copied()),
        rate: rms(&mut force.windows(2).map(|pair| (pair[1] - pair[0]) / spacing)) / level,
        speed: greatest(&mut times.iter().map(|&t| programme.at(t)[1])),
        span: programme.span(),
    }
}

/// The recording, and the positions without noise.
fn record(
    draw: &mut Draw,
    axis: &Axis,
    programme: &Programme,
    (rate, noise): (f64, &Noise),
    name: &str,
) -> (Recording, Vec<f64>) {
    let count = (programme.duration * rate) as usize;
    let time: Vec<f64> = (0..count).map(|k| k as f64 / rate).collect();
    let position = run(axis, programme, &time, false);
    let mut seen = position.clone();
    noise.add(draw, &mut seen);
    let channel = |role, unit: &str, column| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![column],
    };
    let force = told(axis, programme, 1.0 / rate, count);
    let force = force.iter().map(|force| rounded(*force, 1e-6)).collect();
    let channels = vec![
        channel(Role::Force, "N", force),
        channel(Role::MotorPosition, "m", seen),
    ];
    (
        Recording {
            name: name.into(),
            payload: None,
            channels,
        },
        position,
    )
}

/// The force as a drive reports it: its mean over the cycle that begins at each stamp. A record at the rate of
/// the cycle thus contains the whole impulse.
fn told(axis: &Axis, programme: &Programme, cycle: f64, count: usize) -> Vec<f64> {
    let times: Vec<f64> = (0..=count).map(|k| k as f64 * cycle).collect();
    let impulse = run(axis, programme, &times, true);
    impulse
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / cycle)
        .collect()
}

fn truth(noise: &Noise, effects: Vec<HiddenEffect>, [mass, viscous]: [f64; 2]) -> Truth {
    let more = json!({
        "noise_colour": noise.colour.name(),
        "programme": "rich",
        "mass": mass,
        "viscous": viscous,
    });
    // In a linear axis a delay of the force and one of the position are equivalent.
    let late = effects.iter().any(|effect| effect.effect == "drive_lag");
    let equivalents = late.then(|| "sensor_lag".to_string());
    Truth {
        effects,
        equivalents: equivalents.into_iter().collect(),
        noise: noise.std,
        noise_unit: "m".into(),
        more: more.as_object().cloned().unwrap_or_default(),
        ..Truth::default()
    }
}

fn model(draw: &mut Draw, axis: &Axis) -> String {
    let mass = axis.mass * (1.0 + draw.uniform(-0.05, 0.05));
    let viscous = axis.viscous * (1.0 + draw.uniform(-0.25, 0.25));
    format!(
        "# the nominal model: a driven axis, force in and position out\n\
         kind = \"rigid_axis\"\n\
         input_hold = \"zero_order\"\n\
         mass = {mass:.4}\n\
         viscous = {viscous:.4}\n"
    )
}
