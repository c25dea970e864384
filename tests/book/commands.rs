//! The commands of a `sh` block, and whether each could be typed.

use super::root;
use std::collections::BTreeSet;
use std::path::Path;

/// Programs of others, which are not looked at further.
const OTHERS: [&str; 15] = [
    "apt-get",
    "cc",
    "cd",
    "cp",
    "git",
    "gcc",
    "man",
    "mdbook",
    "mkdir",
    "nats-server",
    "openssl",
    "pip",
    "ros2",
    "rustup",
    "ulimit",
];

/// What a block types: one command a line, comments and continued lines resolved.
pub fn commands(block: &str) -> Vec<String> {
    let whole = block.replace("\\\n", " ");
    let lines = whole.lines().map(|line| match line.find(" #") {
        Some(start) => &line[..start],
        None => line,
    });
    let lines = lines.filter(|line| !line.trim_start().starts_with('#'));
    let parts = lines.flat_map(|line| line.split(" && ").flat_map(|part| part.split(" | ")));
    let parts = parts.map(|part| part.trim().to_string());
    parts.filter(|part| !part.is_empty()).collect()
}

/// Words of a command, quotes resolved, without redirections.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    for letter in command.chars() {
        match (letter, quote) {
            (_, Some(open)) if letter == open => quote = None,
            ('\'' | '"', None) => quote = Some(letter),
            (' ', None) => {
                words.extend(Some(std::mem::take(&mut word)).filter(|word| !word.is_empty()))
            }
            _ => word.push(letter),
        }
    }
    words.extend(Some(word).filter(|word| !word.is_empty()));
    let redirected = words.iter().position(|word| word.starts_with('>'));
    words.truncate(redirected.unwrap_or(words.len()));
    // NAME=value before a command.
    let named = |word: &&String| word.split_once('=').is_some_and(|(name, _)| is_name(name));
    let set = words.iter().take_while(named).count();
    words.drain(..set);
    words
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_uppercase() || c == '_')
}

/// What is wrong with a command, if anything.
pub fn fault(command: &str, paths: &BTreeSet<String>) -> Option<String> {
    let words = words(command);
    let first = words.first()?;
    match first.as_str() {
        "quell" | "target/release/quell" => quell(&words[1..]),
        "cargo" => cargo(&words[1..]),
        "curl" => curl(&words, paths),
        "python3" => missing(words.get(1)?),
        "time" => fault(&words[1..].join(" "), paths),
        other if OTHERS.contains(&other) => None,
        other if other.contains('/') => missing(other),
        other => Some(format!("{other} is no program that a page may use")),
    }
}

fn missing(file: &str) -> Option<String> {
    (!root().join(file).exists()).then(|| format!("{file} does not exist"))
}

fn quell(arguments: &[String]) -> Option<String> {
    let typed = std::iter::once("quell").chain(arguments.iter().map(String::as_str));
    let error = quell::cli::command().try_get_matches_from(typed).err()?;
    // Help and version are errors to the parser.
    (error.exit_code() != 0).then(|| error.to_string())
}

fn cargo(arguments: &[String]) -> Option<String> {
    let own = arguments.iter().position(|word| word == "--");
    let (cargo, program) = arguments.split_at(own.unwrap_or(arguments.len()));
    let value = |name: &str| {
        let at = cargo.iter().position(|word| word == name)?;
        cargo.get(at + 1)
    };
    let package = match value("-p").map(String::as_str) {
        None => root().to_path_buf(),
        Some("quell-shapers") => root().join("shapers"),
        Some("quell-trajectories") => root().join("trajectories"),
        Some(name) => root().join("crates").join(name.strip_prefix("quell-")?),
    };
    for (option, folder) in [
        ("--test", "tests"),
        ("--bench", "benches"),
        ("--example", "examples"),
    ] {
        if let Some(name) = value(option).filter(|name| !exists(&package, folder, name)) {
            return Some(format!("{option} {name} does not exist"));
        }
    }
    if let Some(features) = value("--features") {
        let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
        let manifest: toml::Table = manifest.parse().unwrap();
        let known = manifest["features"].as_table().unwrap();
        let unknown = features.split(',').find(|name| !known.contains_key(*name));
        if let Some(name) = unknown {
            return Some(format!("there is no feature {name}"));
        }
    }
    let runs = cargo.first().is_some_and(|word| word == "run") && value("--example").is_none();
    runs.then(|| quell(program.get(1..).unwrap_or_default()))?
}

fn exists(package: &Path, folder: &str, name: &str) -> bool {
    let folder = package.join(folder);
    folder.join(name).with_extension("rs").exists() || folder.join(name).join("main.rs").exists()
}

fn curl(words: &[String], paths: &BTreeSet<String>) -> Option<String> {
    let address = words.iter().find(|word| word.starts_with("127.0.0.1"))?;
    let (_, path) = address.split_once('/')?;
    let alike = |known: &&String| {
        let (known, path) = (known.trim_start_matches('/').split('/'), path.split('/'));
        known.clone().count() == path.clone().count()
            && known
                .zip(path)
                .all(|(known, typed)| known == typed || known.starts_with('{'))
    };
    (!paths.iter().any(|known| alike(&known))).then(|| format!("nothing is at /{path}"))
}
