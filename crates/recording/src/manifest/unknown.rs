//! Keys that a table of a manifest does not have, with the table that they belong in.

use super::{Entry, Manifest};
use crate::error::nearest;
use crate::layout::Layout;
use crate::syntax::quoted;
use serde::de::DeserializeOwned;

/// What to do with an unknown key, by the reader's message: `; it belongs in a [[channel]]`, or the key that was probably meant.
pub(super) fn advice(key: &str, message: &str) -> String {
    let own = expected(message);
    let others: Vec<_> = tables()
        .into_iter()
        .filter(|table| table.1 != own)
        .collect();
    let having = others
        .iter()
        .filter(|(_, keys)| keys.iter().any(|own| own == key));
    let places: Vec<&str> = having.map(|(place, _)| *place).collect();
    if !places.is_empty() {
        return format!("; it belongs {}", places.join(" or "));
    }
    let meant = |keys: &[String]| nearest(key, keys.iter().map(String::as_str)).map(str::to_owned);
    if let Some(near) = meant(&own) {
        return format!("; did you mean \"{near}\"?");
    }
    let elsewhere = others
        .iter()
        .find_map(|(place, keys)| Some((meant(keys)?, place)));
    elsewhere.map_or_else(String::new, |(near, place)| {
        format!("; did you mean \"{near}\"? It belongs {place}")
    })
}

/// The tables of a manifest: where each stands, and its keys.
fn tables() -> [(&'static str, Vec<String>); 3] {
    [
        (
            "at the top, above the first [[channel]]",
            keys::<Manifest>(),
        ),
        ("in a [[channel]]", keys::<Entry>()),
        ("in [csv]", keys::<Layout>()),
    ]
}

/// The keys of a table, as its reader tells them of a key that it does not have.
fn keys<T: DeserializeOwned>() -> Vec<String> {
    let refused = toml::from_str::<T>("\"\" = 0").err();
    refused.map_or_else(Vec::new, |error| expected(error.message()))
}

/// The keys in "unknown field `x`, expected one of `a`, `b`".
fn expected(message: &str) -> Vec<String> {
    let list = message
        .split_once(", expected ")
        .map_or("", |(_, list)| list);
    quoted(list).into_iter().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    /// What reading a manifest with these lines says.
    fn refused(lines: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("recording.toml");
        std::fs::write(&file, lines).unwrap();
        let error = crate::Recording::from_path(&file).unwrap_err().to_string();
        error.split("recording.toml").last().unwrap().to_owned()
    }

    #[test]
    fn a_key_of_another_table_is_told_with_its_table() {
        let channel = "name = \"a\"\n[[channel]]\nrole = \"motor_position\"\n";
        for (lines, said) in [
            (
                "name = \"a\"\nrate_hz = 500\n",
                ":2: unknown key \"rate_hz\"; it belongs in a [[channel]]",
            ),
            (
                "name = \"a\"\ndecimal = \",\"\n",
                ":2: unknown key \"decimal\"; it belongs in [csv]",
            ),
            (
                &format!("{channel}skip = 3\n"),
                ":4: unknown key \"skip\"; it belongs in [csv]",
            ),
            (
                &format!("{channel}payload = \"2 kg\"\n"),
                ":4: unknown key \"payload\"; it belongs at the top, above the first [[channel]]",
            ),
            (
                "name = \"a\"\n[csv]\ntime_unit = \"ms\"\n",
                ":3: unknown key \"time_unit\"; it belongs in a [[channel]]",
            ),
            (
                "nam = \"a\"\n",
                ":1: unknown key \"nam\"; did you mean \"name\"?",
            ),
            (
                "name = \"a\"\nratehz = 500\n",
                ":2: unknown key \"ratehz\"; did you mean \"rate_hz\"? It belongs in a [[channel]]",
            ),
            ("name = \"a\"\ncolour = 500\n", ":2: unknown key \"colour\""),
        ] {
            assert_eq!(refused(lines), said);
        }
    }
}
