//! Dates and times of day as text: orders of their fields, halves of a day, time zones.

use toml::value::Datetime;

/// Nanoseconds a second.
pub(super) const GIGA: i128 = 1_000_000_000;

/// A date and time of ISO 8601 as nanoseconds since 1970-01-01, or a time of day since its midnight; a time zone is
/// subtracted, where there is one.
pub(super) fn nanoseconds(cell: &str) -> Option<i128> {
    let stamp: Datetime = plain(cell).parse().ok()?;
    let time = stamp.time?;
    let days = stamp.date.map_or(0, |date| {
        days(date.year.into(), date.month.into(), date.day.into())
    });
    let minutes = match stamp.offset {
        Some(toml::value::Offset::Custom { minutes }) => i128::from(minutes),
        _ => 0,
    };
    let of_day = 3600 * i128::from(time.hour) + 60 * (i128::from(time.minute) - minutes);
    let seconds = 86_400 * days + of_day + i128::from(time.second.unwrap_or(0));
    Some(seconds * GIGA + i128::from(time.nanosecond.unwrap_or(0)))
}

/// A stamp with dashes in its date, a point, two digits of each field, an hour of the day's 24 and a colon in the time
/// zone: in `2024/5/1 9:01:02,5 PM` and `+0200` they are not there.
fn plain(cell: &str) -> String {
    let mut cell = padded(&cell.trim().replace(',', "."));
    let half = ["AM", "PM"].iter().position(|half| {
        let at = cell.len().saturating_sub(2);
        cell.get(at..)
            .is_some_and(|end| end.eq_ignore_ascii_case(half))
    });
    if half.is_some() {
        cell.truncate(cell.len() - 2);
        cell.truncate(cell.trim_end().len());
    }
    let begins = cell.find(['T', ' ']).map_or(0, |at| at + 1);
    // Some instruments write `12:01:02:500`.
    if let (3, Some(last)) = (cell[begins..].matches(':').count(), cell.rfind(':')) {
        let is_part = cell[last + 1..]
            .bytes()
            .take_while(u8::is_ascii_digit)
            .count()
            >= 3;
        if is_part {
            cell.replace_range(last..=last, ".");
        }
    }
    if let Some(half) = half
        && let Some(hour) = cell.get(begins..begins + 2)
        && let Ok(hour) = hour.parse::<usize>()
        && (1..=12).contains(&hour)
    {
        let hour = hour % 12 + 12 * half;
        cell.replace_range(begins..begins + 2, &format!("{hour:02}"));
    }
    let zone = cell[begins..].find(['+', '-']).map(|at| begins + at + 1);
    if let Some(zone) = zone
        && cell.len() == zone + 4
        && cell[zone..].bytes().all(|digit| digit.is_ascii_digit())
    {
        cell.insert(zone + 2, ':');
    }
    cell
}

/// `2024-05-01 09:01:02.5` of `2024/5/1 9:1:2.5` or `2024.5.1 9:1:2.5`: a field of one digit gets a second one.
fn padded(cell: &str) -> String {
    let begins = cell.find(['T', ' ']).map_or(0, |at| at + 1);
    let (date, time) = cell.split_at(begins);
    let mut text = String::with_capacity(cell.len() + 4);
    for field in date
        .replace(['/', '.'], "-")
        .split_inclusive(['-', 'T', ' '])
    {
        add_field(&mut text, field);
    }
    for field in time.split_inclusive(':') {
        add_field(&mut text, field);
    }
    text
}

/// Adds a field with its separator, with two digits at least.
fn add_field(text: &mut String, field: &str) {
    let digits = field.bytes().take_while(u8::is_ascii_digit).count();
    if digits == 1 {
        text.push('0');
    }
    text.push_str(field);
}

/// `2024-05-01 12:00:00,250` of `01.05.2024 12:00:00,250` or `1/5/24 12:00:00,250`, or with the month first; a year of
/// two digits is of this century.
pub(super) fn year_first(cell: &str, month_first: bool) -> Option<String> {
    let (date, time) = cell.trim().split_once([' ', 'T'])?;
    let mut parts = date.split(['.', '/', '-']);
    let (first, second, year) = (parts.next()?, parts.next()?, parts.next()?);
    let [day, month] = match month_first {
        true => [second, first],
        false => [first, second],
    };
    let century = if year.len() == 2 { "20" } else { "" };
    Some(format!(
        "{century}{year}-{month:0>2}-{day:0>2} {}",
        time.trim()
    ))
}

/// Days of the Gregorian calendar since 1970-01-01.
///
/// Source: E. G. Richards in the Explanatory Supplement to the Astronomical Almanac (2013), with March as the first month.
fn days(year: i128, month: i128, day: i128) -> i128 {
    let year = if month <= 2 { year - 1 } else { year };
    let month = (month + 9) % 12;
    let leap = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    365 * year + leap + (153 * month + 2) / 5 + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_dates_are_seconds_since_1970() {
        // `date -u -d ... +%s`
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", 0),
            ("2000-02-29 12:00:00", 951_825_600),
            ("2024-05-01T02:00:00+02:00", 1_714_521_600),
            ("2038-01-19T03:14:07.5Z", 2_147_483_647),
        ] {
            assert_eq!(
                nanoseconds(text).unwrap().div_euclid(GIGA),
                seconds,
                "{text}"
            );
        }
    }
}
