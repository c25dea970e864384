//! What a file tells of itself above its table: properties with a key, of which one may be the step of its samples.

use super::super::layout::Layout;
use super::cells::{split, unmarked};
use super::name;
use super::units;

/// Words in keys of properties.
///
/// Source: what TwinCAT Scope (`SampleTime[ms]`, `ScaleFactor`, `BitMask`), LabVIEW (`Delta_X`, `X0`) and TDMS
/// (`wf_increment`, `wf_samples`) write above a table.
const KEYS: &[&str] = &[
    "sample",
    "samples",
    "sampling",
    "samplerate",
    "abtastzeit",
    "abtastrate",
    "wf",
    "delta",
    "increment",
    "offset",
    "scale",
    "scaling",
    "factor",
    "gain",
    "mask",
    "size",
    "length",
    "port",
    "version",
    "group",
    "points",
];

/// Keys of the time from sample to sample, in the unit that they name.
const STEPS: &[&str] = &[
    "sample time",
    "sampling time",
    "sample interval",
    "sampling interval",
    "sample period",
    "sampling period",
    "abtastzeit",
    "abtastintervall",
];

/// Keys of that time which are in seconds by the definition of their format: of TDMS and of LabVIEW's measurement files.
const SECONDS: &[&str] = &["wf increment", "delta x"];

/// Keys of the number of samples in a time.
const RATES: &[&str] = &[
    "sample rate",
    "sampling rate",
    "samplerate",
    "sample frequency",
    "sampling frequency",
    "abtastrate",
    "abtastfrequenz",
];

/// The step of the samples that a file tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The step, s.
    pub seconds: f64,
    /// Its key, as written.
    pub key: String,
}

/// Whether a line is a property, `SampleTime[ms] 2`: a key with one number, or with the same one for each column.
pub fn is_property(line: &str, delimiter: char) -> bool {
    let cells = split(unmarked(line), delimiter).into_iter();
    let said: Vec<&str> = cells.filter(|cell| !cell.is_empty()).collect();
    let Some(key) = said.first().filter(|key| number(key).is_none()) else {
        return false;
    };
    let is_known = name::parse(key)
        .words
        .iter()
        .any(|word| KEYS.contains(&word.as_str()));
    let mut values = said.iter().filter(|cell| *cell != key);
    let first = values.next();
    let is_number = first.is_some_and(|first| number(first).is_some());
    is_known && is_number && values.all(|value| Some(&value) == first.as_ref())
}

/// The step that the lines above a table tell, if they tell one: beside its key, or below it.
pub fn step(above: &[&str], delimiter: char) -> Option<Step> {
    let rows: Vec<Vec<&str>> = above.iter().map(|line| cells(line, delimiter)).collect();
    let mut found: Option<Step> = None;
    for (line, row) in rows.iter().enumerate() {
        for (place, key) in row.iter().enumerate() {
            let below = rows[line + 1..].iter().find(|row| !row.is_empty());
            let beside = row.get(place + 1).into_iter();
            let values = beside.chain(below.and_then(|row| row.get(place)));
            let Some(seconds) = values.into_iter().find_map(|value| seconds(key, value)) else {
                continue;
            };
            match &found {
                // Channels of several rates.
                Some(other) if (other.seconds / seconds - 1.0).abs() > 1e-9 => return None,
                Some(_) => {}
                None => {
                    found = Some(Step {
                        seconds,
                        key: (*key).to_owned(),
                    })
                }
            }
        }
    }
    found
}

/// The cells of a line; key and value of `key: value` and `key = value`.
fn cells(line: &str, delimiter: char) -> Vec<&str> {
    let line = unmarked(line).trim();
    let mut cells = split(line, delimiter);
    // A table of one column has a separator above it alone.
    if cells.len() < 2 {
        cells = split(line, Layout::default().delimiter_of(line));
    }
    let pair = line
        .split_once(['=', ':'])
        .filter(|_| cells.len() < 2 || delimiter == ' ');
    match pair {
        _ if line.is_empty() => Vec::new(),
        Some((key, value)) => vec![key.trim(), value.trim()],
        None => cells,
    }
}

/// The step of a key and its value, s.
fn seconds(key: &str, value: &str) -> Option<f64> {
    let name = name::parse(key);
    let said = name.words.join(" ");
    let is = |keys: &[&str]| keys.contains(&said.as_str());
    let mut parts = value.splitn(2, char::is_whitespace);
    let value = number(parts.next()?)?;
    let unit = parts.next().map(str::trim).or(name.unit.as_deref());
    let seconds = match (is(STEPS), is(SECONDS), is(RATES)) {
        (true, ..) => value * units::time_unit(unit?)?.in_seconds(),
        (_, true, _) => value,
        (_, _, true) => (value * hertz(unit?)?).recip(),
        _ => return None,
    };
    (seconds.is_finite() && seconds > 0.0).then_some(seconds)
}

/// A unit of frequency in Hz.
fn hertz(unit: &str) -> Option<f64> {
    match unit.to_lowercase().as_str() {
        "hz" | "s/s" | "1/s" => Some(1.0),
        "khz" => Some(1e3),
        _ => None,
    }
}

fn number(text: &str) -> Option<f64> {
    text.replace(',', ".")
        .parse()
        .ok()
        .filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_stands_beside_its_key_or_below_it() {
        for (lines, delimiter, seconds) in [
            (&["Name\tScope", "SampleTime[ms]\t2"][..], '\t', Some(2e-3)),
            (&["wf_increment,0.0005,0.0005"], ',', Some(5e-4)),
            (
                &["Channel,Unit,wf_increment", "a,g,0.0005"],
                ',',
                Some(5e-4),
            ),
            (&["# wf_increment: 0.002"], ',', Some(2e-3)),
            (&["Channel,wf_increment", "a,0.0005"], ';', Some(5e-4)),
            (&["Sample Interval,4e-05,s"], ',', None),
            (&["Abtastzeit [us];2000"], ';', Some(2e-3)),
            (&["Sampling rate = 2 kHz"], ',', Some(5e-4)),
            (&["Sample rate [Hz];250,5"], ';', Some(1.0 / 250.5)),
            (&["SampleTime[ms];2;SampleTime[ms];4"], ';', None),
            (&["SampleTime[ms];0"], ';', None),
        ] {
            let told = step(lines, delimiter).map(|step| step.seconds);
            let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
            assert!(told.is_some() == seconds.is_some(), "{lines:?}: {told:?}");
            assert!(
                told.zip(seconds).is_none_or(|(a, b)| same(a, b)),
                "{lines:?}: {told:?}"
            );
        }
    }

    #[test]
    fn a_property_has_one_value() {
        for (line, is_one) in [
            ("SampleTime[ms]\t2", true),
            ("SampleTime[ms]\t2\tSampleTime[ms]\t2", true),
            ("wf_increment\t0.002\t0.002\t", true),
            ("Sample\tTime", false),
            ("Sample\t1\t2", false),
            ("ERR\t0.1\t0.1", false),
            ("0.002\t0.1\t0.1", false),
        ] {
            assert_eq!(is_property(line, '\t'), is_one, "{line}");
        }
    }
}
