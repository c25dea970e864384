//! `recording.toml`.

use super::fields::Sources;
use super::{codes, table};
use quell::recording::{ROLES, UNITS};
use std::collections::BTreeMap;

pub fn page() -> String {
    let sources = Sources::of(&[
        "crates/recording/src/manifest.rs",
        "crates/recording/src/layout.rs",
    ]);
    let roles = ROLES.iter().map(|entry| {
        let units = entry.dimensions.iter().map(|dimension| {
            let of = UNITS.iter().find(|unit| unit.dimension == *dimension);
            of.map_or("", |unit| unit.si)
        });
        let columns: Vec<_> = entry.columns.iter().map(ToString::to_string).collect();
        [
            format!("`{}`", entry.name),
            codes(units),
            columns.join(" or "),
        ]
    });
    let mut by_si: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for unit in UNITS {
        by_si.entry(unit.si).or_default().extend(unit.names);
    }
    let units = by_si
        .into_iter()
        .map(|(si, names)| [format!("`{si}`"), codes(names)]);
    format!(
        "# The manifest `recording.toml`\n\n[Your own recording](../start/recording.md) shows how to write one. `quell inspect FILE.csv` proposes one.\n\n\
         ## File\n\n{}## Channel\n\n{}## Csv\n\n{}## Roles\n\nAnother unit than the usual ones is kept, and remarked upon.\n\n{}\
         ## Units\n\nValues are converted to SI when they are read.\n\n{}",
        sources.fields("Manifest"),
        sources.fields("Entry"),
        sources.fields("Layout"),
        table(["role", "usual units (SI)", "columns"], roles),
        table(["SI", "what may be written"], units),
    )
}
