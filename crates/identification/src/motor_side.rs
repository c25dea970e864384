//! The motor side's motion, by whichever channel a recording has of it.

use quell_recording::{Channel, Recording, Role};
use quell_signal::{Motion, Phase, RestRule, SignalError, integrated_velocity, phases};
use std::collections::BTreeMap;

/// Channels of the motor side's motion, the preferred one first. A command stands for what the motor side does of
/// it.
const ROLES: [Role; 3] = [
    Role::MotorPosition,
    Role::MotorVelocity,
    Role::CommandPosition,
];
/// Shortest rest in which a decay is looked for, s: two periods of 4 Hz.
const SHORTEST: f64 = 0.5;
/// Parts of a rest whose mean positions are compared.
const PARTS: usize = 20;
/// Ratio of the lengths of parts for which the greatest change is computed: a recording has many rests, each of its own length.
const RATIO: f64 = 1.1;

/// The channel of a recording that tells the motor side's motion.
pub fn motor_side(recording: &Recording) -> Option<&Channel> {
    ROLES.iter().find_map(|role| recording.channel(*role))
}

/// Gives a recording a `motor_position` if it has another channel of the motor side; returns the role that it is
/// made of.
///
/// # Errors
/// [`SignalError`] where the channel is no time series.
pub fn provide(recording: &mut Recording) -> Result<Option<Role>, SignalError> {
    let Some(channel) = motor_side(recording) else {
        return Ok(None);
    };
    let role = channel.role;
    if role != Role::MotorPosition {
        let made = position(channel)?;
        recording.channels.push(made);
    }
    Ok(Some(role))
}

/// Rests of the motor side, before its first motion and after each; none where it does not move, or nothing tells its motion.
///
/// # Errors
/// As [`provide`].
pub fn rests(recording: &Recording) -> Result<Vec<Phase>, SignalError> {
    let Some(channel) = motor_side(recording).filter(|channel| channel.varies()) else {
        return Ok(Vec::new());
    };
    let made = position(channel)?;
    let values = &made.columns[0];
    let rule = RestRule::from_values(values);
    let phases = phases(&made.time, values, rule)?.into_iter();
    let lasts = |rest: &Phase| rest.end - rest.start >= SHORTEST;
    let rests = phases.filter(|phase| phase.motion == Motion::Rest && lasts(phase));
    let mut most = BTreeMap::new();
    let still = rests.map(|rest| still(&made, rest, (rule, &mut most)));
    Ok(still.filter(lasts).collect())
}

/// The longest part of a rest in which the motor side does rest, as the means of its parts tell.
///
/// The rule compares two samples, and its limit is five deviations of their noise: a slow move, and the end of any, may be below
/// it, and shows in the velocity of the link. The noise of the means of `m` samples is `sqrt(m)` times smaller. The limits are
/// the rule's own: five deviations, and a share of the greatest speed.
///
/// `known` has the greatest change between neighbouring parts of the whole channel, by the logarithm of their length.
fn still(
    motor: &Channel,
    rest: Phase,
    (rule, known): (RestRule, &mut BTreeMap<i32, f64>),
) -> Phase {
    let step = (rest.end - rest.start) / PARTS as f64;
    let own = means(motor, [rest.start, rest.end], step);
    let moved = |pair: &[Mean]| (pair[1].value - pair[0].value).abs();
    let length = step.log(RATIO).floor() as i32;
    let most = *known.entry(length).or_insert_with(|| {
        let ends = [motor.time[0], motor.time[motor.time.len() - 1]];
        let all = means(motor, ends, RATIO.powi(length));
        all.windows(2).map(moved).fold(0.0, f64::max)
    });
    let rests = |pair: &[Mean]| {
        let noise = rule.noise * (1.0 / pair[0].samples + 1.0 / pair[1].samples).sqrt();
        moved(pair) <= (5.0 * noise + rule.quantisation).max(rule.drift * most)
    };
    let (mut from, mut longest) = (0, 0..0);
    for until in 1..=own.len() {
        if until - from > longest.len() {
            longest = from..until;
        }
        if until < own.len() && !rests(&own[until - 1..=until]) {
            from = until;
        }
    }
    let is_last = longest.end == own.len();
    Phase {
        start: rest.start + longest.start as f64 * step,
        end: if is_last {
            rest.end
        } else {
            rest.start + longest.end as f64 * step
        },
        ..rest
    }
}

/// The mean of some samples; no number without any.
struct Mean {
    value: f64,
    samples: f64,
}

/// Means of a channel over parts of so many seconds.
fn means(channel: &Channel, [from, until]: [f64; 2], step: f64) -> Vec<Mean> {
    let parts = ((until - from) / step).round().max(1.0) as usize;
    let place = |part: usize| {
        let time = from + part as f64 * step;
        channel.time.partition_point(|own| *own < time)
    };
    let mean = |part: usize| {
        let values = &channel.columns[0][place(part)..place(part + 1)];
        let samples = values.len() as f64;
        let value = values.iter().sum::<f64>() / samples;
        Mean { value, samples }
    };
    (0..parts).map(mean).collect()
}

/// A motor position of a channel: itself, or the integral of a velocity.
fn position(channel: &Channel) -> Result<Channel, SignalError> {
    match channel.role {
        Role::MotorVelocity => integrated_velocity(channel),
        _ => Ok(Channel {
            role: Role::MotorPosition,
            ..channel.clone()
        }),
    }
}
