//! The column of the time, with its unit; and the column that separates tests.

use super::super::stamp::{TIME_UNITS, TimeUnit, is_since_1970};
use super::Guess;
use super::column::Column;
use super::content::Content;
use super::preamble::Step;
use super::split_stamps::{self, SplitStamps};
use super::units;

/// Rate, Hz, below which stamps are not assumed to be seconds: for a robot's slowest vibration of a few hertz
/// there are less than two samples a period.
const SLOWEST: f64 = 5.0;

/// Serial dates of the years 2000 to 2099, in days since 1899-12-30. In seconds these would be stamps of 10 to 20 h of
/// running, and what has [`SLOWEST`] in days would have 86 400 times as many samples a second, 432 kHz: the clock of no robot.
const SERIAL: std::ops::Range<f64> = 36_526.0..73_051.0;

/// Units of stamps that are numbers.
const NUMBERS: [TimeUnit; 4] = [
    TimeUnit::Seconds,
    TimeUnit::Milliseconds,
    TimeUnit::Microseconds,
    TimeUnit::Nanoseconds,
];

/// The clock of a file.
pub enum Clock {
    /// A column with stamps; if their unit is uncertain, with the reason why that matters.
    Stamps {
        column: usize,
        unit: Guess<TimeUnit>,
        open: Option<String>,
    },
    /// A rate, Hz, that the last line of the file says.
    Rate(f64),
    /// A step of the samples that a line above the table tells.
    Told(Step),
    /// A rate in the place of stamps in two columns.
    Split(SplitStamps),
    /// A column that counts the samples, and no time.
    Counted(usize),
    /// The file has no time.
    None,
}

impl Clock {
    /// Whether a column belongs to the clock.
    pub fn has(&self, index: usize) -> bool {
        match self {
            Self::Stamps { column, .. } | Self::Counted(column) => *column == index,
            Self::Split(split) => [split.seconds, split.seconds + 1].contains(&index),
            _ => false,
        }
    }
}

/// The clock of a file.
pub fn of(content: &Content) -> Clock {
    if let Some(rate) = content.told_rate_hz {
        return Clock::Rate(rate);
    }
    let columns = &content.columns;
    let in_time = |column: &Column| {
        let unit = column.name.unit.as_deref().and_then(units::time_unit);
        let is_one = unit.is_some() || column.durations.is_some();
        is_one && column.is_numeric() && column.grows(0..column.numbers.len())
    };
    let named = columns
        .iter()
        .position(|column| column.name.is_time() && is_clock(column))
        .or_else(|| columns.iter().position(in_time));
    let dated = || columns.iter().position(|column| date(column).is_some());
    let unnamed = || {
        // What an instrument tells of itself may stand beside the table.
        let is_full =
            |column: &Column| column.is_numeric() && !column.numbers.iter().any(|own| own.is_nan());
        let place = columns.iter().position(is_full)?;
        let first = &columns[place];
        let is_other = first.name.is_count() || first.name.role().is_some();
        let grows = first.grows(0..first.numbers.len());
        (columns.len() > 1 && grows && !is_other).then_some(place)
    };
    if let Some(column) = named.or_else(dated) {
        let (unit, open) = match content.is_klipper() {
            true => (Guess::known(TimeUnit::Seconds), None),
            false => unit_of(content, &columns[column]),
        };
        return Clock::Stamps { column, unit, open };
    }
    if let Some(split) = split_stamps::of(content) {
        return Clock::Split(split);
    }
    match unnamed() {
        Some(column) if by_step(content, &columns[column]).is_some() => {
            let (unit, open) = unit_of(content, &columns[column]);
            Clock::Stamps { column, unit, open }
        }
        _ if content.told_step.is_some() => told(content),
        None => Clock::None,
        Some(column) if counts(&columns[column]) => Clock::Counted(column),
        Some(column) => {
            let (unit, open) = unit(&columns[column]);
            let grows = match column {
                0 => "the first column, whose values grow, has the time".to_owned(),
                other => format!("column {}, whose values grow, has the time", other + 1),
            };
            let open = Some(open.map_or(grows.clone(), |open| format!("{grows}; {open}")));
            let unit = Guess::guessed(unit.value, grows);
            Clock::Stamps { column, unit, open }
        }
    }
}

/// The clock by the step that the file tells.
fn told(content: &Content) -> Clock {
    content.told_step.clone().map_or(Clock::None, Clock::Told)
}

/// The unit in which the stamps of a column go by the step that the file tells, to the last digit of a rounded stamp.
fn by_step(content: &Content, column: &Column) -> Option<TimeUnit> {
    let told = content.told_step.as_ref()?.seconds;
    let same = |unit: &TimeUnit| (step(column) * unit.in_seconds() / told - 1.0).abs() < 1e-3;
    NUMBERS.into_iter().find(same)
}

/// The unit of a column of stamps, which the step that the file tells makes certain.
fn unit_of(content: &Content, column: &Column) -> (Guess<TimeUnit>, Option<String>) {
    let (guess, open) = unit(column);
    match by_step(content, column).filter(|_| guess.why.is_some()) {
        Some(unit) => (Guess::known(unit), None),
        None => (guess, open),
    }
}

/// Whether a column counts its rows, from 0 or 1.
fn counts(column: &Column) -> bool {
    let first = column.numbers[0];
    let places = column.numbers.iter().enumerate();
    [0.0, 1.0].contains(&first) && places.into_iter().all(|(k, own)| *own == first + k as f64)
}

/// A sentence, without a full stop, on a column that counts the samples.
pub fn counted(column: &Column) -> String {
    format!(
        "how many samples a second it has: {:?} goes by 1 from row to row, so that it counts them: write rate_hz = a number, or \
         time_unit = \"ms\" beside time = {:?} where these are ms",
        column.called, column.called
    )
}

fn is_clock(column: &Column) -> bool {
    column.has_numbers() || date(column).is_some()
}

/// The unit of a column whose first cell is a date, a time of day or a duration `T#4ms`: that in which most of its cells are one, since
/// `01/05` may begin with the day or with the month.
fn date(column: &Column) -> Option<TimeUnit> {
    let is_one = |unit: TimeUnit, cell: &str| unit.seconds(cell, &mut Some(0)).is_some();
    let first = column.first.as_str();
    let units = TIME_UNITS.iter().map(|line| line.0);
    let is_marked = first.contains([':', '#']);
    let able = units.filter(|unit| unit.is_text() && is_marked && is_one(*unit, first));
    let read = |unit: &TimeUnit| {
        let cells = column.distinct.iter();
        cells.filter(|cell| is_one(*unit, cell)).count()
    };
    // The first of equals is taken.
    able.rev().max_by_key(read)
}

/// The unit of a column of stamps, and its uncertainty.
fn unit(column: &Column) -> (Guess<TimeUnit>, Option<String>) {
    if let Some(unit) = date(column).filter(|_| column.texts > 0) {
        return (Guess::known(unit), None);
    }
    let words = column
        .name
        .words
        .iter()
        .find_map(|word| units::time_unit(word).filter(|_| word.len() > 1));
    let told = column.name.unit.as_deref().and_then(units::time_unit);
    let told = told.or(column.durations);
    let first = column
        .numbers
        .iter()
        .copied()
        .find(|stamp| stamp.is_finite())
        .unwrap_or(0.0);
    let since_1970 = |unit: &TimeUnit| {
        let seconds = first * unit.in_seconds();
        is_since_1970(seconds)
    };
    if let Some(unit) = told.or(words) {
        return (Guess::known(unit), None);
    }
    // A counter that begins again has no date.
    if let Some(unit) = NUMBERS.into_iter().find(since_1970)
        && column.wrap.is_none()
    {
        return (Guess::known(unit), None);
    }
    let step = step(column);
    let rate = |unit: &TimeUnit| 1.0 / (step * unit.in_seconds());
    if SERIAL.contains(&first) && rate(&TimeUnit::Days) >= SLOWEST {
        let why = format!(
            "serial dates of a spreadsheet, in days: that is {:.4} samples a second",
            rate(&TimeUnit::Days)
        );
        return (Guess::guessed(TimeUnit::Days, why), None);
    }
    let fits = |unit: &TimeUnit| rate(unit) >= SLOWEST;
    match NUMBERS.into_iter().find(fits) {
        Some(TimeUnit::Seconds) => {
            let why = format!("that is {:.4} samples a second", rate(&TimeUnit::Seconds));
            (Guess::guessed(TimeUnit::Seconds, why), None)
        }
        Some(unit) => {
            let why = format!(
                "in seconds it were one sample in {step} s, in {} it is {:.4} Hz",
                unit.name(),
                rate(&unit)
            );
            let open = format!("the unit of column {:?}: {why}", column.title);
            (Guess::guessed(unit, why), Some(open))
        }
        None => {
            let open = format!("the unit of column {:?}", column.title);
            (
                Guess::guessed(TimeUnit::Seconds, "nothing says it"),
                Some(open),
            )
        }
    }
}

/// The median step of the stamps that grow.
fn step(column: &Column) -> f64 {
    let pairs = column.numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = pairs.filter(|step| *step > 0.0).collect();
    let middle = steps.len() / 2;
    match steps.is_empty() {
        true => 1.0,
        false => *steps.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// The column that separates tests, if the time of a file restarts: within each of its values time grows. It is no
/// signal: a position that only grows stands in blocks, too.
pub fn tests(content: &Content, clock: &Clock, is_signal: impl Fn(usize) -> bool) -> Option<usize> {
    let Clock::Stamps {
        column: time, unit, ..
    } = clock
    else {
        return None;
    };
    let stamps = &content.columns[*time];
    let rows = stamps.numbers.len();
    if unit.value.is_text() || stamps.grows(0..rows) {
        let payload = |column: &Column| column.name.is_payload() && column.is_of_blocks();
        return content.columns.iter().position(payload);
    }
    // The starts of the stretches of growing time.
    let falls = |row: &usize| stamps.numbers[*row] <= stamps.numbers[*row - 1];
    let begins = (1..rows).filter(falls).count() + 1;
    let parts = |column: &Column| column.is_of_blocks() && column.distinct.len() >= begins;
    let tells = (0..content.columns.len())
        .filter(|&index| index != *time && parts(&content.columns[index]) && !is_signal(index));
    // A repeated sample splits a signal into many parts; the column with the fewest values is that of the
    // tests.
    tells.min_by_key(|&index| content.columns[index].distinct.len())
}

/// The first stamp of a file at which its time runs backwards or repeats, with the one before it.
pub fn runs_back(content: &Content, clock: &Clock) -> Option<[f64; 2]> {
    match clock {
        Clock::Stamps { column, unit, .. } if !unit.value.is_text() => {
            let stamps = content.columns[*column].numbers.iter();
            let stamps: Vec<f64> = stamps.copied().filter(|value| !value.is_nan()).collect();
            let mut pairs = stamps.windows(2).map(|pair| [pair[0], pair[1]]);
            pairs.find(|[before, now]| now <= before)
        }
        _ => None,
    }
}
