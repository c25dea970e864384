//! A case of a flexible joint.

use super::hidden::{Entry, Scales, entries};
use super::joint::Joint;
use super::plan::Plan;
use super::programme::{Programme, Style};
use super::random::Draw;
use super::recorded::{Instruments, TrueTest, begun_later};
use super::sensors::{Arm, Colour, Faults, Noise};
use super::size::{Bench, Concealed};
use super::{Case, Channel, Oracle};
use crate::families::family;
use crate::kind::Kind;
use crate::truth::{HiddenEffect, Truth};
use nalgebra::{Rotation3, Vector3};
use quell_trajectories::PlanError;
use serde_json::json;
use std::f64::consts::{PI, TAU};

/// Step of the recordings, s, or a share of a radian of the fastest spring.
const STEP: f64 = 1e-4;
/// Share of the programmes whose recording begins while the arm still rings.
const RINGING: f64 = 0.1;
/// Effects that are tried until one or two can be seen; moves, until they come as far as others.
const TRIES: usize = 12;
/// A position that is as good as the start's, rad: no more than the deformation of a typical move.
const NOWHERE: f64 = 1e-3;
/// Least share to which moves may shrink: what bends the joint by a millirad then bends it by ten times the noise
/// of a tracker.
const LEAST_SCALE: f64 = 0.2;

/// `None` where the arm does not show as many effects as the kind has.
pub(super) fn generate(draw: &mut Draw, kind: Option<Kind>) -> Result<Option<Case>, PlanError> {
    let plan = Plan::draw(draw, kind);
    let rich = draw.chance(0.75);
    let arm = arm_of(draw);
    let (style, train) = moves(draw, &arm, rich)?;
    let mut test = Programme::draw(draw, &style)?;
    let scales = scales(&arm, &train);
    let instruments = instruments(draw, &arm);
    let noise = instruments.noise.std;
    let hidden = conceal(draw, plan, &Bench::new(&arm, &train, &scales, noise), rich);
    if !plan.is_met_by(hidden.len()) {
        return Ok(None);
    }
    let mut hurt = with_all(&arm, &scales, &hidden);
    if hurt.joint.stop.is_some() {
        test = coming_as_far(draw, &style, &train, test)?;
    }
    let residual = Bench::new(&hurt, &train, &scales, noise).residual(&hurt);
    let ringing = rich && hurt.joint.knocks.is_empty() && draw.chance(RINGING);
    let step = STEP.min(0.02 / scales.natural_frequency);
    let record = |draw: &mut Draw, arm: &Arm, programme: &Programme, name: &str| {
        let whole = instruments.record(draw, arm, programme, (name, step));
        match programme.pauses.get(1).filter(|_| ringing) {
            Some([end_of_move, _]) => begun_later(whole, end_of_move + 0.01),
            None => whole,
        }
    };
    let recorded = record(draw, &hurt, &train, "train");
    // Knocks and grips happen once; what shakes the machine is switched off.
    hurt.joint.knocks.clear();
    hurt.joint.shaking = [0.0; 3];
    hurt.joint.payload = None;
    let tested = record(draw, &hurt, &test, "test");
    let mut truth = truth(&arm, &instruments, &hidden, rich, residual);
    truth.more.insert("starts_ringing".into(), ringing.into());
    if let Some(kind) = plan.kind {
        truth.more.insert("kind".into(), kind.name().into());
    }
    let model = model(draw, &arm);
    let (arm, programme) = (hurt, test);
    let oracle = Oracle::Joint(Box::new(TrueTest {
        arm,
        programme,
        noise,
        step,
    }));
    Ok(Some(Case {
        model,
        train: recorded,
        test: tested,
        truth,
        oracle,
    }))
}

/// An arm in which nothing is hidden.
pub(super) fn arm_of(draw: &mut Draw) -> Arm {
    let frequency = draw.log_uniform(3.0, 20.0) * TAU;
    let damping_ratio = draw.log_uniform(0.01, 0.12);
    let lever_arm = draw.uniform(0.5, 2.5);
    // A link of this length with 5 to 30 kg near its end.
    let inertia = draw.uniform(5.0, 30.0) * lever_arm * lever_arm;
    let channel = match draw.uniform(0.0, 1.0) {
        x if x < 0.65 => Channel::Tip,
        x if x < 0.83 => Channel::Link,
        _ => Channel::Deformation,
    };
    let own_clock = channel != Channel::Deformation;
    Arm {
        joint: Joint {
            inertia,
            stiffness: inertia * frequency * frequency,
            damping: 2.0 * damping_ratio * frequency * inertia,
            ..Joint::default()
        },
        faults: Faults::default(),
        channel,
        lever_arm,
        tip_height: draw.uniform(0.2, 1.2),
        frame: frame(draw),
        clock_offset: if own_clock {
            draw.uniform(-2e-3, 2e-3)
        } else {
            0.0
        },
    }
}

/// A tracker some metres away, set up level within 2 deg, turned at will.
fn frame(draw: &mut Draw) -> (Rotation3<f64>, Vector3<f64>) {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), draw.uniform(-PI, PI));
    let tilt = Vector3::new(draw.normal(), draw.normal(), 0.0) * 0.02;
    let away = [(); 3].map(|()| draw.uniform(-4.0, 4.0));
    (Rotation3::new(tilt) * turn, Vector3::from(away))
}

/// Moves that bend the arm by a few tenths of a millirad to 3 mrad.
fn moves(draw: &mut Draw, arm: &Arm, rich: bool) -> Result<(Style, Programme), PlanError> {
    let natural_frequency = (arm.joint.stiffness / arm.joint.inertia).sqrt();
    let bend = draw.log_uniform(1e-3, 3e-3);
    let acceleration = (bend * natural_frequency.powi(2)).clamp(0.4, 12.0);
    let style = Style {
        natural_frequency,
        acceleration,
        velocity: draw.uniform(0.4, 1.5),
        range: draw.uniform(0.3, 0.9),
        rich,
    };
    Ok((style, Programme::draw(draw, &style)?))
}

/// Moves that come as far up as others do: an end stop stands in the way of both. Drawn again where they would
/// have to shrink so much that hardly a move is left.
fn coming_as_far(
    draw: &mut Draw,
    style: &Style,
    others: &Programme,
    mut moves: Programme,
) -> Result<Programme, PlanError> {
    let far = others.span()[1];
    for _ in 0..TRIES {
        let own = moves.span()[1];
        if own <= NOWHERE {
            return Ok(moves);
        }
        if far / own > LEAST_SCALE {
            return Ok(moves.scaled(far / own));
        }
        moves = Programme::draw(draw, style)?;
    }
    let own = moves.span()[1];
    Ok(match own <= NOWHERE {
        true => moves,
        false => moves.scaled(far / own),
    })
}

pub(super) fn scales(arm: &Arm, programme: &Programme) -> Scales {
    let mut bent = arm.clone();
    (bent.channel, bent.clock_offset) = (Channel::Deformation, 0.0);
    let natural_frequency = (arm.joint.stiffness / arm.joint.inertia).sqrt();
    let samples = (programme.duration * natural_frequency * 2.0) as usize;
    let spacing = programme.duration / samples as f64;
    let stamps: Vec<f64> = (1..samples).map(|k| k as f64 * spacing).collect();
    let bent = bent
        .read(programme, &stamps, 0.05 / natural_frequency)
        .swap_remove(0);
    let greatest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(1e-9, |most: f64, value| most.max(value.abs()))
    };
    let squares = bent.iter().map(|x| x * x).sum::<f64>();
    Scales {
        deformation: greatest(&mut bent.iter().copied()),
        deformation_rms: (squares / samples as f64).sqrt(),
        rate: greatest(&mut bent.windows(2).map(|pair| (pair[1] - pair[0]) / spacing)),
        natural_frequency,
        speed: greatest(&mut stamps.iter().map(|&t| programme.at(t)[1])),
        span: programme.span(),
        pauses: programme.pauses.clone(),
        duration: programme.duration,
    }
}

fn instruments(draw: &mut Draw, arm: &Arm) -> Instruments {
    let micrometres = draw.uniform(5.0, 20.0);
    let at_sensor = if arm.channel == Channel::Tip {
        1.0
    } else {
        arm.lever_arm
    };
    let colour = match draw.uniform(0.0, 1.0) {
        x if x < 0.6 => Colour::White,
        x if x < 0.8 => Colour::Autoregressive(draw.uniform(0.3, 0.8)),
        _ => Colour::Quantised,
    };
    let bits = draw.pick(&[20, 21, 22, 23, 24]).copied().unwrap_or(22);
    // Its rounding stays below a third of the noise of the other sensor, as seen at the joint.
    let angle = micrometres * 1e-6 / arm.lever_arm;
    let encoder_step = (TAU / f64::powi(2.0, bits)).min(angle);
    let pick = |draw: &mut Draw, rates: &[f64]| draw.pick(rates).copied().unwrap_or(1000.0);
    Instruments {
        encoder_rate: pick(draw, &[250.0, 500.0, 1000.0]),
        encoder_step,
        sensor_rate: pick(draw, &[1000.0 / 3.0, 500.0, 1000.0]),
        noise: Noise {
            std: micrometres * 1e-6 / at_sensor,
            colour,
        },
        missing: if draw.chance(0.15) {
            draw.uniform(0.005, 0.05)
        } else {
            0.0
        },
        jitter: if draw.chance(0.1) {
            draw.uniform(0.02, 0.15)
        } else {
            0.0
        },
    }
}

/// The hidden effects. Each is sized in the arm without the others, so that it does not depend on them, and
/// must show beside them.
fn conceal(draw: &mut Draw, plan: Plan, bench: &Bench, rich: bool) -> Vec<Concealed> {
    let mut hidden: Vec<Concealed> = Vec::new();
    for _ in 0..TRIES * plan.effects.div_ceil(2) {
        if hidden.len() == plan.effects {
            break;
        }
        let strange = |entry: &Entry| {
            let other = |other: &Concealed| family(other.entry.name) != family(entry.name);
            hidden.iter().all(other)
        };
        let suits = |entry: &&Entry| {
            entry.channels.contains(&bench.arm.channel)
                && (rich || !entry.needs_programme)
                && strange(entry)
        };
        let suitable: Vec<&'static Entry> = entries(plan.table).filter(suits).collect();
        let Some(entry) = draw.pick(&suitable).copied() else {
            break;
        };
        let Some(found) = bench.conceal(draw, entry) else {
            continue;
        };
        hidden.push(found);
        if !bench.all_show(&hidden) {
            hidden.pop();
        }
    }
    hidden
}

/// The arm with all that is hidden in it.
fn with_all(arm: &Arm, scales: &Scales, hidden: &[Concealed]) -> Arm {
    let mut hurt = arm.clone();
    for concealed in hidden {
        (concealed.entry.hide)(&mut hurt, scales, concealed.shape, concealed.size);
    }
    hurt
}

/// Names that no motion distinguishes from the hidden effect: for a sensor of positions a mode far above the
/// motion is equivalent to a gain of the deformation.
fn equivalents(arm: &Arm, hidden: &[Concealed]) -> Vec<String> {
    let gain = |concealed: &Concealed| concealed.entry.name == "deformation_gain";
    let alone = hidden.len() == 1 && hidden.iter().all(gain);
    match alone && arm.channel != Channel::Deformation {
        true => ["second_mode", "base_mode"].map(String::from).to_vec(),
        false => Vec::new(),
    }
}

fn truth(
    arm: &Arm,
    instruments: &Instruments,
    hidden: &[Concealed],
    rich: bool,
    residual: f64,
) -> Truth {
    let natural_frequency = (arm.joint.stiffness / arm.joint.inertia).sqrt();
    let damping_ratio = arm.joint.damping / (2.0 * arm.joint.inertia * natural_frequency);
    let shares: Vec<f64> = hidden.iter().map(|concealed| concealed.share).collect();
    let programme = if rich { "rich" } else { "single move" };
    let more = json!({
        "noise_colour": instruments.noise.colour.name(),
        "programme": programme,
        "share_of_deformation": shares,
        "missing_samples": instruments.missing,
        "clock_jitter": instruments.jitter,
        "inertia": arm.joint.inertia,
    });
    let mut more = more.as_object().cloned().unwrap_or_default();
    let shapes: Vec<&str> = hidden
        .iter()
        .map(|concealed| concealed.entry.shape)
        .collect();
    if shapes.iter().any(|shape| !shape.is_empty()) {
        more.insert("shape".into(), shapes.join("+").into());
    }
    Truth {
        effects: hidden.iter().map(effect).collect(),
        equivalents: equivalents(arm, hidden),
        in_catalogue: hidden.iter().all(|concealed| concealed.entry.in_catalogue),
        natural_frequency_hz: Some(natural_frequency / TAU),
        damping_ratio: Some(damping_ratio),
        noise: instruments.noise.std,
        noise_unit: if arm.channel == Channel::Tip {
            "m"
        } else {
            "rad"
        }
        .into(),
        clock_offset_s: Some(arm.clock_offset),
        baseline_residual_over_noise: Some(residual),
        more,
    }
}

fn effect(concealed: &Concealed) -> HiddenEffect {
    let parameters = concealed.parameters.iter();
    let mut parameters: Vec<_> = parameters
        .map(|(name, value)| (name.to_string(), *value))
        .collect();
    parameters.sort_by(|a, b| a.0.cmp(&b.0));
    HiddenEffect {
        effect: concealed.entry.name.into(),
        place: concealed.entry.place.into(),
        parameters,
    }
}

/// What the engineer believes: up to 5 % off in frequency and 25 % in damping.
fn model(draw: &mut Draw, arm: &Arm) -> String {
    let natural_frequency = (arm.joint.stiffness / arm.joint.inertia).sqrt();
    let damping_ratio = arm.joint.damping / (2.0 * arm.joint.inertia * natural_frequency);
    let frequency_hz = natural_frequency / TAU * (1.0 + draw.uniform(-0.05, 0.05));
    let damping_ratio = damping_ratio * (1.0 + draw.uniform(-0.25, 0.25));
    // Lever arm and height to the bit, so that none is wrong by its rounding.
    format!(
        "# the nominal model: a flexible joint driven by its motor side\n\
         kind = \"flexible_joint\"\n\
         natural_frequency_hz = {frequency_hz:.4}\n\
         damping_ratio = {damping_ratio:.4}\n\
         lever_arm_m = {}\n\
         tip_height_m = {}\n",
        arm.lever_arm, arm.tip_height
    )
}
