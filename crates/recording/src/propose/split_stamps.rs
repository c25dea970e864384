//! Stamps in two columns, seconds since an epoch and the nanoseconds beside them, as `ros2 topic echo --csv` writes them.

use super::super::dates::GIGA;
use super::super::stamp::is_since_1970;
use super::column::Column;
use super::content::Content;
use crate::are_even;

/// Such stamps.
pub struct SplitStamps {
    /// The column of the seconds; that of the nanoseconds is the next one.
    pub seconds: usize,
    /// Mean number of samples a second.
    pub rate_hz: f64,
    /// Whether the stamps are even.
    pub even: bool,
}

/// The first two neighbouring columns that are such stamps.
pub fn of(content: &Content) -> Option<SplitStamps> {
    let pairs = content.columns.windows(2).enumerate();
    let mut found = pairs.filter_map(|(seconds, pair)| told(seconds, &pair[0], &pair[1]));
    found.next()
}

fn told(seconds: usize, whole: &Column, part: &Column) -> Option<SplitStamps> {
    let is_whole = |own: &f64| own.fract() == 0.0;
    let is_epoch = |own: &f64| is_whole(own) && is_since_1970(*own);
    let is_part = |own: &f64| is_whole(own) && (0.0..GIGA as f64).contains(own);
    let rows = whole.numbers.len();
    let fits = whole.numbers.iter().all(is_epoch) && part.numbers.iter().all(is_part);
    if !fits || rows < 3 || part.grows(0..rows) {
        return None;
    }
    let first = whole.numbers[0];
    let pairs = whole.numbers.iter().zip(&part.numbers);
    let stamps: Vec<f64> = pairs.map(|(s, ns)| s - first + ns / GIGA as f64).collect();
    if !stamps.windows(2).all(|pair| pair[1] > pair[0]) {
        return None;
    }
    let period = (stamps[rows - 1] - stamps[0]) / (rows - 1) as f64;
    Some(SplitStamps {
        seconds,
        rate_hz: period.recip(),
        even: are_even(stamps.iter().copied(), [stamps[0], period]),
    })
}

impl SplitStamps {
    /// A clause on where they stand.
    pub fn words(&self, content: &Content) -> String {
        let [whole, part] = [self.seconds, self.seconds + 1].map(|k| &content.columns[k].title);
        format!(
            "seconds stand in {whole:?} and nanoseconds in {part:?}, and this is their mean rate"
        )
    }

    /// A sentence, without a full stop, where they are not even.
    pub fn open(&self, content: &Content) -> Option<String> {
        (!self.even).then(|| {
            format!(
                "the rate: {}, but they are not even: write a column with both, as 1714554842.300, and call it time",
                self.words(content)
            )
        })
    }
}
