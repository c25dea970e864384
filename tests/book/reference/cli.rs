//! The command line.

use super::table;
use clap::Command;
use quell::cli::{CliError, ENVIRONMENT, command};

/// Verbs that are not in every build, and the feature that builds them.
const OPTIONAL: [(&str, &str); 3] = [("results", "nats"), ("serve", "serve"), ("work", "nats")];

pub fn page() -> String {
    let mut whole = command();
    whole.build();
    let verbs: Vec<&Command> = whole
        .get_subcommands()
        .filter(|verb| verb.get_name() != "help")
        .collect();
    let about = |verb: &Command| {
        verb.get_about()
            .map_or(String::new(), |about| about.to_string())
    };
    let rows = verbs.iter().map(|verb| {
        let name = verb.get_name();
        [format!("[`quell {name}`](#quell-{name})"), about(verb)]
    });
    let codes = CliError::EXIT_CODES.map(|(code, when)| [code.to_string(), when.into()]);
    let mut page = format!(
        "# Command line\n\nEach verb has `--help`. Verbs with figures have `--json`, verbs with files `--out DIR`. A verb \
         replaces in `--out` only what it wrote there itself and nobody changed since (`.quell.json` lists it); \
         `--force` replaces the other files that it writes, too, but never one that it reads.\n\n## Verbs\n\n{}\
         ## Exit codes\n\n{}A signal ends a verb as usual: Ctrl-C gives 130 in a shell. `quell serve` and `quell work` \
         take it as a wish to end, finish what they must, and leave with 0.\n\n\
         ## Environment\n\n{}",
        table(["verb", "what for"], rows),
        table(["code", "when"], codes),
        table(["variable", "what it does"], environment()),
    );
    page.extend(verbs.into_iter().map(section));
    page
}

/// A verb's help.
fn section(verb: &Command) -> String {
    let name = verb.get_name();
    let needs = OPTIONAL.iter().find(|(optional, _)| *optional == name);
    let needs = needs.map_or(String::new(), |(_, feature)| {
        format!("Needs the feature `{feature}`: `cargo build --release --features {feature}`.\n\n")
    });
    // The book is of every feature, built in or not.
    let all = verb.clone().mut_args(|argument| argument.hide(false));
    let all = all.before_help(None::<&str>);
    let help = { all }.render_long_help().to_string();
    let lines: Vec<_> = help.lines().map(str::trim_end).collect();
    let help = lines.join("\n");
    format!(
        "## `quell {name}`\n\n{needs}```text\n{}\n```\n\n",
        help.trim()
    )
}

fn environment() -> [[String; 2]; 2] {
    ENVIRONMENT.map(|[name, what]| [format!("`{name}`"), what.to_string()])
}
