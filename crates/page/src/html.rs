//! Text and numbers as HTML and JSON take them.

/// `text` as a JSON string that may stand within a `script` element: `<` is spelled out.
pub(super) fn json_string(text: &str) -> String {
    serde_json::Value::from(text)
        .to_string()
        .replace('<', "\\u003c")
}

/// Numbers as a JSON list with `digits` significant digits; what is not finite becomes `null`.
pub(super) fn json_numbers(values: impl IntoIterator<Item = f64>, digits: usize) -> String {
    let list: Vec<_> = values
        .into_iter()
        .map(|value| json_number(value, digits))
        .collect();
    format!("[{}]", list.join(","))
}

/// One JSON number in the shorter of both notations, or `null`.
pub(super) fn json_number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "null".into();
    }
    let rounded = self::digits(value, digits);
    let (plain, scientific) = (format!("{rounded}"), format!("{rounded:e}"));
    if plain.len() <= scientific.len() {
        plain
    } else {
        scientific
    }
}

/// `value` to four significant digits as tables and figures show it; an en dash where there is none.
///
/// # Example
/// ```
/// use quell_page::number;
/// assert_eq!(number(8.1234567), "8.123");
/// assert_eq!(number(0.0), "0");
/// assert_eq!(number(1234567.0), "1.235e6");
/// assert_eq!(number(f64::NAN), "–");
/// ```
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let rounded = digits(value, 4);
    let size = rounded.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        return format!("{rounded:e}").replace('-', "\u{2212}");
    }
    format!("{rounded}").replace('-', "\u{2212}")
}

/// `value` to so many significant digits, with trailing zeros, so that the accuracy of a column is the same in each row.
/// As [`number`] where it is 0, or too large or small for that.
///
/// # Example
/// ```
/// use quell_page::significant;
/// assert_eq!(significant(0.46, 3), "0.460");
/// assert_eq!(significant(1.0, 3), "1.00");
/// assert_eq!(significant(99.97, 3), "100");
/// assert_eq!(significant(0.0, 3), "0");
/// ```
pub fn significant(value: f64, count: usize) -> String {
    let rounded = digits(value, count);
    if !(1e-4..1e6).contains(&rounded.abs()) {
        return number(rounded);
    }
    let whole = rounded.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(count as i32 - whole).unwrap_or(0);
    format!("{rounded:.decimals$}").replace('-', "\u{2212}")
}

/// `value` with so many decimals as columns show it; as [`number`] where that would fill the line or there is none.
///
/// # Example
/// ```
/// use quell_page::fixed;
/// assert_eq!([fixed(8.12, 3), fixed(1e300, 3), fixed(f64::NAN, 3)], ["8.120", "1e300", "–"]);
/// // What is rounded to nothing has no sign.
/// assert_eq!(fixed(-1e-9, 2), "0.00");
/// ```
pub fn fixed(value: f64, decimals: usize) -> String {
    match value.abs() < 1e9 {
        true => {
            let text = format!("{value:.decimals$}");
            let is_zero = !text.contains(|letter: char| ('1'..='9').contains(&letter));
            match is_zero {
                true => text.trim_start_matches('-').to_string(),
                false => text,
            }
        }
        false => number(value),
    }
}

/// Decimals with which a value is written beside its standard deviation, so that two digits of the latter are seen: as
/// many as a reader expects at least, and at most nine.
///
/// # Example
/// ```
/// use quell_page::decimals_beside;
/// assert_eq!(decimals_beside(0.015, 3), 3);
/// assert_eq!(decimals_beside(0.00042, 3), 5);
/// assert_eq!(decimals_beside(0.0, 3), 3);
/// ```
pub fn decimals_beside(std: f64, least: usize) -> usize {
    match std.is_finite() && std > 0.0 {
        true => ((1.0 - std.log10().floor()).max(0.0) as usize).clamp(least, 9),
        false => least,
    }
}

/// `value` to so many significant digits, at least one.
///
/// # Example
/// ```
/// assert_eq!(quell_page::digits(0.00050476, 3), 0.000505);
/// ```
pub fn digits(value: f64, count: usize) -> f64 {
    // Adding zero turns a negative zero into zero.
    format!("{value:.*e}", count.saturating_sub(1))
        .parse::<f64>()
        .unwrap_or(value)
        + 0.0
}
