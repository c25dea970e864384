//! Shapers and estimators by name.

use super::table;
use quell::estimators::ESTIMATORS;
use quell::shapers::SHAPERS;

pub fn page() -> String {
    let shapers = SHAPERS
        .iter()
        .map(|shaper| [format!("`{}`", shaper.name()), shaper.summary().to_string()]);
    let yes = |is: bool| if is { "yes" } else { "no" }.to_string();
    let estimators = ESTIMATORS.iter().map(|entry| {
        let name = format!("`{}`", entry.name);
        [
            name,
            entry.summary.into(),
            yes(entry.uses_motion),
            yes(entry.states_error),
        ]
    });
    let header = ["name", "what", "sees the motion", "states its error"];
    format!(
        "# Shapers and estimators\n\n`--shaper` and `--estimator` of the command line, `shaper` and `estimator` of \
         `[[joint]]` in `quell.toml`.\n\n## Shapers\n\n{}## Estimators\n\n{}",
        table(["name", "what"], shapers),
        table(header, estimators)
    )
}
