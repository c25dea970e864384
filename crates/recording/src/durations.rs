//! Durations in the words of a controller's program: TIME literals of IEC 61131-3.

use super::dates::GIGA;

/// What a literal begins with.
const MARKS: [&str; 4] = ["T", "TIME", "LT", "LTIME"];

/// The units in their order, and the nanoseconds that each has.
const UNITS: [(&str, i128); 7] = [
    ("d", 86_400 * GIGA),
    ("h", 3600 * GIGA),
    ("m", 60 * GIGA),
    ("s", GIGA),
    ("ms", 1_000_000),
    ("us", 1_000),
    ("ns", 1),
];
/// Digits behind a point that are read: a nanosecond of a day has fewer.
const DIGITS: usize = 15;

/// Nanoseconds of `T#1s4ms`, `time#-1h_30m` or `LT#2.5ms`; `None` for another text. The units fall from left to right, and only the last
/// number has a point; the first may have any size, as `T#4000ms`.
pub(super) fn nanoseconds(cell: &str) -> Option<i128> {
    let (mark, rest) = cell.trim().split_once('#')?;
    if !MARKS.iter().any(|own| own.eq_ignore_ascii_case(mark)) {
        return None;
    }
    let rest = rest.to_ascii_lowercase().replace('_', "");
    let (sign, mut rest) = match rest.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, rest.as_str()),
    };
    let mut from = 0;
    let mut sum = 0i128;
    loop {
        let (number, unit, behind) = part(rest)?;
        let place = from + UNITS[from..].iter().position(|own| own.0 == unit)?;
        if number.contains('.') && !behind.is_empty() {
            return None;
        }
        sum = sum.checked_add(times(number, UNITS[place].1)?)?;
        (from, rest) = (place + 1, behind);
        if rest.is_empty() {
            return Some(sign * sum);
        }
    }
}

/// The first number, its unit, and what is behind these.
fn part(text: &str) -> Option<(&str, &str, &str)> {
    let is_of_number = |letter: char| letter.is_ascii_digit() || letter == '.';
    let (number, rest) = text.split_at(text.find(|letter| !is_of_number(letter))?);
    let ends = rest.find(is_of_number).unwrap_or(rest.len());
    Some((number, &rest[..ends], &rest[ends..]))
}

/// A number times so many nanoseconds, without rounding before the last one.
fn times(number: &str, nanoseconds: i128) -> Option<i128> {
    let (whole, part) = number.split_once('.').unwrap_or((number, ""));
    let part = part.get(..DIGITS.min(part.len()))?;
    let fraction: i128 = match part.is_empty() {
        true => 0,
        false => part.parse().ok()?,
    };
    let whole: i128 = whole.parse().ok()?;
    let of_part = fraction * nanoseconds / 10i128.pow(part.len() as u32);
    whole.checked_mul(nanoseconds)?.checked_add(of_part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_literals_are_read_and_no_other_text() {
        for (text, told) in [
            ("T#4ms", Some(4_000_000)),
            ("t#4000ms", Some(4 * GIGA)),
            ("T#1s4ms", Some(1_004_000_000)),
            ("TIME#1h_30m", Some(5400 * GIGA)),
            ("LTIME#1d2h3m4s5ms6us7ns", Some(93_784_005_006_007)),
            ("T#-2.5s", Some(-2_500_000_000)),
            ("T#0ms", Some(0)),
            ("T#0.1d", Some(8640 * GIGA)),
            ("T#4ms1s", None),
            ("T#1.5s4ms", None),
            ("T#1s1s", None),
            ("T#", None),
            ("T#4", None),
            ("T#ms", None),
            ("T#1.2.3s", None),
            ("X#4ms", None),
            ("4ms", None),
            ("T#\u{20ac}ms", None),
            ("T#99999999999999999999999999999999999999d", None),
        ] {
            assert_eq!(nanoseconds(text), told, "{text}");
        }
    }
}
