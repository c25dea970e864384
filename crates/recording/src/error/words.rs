//! Parts of messages: cells, names, and suggestions.

pub(super) fn suggestion(nearest: &Option<&'static str>) -> String {
    nearest
        .map(|name| format!("; did you mean \"{name}\"?"))
        .unwrap_or_default()
}

/// Most characters of a cell or a name in an error, and most names of columns: enough to find it.
const SHOWN: usize = 40;
const NAMES: usize = 24;

/// A cell in quotes, shortened if it is long.
pub(super) fn quoted(text: &str) -> String {
    match text.chars().count() > SHOWN {
        false => format!("{text:?}"),
        true => format!("{:?}...", text.chars().take(SHOWN).collect::<String>()),
    }
}

/// A value as it is written, of one line, shortened if it is long.
pub fn shortened(text: &str) -> String {
    cut(text.lines().next().unwrap_or_default())
}

/// The names of the columns; a header of numbers has none.
pub(super) fn columns(present: &[String]) -> String {
    let is_number = |name: &String| name.replace(',', ".").parse::<f64>().is_ok();
    if present.iter().all(is_number) {
        let count = present.len();
        return format!(
            "there is no header, only {count} column(s): with csv = {{ header = false }} in recording.toml they are \
             called \"1\" to \"{count}\""
        );
    }
    let shown: Vec<_> = present.iter().take(NAMES).map(|name| cut(name)).collect();
    let more = match present.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("the columns are: {}{more}", shown.join(", "))
}

/// A name, shortened if it is long.
fn cut(name: &str) -> String {
    match name.chars().count() > SHOWN {
        false => name.into(),
        true => name.chars().take(SHOWN).chain("...".chars()).collect(),
    }
}

pub(super) fn hint(text: &str) -> &'static str {
    let is_decimal_comma =
        text.matches(',').count() == 1 && text.replace(',', ".").parse::<f64>().is_ok();
    match text {
        _ if is_decimal_comma => {
            " (a decimal comma is read with csv = { decimal = \",\" } in recording.toml)"
        }
        "" => {
            " (the cell is empty; it is a missing sample with csv = { missing = [\"\"] } in recording.toml)"
        }
        _ => "",
    }
}

/// The candidate that a misspelt name resembles most, if any does: at most a third of its letters
/// differ, by insertions, deletions, substitutions and swaps.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| {
            (
                strsim::damerau_levenshtein(&name, &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(distance, candidate)| *distance <= candidate.len().max(3) / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}
