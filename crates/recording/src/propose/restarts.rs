//! Tests in a file whose time begins again, where no column separates them; and stamps that repeat.

use super::clock::{self, Clock};
use super::content::Content;
use std::ops::Range;

/// Most parts of a file.
const MOST: usize = 1000;

/// The rows of each part of a file in which the time begins again; none where it does not. A part begins no later than the
/// file did, and within it the time grows: a stamp that is late by some samples begins none.
pub fn parts(content: &Content, clock: &Clock) -> Vec<Range<usize>> {
    let Clock::Stamps { column, unit, .. } = clock else {
        return Vec::new();
    };
    let stamps = &content.columns[*column];
    let rows = stamps.numbers.len();
    if unit.value.is_text() || stamps.texts > 0 || stamps.grows(0..rows) {
        return Vec::new();
    }
    let first = stamps.numbers[0];
    let begins = (1..rows).filter(|&row| stamps.numbers[row] <= stamps.numbers[row - 1]);
    let begins: Vec<usize> = std::iter::once(0).chain(begins.take(MOST)).collect();
    let ends = begins.iter().copied().skip(1).chain([rows]);
    let parts: Vec<_> = begins
        .iter()
        .zip(ends)
        .map(|(from, to)| *from..to)
        .collect();
    let is_test = |rows: &Range<usize>| {
        stamps.numbers[rows.start] <= first && rows.len() > 1 && stamps.grows(rows.clone())
    };
    match parts.len() <= MOST && parts.iter().all(is_test) {
        true => parts,
        false => Vec::new(),
    }
}

/// A sentence, without a full stop, on the first stamp that runs backwards or repeats, and what to do.
pub fn told(content: &Content, clock: &Clock) -> Option<String> {
    let [before, now] = clock::runs_back(content, clock)?;
    if now < before {
        return Some(format!("its time runs backwards: {now} after {before}"));
    }
    let Clock::Stamps { column, unit, .. } = clock else {
        return None;
    };
    let repeats = format!("its time repeats: {now} stands twice");
    let stamps = &content.columns[*column].numbers;
    let pairs = || (1..stamps.len()).filter(|row| stamps[*row] == stamps[row - 1]);
    let is_copy = |row: usize| {
        let same = |column: &super::column::Column| {
            let [a, b] = [column.numbers[row - 1], column.numbers[row]];
            a == b || a.is_nan() && b.is_nan()
        };
        content.columns.iter().all(same)
    };
    let (copies, others) = pairs().fold((0, 0), |(copies, others), row| match is_copy(row) {
        true => (copies + 1, others),
        false => (copies, others + 1),
    });
    let grows = stamps.windows(2).all(|pair| pair[1] >= pair[0]);
    let span = (stamps.last()? - stamps.first()?) * unit.value.in_seconds();
    let rate = (stamps.len() - 1) as f64 / span;
    // Either the logger wrote a line twice, or it rounds its stamps.
    Some(match (copies > others, grows && rate.is_finite()) {
        (true, _) if copies == 1 => format!("{repeats}; 1 line repeats the line above: remove it"),
        (true, _) => format!("{repeats}; {copies} lines repeat the line above: remove them"),
        (false, true) => format!(
            "{repeats}; if the stamps are rounded and the samples are evenly spaced, write rate_hz in the place of time: there \
             are about {rate:.0} samples a second"
        ),
        (false, false) => repeats,
    })
}
