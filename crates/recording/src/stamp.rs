//! Stamps in other units than seconds: milliseconds, an epoch's nanoseconds, dates and times of day.

use super::dates::{GIGA, nanoseconds, year_first};
use super::durations;

/// The unit of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds.
    Nanoseconds,
    /// Minutes.
    Minutes,
    /// Days, as the serial dates of spreadsheets and of MATLAB count them.
    Days,
    /// Date and time by ISO 8601, as `2024-05-01T12:00:00.250Z`, also `2024/05/01`; or a time of day, as `12:00:00.250`.
    Iso,
    /// Day, month, year and time, as `01.05.2024 12:00:00,250` or `01/05/2024`.
    DayFirst,
    /// Month, day, year and time, as `05/01/2024 12:00:00.250 PM`.
    MonthFirst,
    /// A duration of a controller's program, by IEC 61131-3: `T#1s4ms`, `LTIME#1m_2.5s`.
    Iec,
}

/// Whether a number may be seconds since 1970, in the years 2001 to 2286: it has ten digits.
pub(super) fn is_since_1970(seconds: f64) -> bool {
    (1e9..1e10).contains(&seconds)
}

/// All units of time, with their names in a manifest and the nanoseconds that each has.
pub const TIME_UNITS: &[(TimeUnit, &str, i128)] = &[
    (TimeUnit::Seconds, "s", 1_000_000_000),
    (TimeUnit::Milliseconds, "ms", 1_000_000),
    (TimeUnit::Microseconds, "us", 1_000),
    (TimeUnit::Nanoseconds, "ns", 1),
    (TimeUnit::Minutes, "min", 60_000_000_000),
    (TimeUnit::Days, "day", 86_400_000_000_000),
    (TimeUnit::Iso, "iso", 1),
    (TimeUnit::DayFirst, "dmy", 1),
    (TimeUnit::MonthFirst, "mdy", 1),
    (TimeUnit::Iec, "iec", 1),
];

/// Origin of stamps since an epoch: the whole second of the first one, s. All channels of a recording share it.
pub type Origin = Option<i128>;

/// Stamps, s, from which they count as since an epoch: no run lasts three years.
const EPOCH: i128 = 100_000_000;
/// Seconds a day.
const DAY: f64 = 86_400.0;
/// Digits behind the point, beyond nanoseconds, that are kept.
const DIGITS: usize = 9;

impl TimeUnit {
    /// The unit of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        let found = TIME_UNITS.iter().find(|line| line.1 == name);
        found.map(|line| line.0)
    }

    /// The unit that people mean by a word, as `sec` or `milliseconds`.
    pub fn from_word(word: &str) -> Option<Self> {
        let plain = word.trim().to_lowercase();
        match plain.as_str() {
            "sec" | "second" | "seconds" => Some(Self::Seconds),
            "msec" | "millis" | "milliseconds" => Some(Self::Milliseconds),
            "usec" | "\u{b5}s" | "\u{3bc}s" | "micros" | "microseconds" => Some(Self::Microseconds),
            "nsec" | "nanos" | "nanoseconds" => Some(Self::Nanoseconds),
            "minutes" => Some(Self::Minutes),
            "days" => Some(Self::Days),
            other => Self::from_name(other).filter(|unit| !unit.is_text()),
        }
    }

    /// The number and the unit of a cell such as `0.004 sec`, as of durations in MATLAB.
    pub(super) fn in_cell(cell: &str) -> Option<(&str, Self)> {
        let (number, word) = cell.trim().split_once(' ')?;
        Some((number, Self::from_word(word)?))
    }

    /// Its name in a manifest.
    pub fn name(self) -> &'static str {
        TIME_UNITS[self as usize].1
    }

    /// Whether stamps are dates, times of day or durations in words, and not numbers.
    pub fn is_text(self) -> bool {
        matches!(
            self,
            Self::Iso | Self::DayFirst | Self::MonthFirst | Self::Iec
        )
    }

    /// A stamp after another one, s: a time of day that has fallen by more than half a day is of the next.
    pub(super) fn after(self, previous: f64, stamp: f64, cell: &str) -> f64 {
        let is_of_day = self == Self::Iso && cell.trim().find(':').is_some_and(|at| at <= 2);
        match is_of_day {
            true => stamp + DAY * ((previous - stamp) / DAY).round().max(0.0),
            false => stamp,
        }
    }

    /// Seconds that one of them has.
    pub fn in_seconds(self) -> f64 {
        TIME_UNITS[self as usize].2 as f64 / GIGA as f64
    }

    /// A cell in seconds; `None` where it is no time, or not finite.
    ///
    /// The origin of an epoch is subtracted before rounding: a double has a resolution of 0.2 us there.
    pub fn seconds(self, cell: &str, origin: &mut Origin) -> Option<f64> {
        let date = match self {
            Self::Iso => Some(nanoseconds(cell)?),
            Self::DayFirst => Some(nanoseconds(&year_first(cell, false)?)?),
            Self::MonthFirst => Some(nanoseconds(&year_first(cell, true)?)?),
            Self::Iec => Some(durations::nanoseconds(cell)?),
            _ => None,
        };
        if let Some(date) = date {
            return Some(since(date * GIGA, origin));
        }
        let cell = match Self::in_cell(cell) {
            Some((number, unit)) if unit == self => number,
            _ => cell,
        };
        let value: f64 = cell.parse().ok()?;
        let nanoseconds = TIME_UNITS[self as usize].2;
        let seconds = match self {
            Self::Minutes | Self::Days => value * self.in_seconds(),
            // The power of ten is exact, so that the quotient is rounded once.
            _ => value / (GIGA / nanoseconds) as f64,
        };
        match seconds.is_finite() {
            false => None,
            true if seconds < EPOCH as f64 && origin.is_none() => Some(seconds),
            true if self == Self::Days => Some(since(of_days(cell)?, origin)),
            true => match exact(cell, nanoseconds) {
                Some(stamp) => Some(since(stamp, origin)),
                None => Some(seconds - origin.unwrap_or(0) as f64),
            },
        }
    }
}

/// A serial date, in units of 1e-18 s: of a day, a double resolves less than that of a part of it.
fn of_days(cell: &str) -> Option<i128> {
    let days: f64 = cell.parse().ok()?;
    let (whole, part) = match cell.split_once('.') {
        Some((whole, part)) if !part.contains(['e', 'E']) => {
            (whole.parse().ok()?, format!("0.{part}").parse().ok()?)
        }
        _ => (days.floor(), days - days.floor()),
    };
    let seconds: f64 = part * DAY;
    Some((whole as i128 * DAY as i128 * GIGA * GIGA) + (seconds * (GIGA as f64).powi(2)) as i128)
}

/// A number times so many nanoseconds, in units of 1e-18 s; `None` for a number with a power of ten.
fn exact(cell: &str, nanoseconds: i128) -> Option<i128> {
    let (whole, part) = cell.split_once('.').unwrap_or((cell, ""));
    let part = &part[..part.len().min(DIGITS)];
    if !part.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let fraction: i128 = format!("{part:0<DIGITS$}").parse().ok()?;
    let whole: i128 = whole.parse().ok()?;
    let scaled = whole.checked_mul(GIGA)?.checked_add(fraction)?;
    scaled.checked_mul(nanoseconds)
}

/// Units of 1e-18 s from the origin on, in s.
fn since(stamp: i128, origin: &mut Origin) -> f64 {
    let second = GIGA * GIGA;
    let origin = *origin.get_or_insert(stamp.div_euclid(second));
    let rest = stamp - origin * second;
    rest.div_euclid(second) as f64 + rest.rem_euclid(second) as f64 / second as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (index, line) in TIME_UNITS.iter().enumerate() {
            assert_eq!(line.0 as usize, index);
            assert_eq!(TimeUnit::from_name(line.1), Some(line.0));
        }
    }

    #[test]
    fn times_of_day_and_other_orders_are_read() {
        let seconds = |unit: TimeUnit, cell: &str| unit.seconds(cell, &mut Some(0));
        let day = |seconds: f64| Some(seconds + 1_714_694_400.0);
        for (unit, cell, told) in [
            (TimeUnit::Iso, "12:01:02.123", Some(43_262.123)),
            (TimeUnit::Iso, "9:01:02,5", Some(32_462.5)),
            (TimeUnit::Iso, "12:01:02:250", Some(43_262.25)),
            (
                TimeUnit::MonthFirst,
                "05/03/2024 12:01:02:250",
                day(43_262.25),
            ),
            (TimeUnit::Iso, "12:01:02:", None),
            (TimeUnit::Iso, "2024-05-03 12:01:02.25", day(43_262.25)),
            (TimeUnit::Iso, "2024-05-03T12:01:02,25+0200", day(36_062.25)),
            (TimeUnit::DayFirst, "03.05.2024 12:01:02,25", day(43_262.25)),
            (TimeUnit::DayFirst, "3.5.24 9:01:02", day(32_462.0)),
            (TimeUnit::DayFirst, "03.13.2024 12:01:02", None),
            (TimeUnit::DayFirst, "2024-05-03 12:01:02", None),
            (TimeUnit::Iso, "2024/05/03 12:01:02.25", day(43_262.25)),
            (TimeUnit::Iso, "2024-5-3 9:01:02.25", day(32_462.25)),
            (TimeUnit::Iso, "2024.5.3 9:1:2", day(32_462.0)),
            (TimeUnit::DayFirst, "03/05/2024 12:01:02", day(43_262.0)),
            (
                TimeUnit::MonthFirst,
                "05/03/2024 12:01:02.25 PM",
                day(43_262.25),
            ),
            (TimeUnit::MonthFirst, "5/3/2024 9:01:02 am", day(32_462.0)),
            (TimeUnit::MonthFirst, "5-3-24 12:00:00 AM", day(0.0)),
            (TimeUnit::MonthFirst, "5/3/24 13:00:00 PM", day(46_800.0)),
            (TimeUnit::MonthFirst, "13/05/2024 12:01:02", None),
            (TimeUnit::Iso, "25:01:02", None),
            (TimeUnit::Iso, "PM", None),
            (TimeUnit::Iso, "1:02:\u{20ac}PM", None),
            (TimeUnit::Iso, "", None),
            (TimeUnit::Iso, "+1\u{20ac}", None),
        ] {
            assert_eq!(seconds(unit, cell), told, "{cell}");
        }
    }

    #[test]
    fn midnight_is_passed_by_times_of_day_alone() {
        let next = |cell| TimeUnit::Iso.after(86_399.9, 0.1, cell);
        assert_eq!(next("00:00:00.1"), 86_400.1);
        assert_eq!(next("2024-05-03 00:00:00.1"), 0.1);
        // What runs back by less is no midnight.
        assert_eq!(TimeUnit::Iso.after(10.0, 4.0, "00:00:04"), 4.0);
    }

    #[test]
    fn an_epoch_in_any_unit_loses_no_nanosecond() {
        for (unit, first, second, step) in [
            (
                TimeUnit::Nanoseconds,
                "1700000000000000000",
                "1700000000000312500",
                312.5e-6,
            ),
            (
                TimeUnit::Microseconds,
                "1700000000000000",
                "1700000000000312.5",
                312.5e-6,
            ),
            (
                TimeUnit::Seconds,
                "1700000000.000000001",
                "1700000000.000312501",
                312.5e-6,
            ),
            (
                TimeUnit::Milliseconds,
                "1700000000000",
                "1700000000001",
                1e-3,
            ),
            (TimeUnit::Milliseconds, "5", "6", 1e-3),
        ] {
            let mut origin = None;
            let times = [first, second].map(|cell| unit.seconds(cell, &mut origin).unwrap());
            assert!((times[1] - times[0] - step).abs() < 1e-12, "{times:?}");
            assert!(times[0] < 1.0);
        }
    }
}
