//! Stretches in which the sensor of a joint shows one value while the joint moves.

use super::two_sides::{Series, unwrapped};
use core::ops::Range;
use quell_recording::health::{Flat, FlatKind, flats, quantum, shows_noise};
use quell_recording::{Channel, Recording, Role, plain, range};

/// A sensor of a joint that hangs, or is at its limit, while the joint moves.
///
/// A run of one value that is too long for chance and does not begin and end gently ([`flats`]) is no fault alone: a motor
/// side may stop hard, and an impact ends a rest. It is one
///
/// - of two positions, where their distance lies, on average over the run, further from its mean outside of such runs than half
///   of its range there: the other side has gone on, while a vibration about the stop has no mean,
/// - of a deformation, where the run begins in full motion: a vibration dies out,
/// - of any of them, where the sensor shows noise outside of such runs ([`shows_noise`]): neither a rest, nor a stop, nor the
///   top of a vibration is without noise. So a sensor is found that hangs from the first sample on, and one whose range ends
///   below the tops of a vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Hangs {
    /// The runs, in the order of time, not empty.
    pub runs: Vec<Hang>,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct Hang {
    /// Which sensor.
    pub role: Role,
    /// First and last stamp, s.
    pub span: [f64; 2],
    /// The value, in the channel's unit.
    pub value: f64,
    /// The channel's unit.
    pub unit: String,
    /// Whether it is the least or greatest value, so that the sensor's range has ended.
    pub is_limit: bool,
    /// Whether the sensor shows noise outside of such runs, so that no physics explains the run.
    pub lacks_noise: bool,
}

impl Hangs {
    /// The runs in the motor side and the link of a recording; `None` without one.
    pub fn of(recording: &Recording) -> Option<Self> {
        let roles = [Role::MotorPosition, Role::LinkPosition, Role::Deformation];
        let channels = roles.map(|role| recording.channel(role));
        let found = channels.map(|own| own.map_or_else(Vec::new, candidates));
        let hangs = |own: &[(Hang, bool)]| -> Vec<Hang> {
            own.iter().map(|(run, _)| run.clone()).collect()
        };
        let [motor, link, _] = channels;
        let pair = motor
            .zip(link)
            .filter(|(motor, link)| motor.unit == link.unit);
        let of_two = || hangs(&found[..2].concat());
        let mut runs = pair.map_or_else(Vec::new, |(motor, link)| apart(motor, link, of_two()));
        let begins = found[2].iter().filter(|(_, begins)| *begins);
        runs.extend(begins.map(|(run, _)| run.clone()));
        let mut silent = hangs(&found.concat());
        silent.retain(|run| run.lacks_noise);
        runs.retain(|run| !silent.contains(run));
        runs.extend(silent);
        runs.sort_by(|a, b| a.span[0].total_cmp(&b.span[0]));
        (!runs.is_empty()).then_some(Self { runs })
    }

    /// The longest span of the recording without such a run, from its first instant to before its second one, s.
    pub fn intact(&self, recording: &Recording) -> [f64; 2] {
        let stamps = || recording.channels.iter().flat_map(|channel| &channel.time);
        let first = stamps().copied().fold(f64::INFINITY, f64::min);
        let last = stamps().copied().fold(f64::NEG_INFINITY, f64::max);
        let end = last.next_up();
        let runs = self.runs.iter().map(|run| run.span);
        let (mut from, mut best) = (first, [first, first]);
        for [start, until] in runs.chain([[end, end]]) {
            if start - from > best[1] - best[0] {
                best = [from, start];
            }
            from = from.max(until.next_up());
        }
        best
    }

    /// What hangs and when, in a clause without a full stop.
    pub fn words(&self) -> String {
        let first = &self.runs[0];
        let what = match first.is_limit {
            true => "is at the end of its sensor's range",
            false => "hangs at one value",
        };
        let more = match self.runs.len() - 1 {
            0 => String::new(),
            1 => ", and once more".into(),
            more => format!(", and {more} times more"),
        };
        let value = plain((first.value * 1e6).round() / 1e6);
        format!(
            "{} {what}, {value} {}, from {} to {} s while the joint moves{more}",
            first.role,
            first.unit,
            plain(first.span[0]),
            plain(first.span[1])
        )
    }

    /// The same as a reason to refuse the recording, with what to do.
    pub fn contradiction(&self) -> String {
        format!(
            "{}: that is no motion; leave out these rows, or record again",
            self.words()
        )
    }
}

/// The runs of a channel that do not begin and end gently, each with whether it begins in motion.
fn candidates(channel: &Channel) -> Vec<(Hang, bool)> {
    let Some(column) = channel.columns.first() else {
        return Vec::new();
    };
    let step = quantum(column);
    let runs = flats(&channel.time, column, step.unwrap_or(0.0));
    // Without a step there are no numbers of a sensor: a simulation without noise may hold a value exactly.
    let lacks_noise = step.is_some_and(|step| shows_noise(&outside(channel, &runs), step));
    let found = runs.into_iter().filter(|flat| flat.kind != FlatKind::Rest);
    let hang = |flat: Flat| Hang {
        role: channel.role,
        span: [flat.from, flat.until],
        value: flat.value,
        unit: channel.unit.clone(),
        is_limit: flat.kind == FlatKind::Saturated,
        lacks_noise,
    };
    found
        .map(|flat| (hang(flat), flat.begins_in_motion))
        .collect()
}

/// The values of the first column outside of runs.
fn outside(channel: &Channel, runs: &[Flat]) -> Vec<f64> {
    let pairs = channel.time.iter().zip(&channel.columns[0]);
    let is_outside = |time: f64| {
        let own = runs.partition_point(|run| run.until < time);
        runs.get(own).is_none_or(|run| time < run.from)
    };
    let kept = pairs.filter(|(time, _)| is_outside(**time));
    kept.map(|(_, value)| *value).collect()
}

/// Those of the runs of two positions in which the other one goes on.
fn apart(motor: &Channel, link: &Channel, all: Vec<Hang>) -> Vec<Hang> {
    let series = match all.is_empty() {
        true => None,
        false => Series::of(&unwrapped(motor), &unwrapped(link)),
    };
    let Some(series) = series else {
        return Vec::new();
    };
    let between: Vec<f64> = series
        .link
        .iter()
        .zip(&series.motor)
        .map(|(y, u)| y - u)
        .collect();
    let within = |hang: &Hang| -> Range<usize> {
        let from = series.time.partition_point(|t| *t < hang.span[0]);
        from..series.time.partition_point(|t| *t <= hang.span[1])
    };
    let inside: Vec<Range<usize>> = all.iter().map(within).collect();
    let is_outside = |k: &usize| inside.iter().all(|run| !run.contains(k));
    let outside: Vec<f64> = (0..between.len())
        .filter(is_outside)
        .map(|k| between[k])
        .collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let goes_on = |run: &Range<usize>| {
        let away = (mean(&between[run.clone()]) - mean(&outside)).abs();
        away > 0.5 * range(&outside)
    };
    let pairs = all.into_iter().zip(&inside);
    pairs
        .filter(|(_, run)| goes_on(run))
        .map(|(hang, _)| hang)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 500.0;

    /// A motor side that moves twice, and a link of 8 Hz behind it; each through a fault of its sensor.
    fn recording(motor: impl Fn(f64, f64) -> f64, link: impl Fn(f64, f64) -> f64) -> Recording {
        let w = core::f64::consts::TAU * 8.0;
        let gone = |t: f64, at: f64| {
            let s = ((t - at) / 0.3).clamp(0.0, 1.0);
            s * s * (3.0 - 2.0 * s)
        };
        let rings = |t: f64, at: f64| {
            let after = (t - at).max(0.0);
            (-0.05 * w * after).exp() * (w * after).sin()
        };
        // Noise of a sensor, by an irrational rotation.
        let noise = |t: f64| 1e-6 * ((t * RATE * 0.618).fract() - 0.5);
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) / RATE).collect();
        let moved = |t: f64| 0.5 * gone(t, 0.5) - 0.7 * gone(t, 2.0);
        let channel = |role, values: Vec<f64>| Channel {
            role,
            unit: "rad".into(),
            time: time.clone(),
            columns: vec![values],
        };
        let ringing = |t: f64| moved(t) + 0.01 * (rings(t, 0.8) - rings(t, 2.3));
        let motor = time.iter().map(|t| motor(*t, moved(*t) + noise(*t)));
        let link = time.iter().map(|t| link(*t, ringing(*t) + noise(*t + 7.0)));
        Recording {
            name: "run".into(),
            payload: None,
            channels: vec![
                channel(Role::MotorPosition, motor.collect()),
                channel(Role::LinkPosition, link.collect()),
            ],
        }
    }

    #[test]
    fn a_sensor_that_hangs_is_told_with_its_span_and_left_out() {
        let good = |_, x| x;
        assert_eq!(Hangs::of(&recording(good, good)), None);
        let frozen = |t, x| if t < 2.1 { x } else { 0.3125 };
        for (own, role) in [
            (recording(frozen, good), Role::MotorPosition),
            (recording(good, frozen), Role::LinkPosition),
        ] {
            let hangs = Hangs::of(&own).unwrap();
            let run = &hangs.runs[..];
            assert_eq!(
                (run[0].role, run[0].span, run.len()),
                (role, [2.1, 3.998], 1)
            );
            assert_eq!(hangs.intact(&own), [0.0, 2.1]);
        }
        let clipped = |_, x: f64| x.min(0.4);
        let own = recording(good, clipped);
        let hangs = Hangs::of(&own).unwrap();
        assert!(hangs.runs[0].is_limit && hangs.words().starts_with("link_position is at the end"));
        let [from, _] = hangs.intact(&own);
        assert!(from > 2.0, "{from}");
    }

    /// A value as a sensor of 7 digits shows it.
    fn shown(x: f64) -> f64 {
        (x * 1e7).round() / 1e7
    }

    /// Neither fault moves the mean of the distance far: what shows them is that the noise is gone.
    #[test]
    fn a_sensor_without_its_noise_is_told() {
        let noisy = |t: f64, x: f64| {
            let pair = [0.618, 0.414].map(|k| (t * RATE * k).fract() + (t * t * RATE * k).fract());
            shown(x + 3e-6 * (pair[0] + pair[1] - 2.0))
        };
        let good = |t: f64, x: f64| noisy(t, x);
        assert_eq!(Hangs::of(&recording(good, good)), None);
        // The link's tops beyond 0.503 rad are cut off.
        let cut = |t: f64, x: f64| noisy(t, x).min(0.503);
        let hangs = Hangs::of(&recording(good, cut)).unwrap();
        assert!(
            hangs.runs.len() > 3 && hangs.runs.iter().all(|run| run.is_limit && run.lacks_noise)
        );
        // A sensor that shows its first value until 0.62 s, where the joint is on its way.
        let late = |t: f64, x: f64| if t < 0.62 { shown(0.0) } else { noisy(t, x) };
        let own = recording(good, late);
        let hangs = Hangs::of(&own).unwrap();
        assert_eq!((hangs.runs.len(), hangs.runs[0].span), (1, [0.0, 0.618]));
        // An encoder whose step hides the noise rests at one value, and a blow may end the rest.
        let coarse = |t: f64, x: f64| {
            if t < 0.62 {
                0.0
            } else {
                (x * 1e4).round() / 1e4
            }
        };
        let hangs = Hangs::of(&recording(good, coarse));
        assert!(hangs.is_none_or(|hangs| hangs.runs.iter().all(|run| !run.lacks_noise)));
    }

    /// A motor side that is stopped hard rests at one value, and the link rings about it.
    #[test]
    fn a_hard_stop_is_none() {
        let stops = |t: f64| if t < 1.0 { 0.4 * t } else { 0.4 };
        let w = core::f64::consts::TAU * 8.0;
        let rings = |t: f64| {
            let after = (t - 1.0).max(0.0);
            stops(t) + 0.4 / w * (-0.05 * w * after).exp() * (w * after).sin()
        };
        let own = recording(|t, _| stops(t), |t, _| rings(t));
        assert_eq!(Hangs::of(&own), None);
    }
}
