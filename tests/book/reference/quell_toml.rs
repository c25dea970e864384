//! `quell.toml`.

use quell::service::config::listed;

/// What `quell serve --print-config` prints, a section for each table.
pub fn page() -> String {
    let text = listed();
    let mut parts = text.split("\n\n").skip(1);
    let mut page = String::from(
        "# The configuration `quell.toml`\n\n`quell serve --config quell.toml` reads it. Every table may be left out. So may every \
         key, unless it is said to be needed. `quell serve --print-config` prints this list. A value in it is the default. A key \
         without a value has no default.\n\n",
    );
    let mut sections = Vec::new();
    for part in &mut parts {
        let header = part.lines().map(|line| line.trim_start_matches("# "));
        let table = header
            .into_iter()
            .find(|line| line.starts_with('['))
            .unwrap_or_default();
        let name = table.trim_matches(['[', ']']);
        let (own, _) = part.split_once('\n').unwrap_or((part, ""));
        let what = own.trim_start_matches("# ");
        let what = what.split_once("`: ").map_or(what, |(_, what)| what);
        sections.push((
            name.to_string(),
            table.to_string(),
            what.to_string(),
            part.trim().to_string(),
        ));
    }
    for (name, table, what, part) in &sections {
        let keys = part.lines().filter_map(|line| {
            line.trim_start_matches("# ")
                .split_once(" =")
                .map(|(key, _)| key)
        });
        let keys = keys.filter(|key| {
            key.chars()
                .all(|c| c.is_ascii_lowercase() || c == '_' || c.is_ascii_digit())
        });
        let keys: Vec<_> = keys.map(|key| format!("`{key}`")).collect();
        page += &format!("- [`{table}`](#{name}): {what} {}.\n", keys.join(", "));
    }
    page += "\n";
    for (name, _, _, part) in &sections {
        page += &format!("## {name}\n\n```toml,quell\n{part}\n```\n\n");
    }
    page
}
