//! Recordings that are longer than a diagnosis needs, reduced to evenly spread stretches.

use quell_recording::{Channel, Recording};
use std::borrow::Cow;

/// Samples of a channel that are used. A model error of `a` standard deviations of the noise lowers the
/// criterion by `N a^2 / 2`, and 10 of it are enough for an effect: `N` = 1e5 samples show `a` = 0.014. A
/// mismatch is reported from 1.1 times the noise on, that is from `a` = 0.46, a thousand times as much in
/// energy.
const ENOUGH: usize = 100_000;
/// Number of stretches; slow changes show in the differences between them.
const STRETCHES: usize = 10;
/// Share of a stretch's samples that a channel must have, so that the stretch counts.
const PRESENT: f64 = 0.5;

/// Recordings of limited length.
pub struct Stretches<'a> {
    /// Stretches, or whole recordings.
    pub recordings: Cow<'a, [Recording]>,
    /// Index of the original recording of each.
    pub of: Vec<usize>,
    /// Remarks on the reduction.
    pub remarks: Vec<String>,
}

/// The recordings, long ones as [`STRETCHES`] recordings each.
pub fn stretches(recordings: &[Recording]) -> Stretches<'_> {
    if recordings.iter().all(|own| longest(own).is_none()) {
        return Stretches {
            recordings: Cow::Borrowed(recordings),
            of: (0..recordings.len()).collect(),
            remarks: Vec::new(),
        };
    }
    let (mut all, mut of, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
    for (index, recording) in recordings.iter().enumerate() {
        let parts = longest(recording).map(|channel| cut(recording, channel));
        match parts.filter(|parts| !parts.is_empty()) {
            Some(parts) => {
                remarks.push(told(recording, &parts));
                all.extend(parts);
            }
            None => all.push(recording.clone()),
        }
        of.resize(all.len(), index);
    }
    Stretches {
        recordings: Cow::Owned(all),
        of,
        remarks,
    }
}

/// Whether all samples of a recording are used.
pub fn is_whole(recording: &Recording) -> bool {
    longest(recording).is_none()
}

/// The channel with the most samples, if these are more than needed.
fn longest(recording: &Recording) -> Option<&Channel> {
    let channels = recording.channels.iter();
    let most = channels.max_by_key(|channel| channel.time.len());
    most.filter(|channel| channel.time.len() > ENOUGH)
}

fn cut(recording: &Recording, longest: &Channel) -> Vec<Recording> {
    let share = ENOUGH as f64 / longest.time.len() as f64 / STRETCHES as f64;
    let (first, last) = (longest.time[0], longest.time[longest.time.len() - 1]);
    let length = share * (last - first);
    let apart = (last - first - length) / (STRETCHES - 1) as f64;
    let parts = (0..STRETCHES).map(|number| {
        let from = first + number as f64 * apart;
        let mut part = recording.within([from, from + length]);
        part.name = format!("{}, from {from:.0} s", part.name);
        part
    });
    let expected = |whole: &Channel| PRESENT * share * whole.time.len() as f64;
    let is_whole = |part: &Recording| {
        let mut pairs = part.channels.iter().zip(&recording.channels);
        pairs.all(|(part, whole)| part.time.len() as f64 >= expected(whole))
    };
    parts.filter(is_whole).collect()
}

fn told(recording: &Recording, parts: &[Recording]) -> String {
    let samples = |recording: &Recording| recording.channels.iter().map(|c| c.time.len()).sum();
    let (whole, used): (usize, usize) = (samples(recording), parts.iter().map(samples).sum());
    format!(
        "Of the {whole} samples of \"{}\" {used} were used, in {} stretches spread over it, each with a start of its \
         own: they show an error of 2 % of the noise, and one of 46 % is the least that is told. What happens in \
         between only was not seen; rows in the manifest make a recording of any part.",
        recording.name,
        parts.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_recording::Role;

    fn recording(samples: usize) -> Recording {
        let time: Vec<f64> = (0..samples).map(|k| k as f64 * 0.004).collect();
        let channel = |role| Channel {
            role,
            unit: "rad".into(),
            columns: vec![time.clone()],
            time: time.clone(),
        };
        let channels = [Role::MotorPosition, Role::Deformation].map(channel);
        Recording {
            name: "long".into(),
            payload: None,
            channels: channels.to_vec(),
        }
    }

    #[test]
    fn what_is_short_is_left_alone_and_what_is_long_is_seen_from_end_to_end() {
        let short = [recording(ENOUGH)];
        let all = stretches(&short);
        assert!(all.of == [0] && all.remarks.is_empty());
        let long = [recording(5 * ENOUGH), recording(ENOUGH)];
        let Stretches {
            recordings: mut parts,
            of,
            remarks,
        } = stretches(&long);
        assert_eq!(of, [[0; STRETCHES].as_slice(), &[1]].concat());
        assert_eq!(remarks.len(), 1);
        parts.to_mut().pop();
        let samples: usize = parts.iter().map(|part| part.channels[0].time.len()).sum();
        assert!(samples.abs_diff(ENOUGH) <= STRETCHES, "{samples}");
        let [first, last] = [&parts[0], &parts[STRETCHES - 1]].map(|part| &part.channels[1].time);
        let end = long[0].channels[1].time[5 * ENOUGH - 1];
        assert!(first[0] == 0.0 && end - last[last.len() - 1] < 0.01);
        assert!(remarks[0].contains("1000000 samples"), "{}", remarks[0]);
    }
}
