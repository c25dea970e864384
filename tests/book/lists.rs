//! Lists that pages hold in sentences of their own: none may lack what the code has.

use super::root;
use quell::effects::{EFFECTS, LEARNED};
use quell::estimators::ESTIMATORS;
use quell::recording::ROLES;

fn lacks<'a>(page: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(page)).unwrap();
    let absent = |name: &&str| !text.contains(&format!("`{name}`"));
    let names = names.into_iter().filter(absent);
    names.map(|name| format!("{page}: {name}")).collect()
}

#[test]
fn no_list_lacks_a_name() {
    let command = quell::cli::command();
    let verbs = command.get_subcommands().map(|verb| verb.get_name());
    let verdicts = [
        "no_mismatch",
        "named",
        "ambiguous",
        "partly_explained",
        "unexplained",
        "not_excited",
    ];
    let absent = [
        lacks("README.md", verbs),
        lacks(
            "docs/src/start/recording.md",
            ROLES.iter().map(|role| role.name),
        ),
        lacks(
            "docs/src/theory/learned-laws.md",
            LEARNED.iter().map(|law| law.name),
        ),
        lacks(
            "docs/src/theory/estimators.md",
            ESTIMATORS.iter().map(|entry| entry.name),
        ),
        lacks("docs/src/guide/verdicts.md", verdicts),
    ];
    assert!(absent.concat().is_empty(), "{:?}", absent.concat());
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let count = format!("a catalogue of {}", EFFECTS.len());
    assert!(readme.contains(&count), "README.md should say {count}");
}
