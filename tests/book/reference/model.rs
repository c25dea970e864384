//! `model.toml`.

use super::fields::Sources;
use super::{codes, table};
use quell::effects::Units;
use quell::model::{KINDS, Key, Kind};

/// The head of the page.
const HEAD: &str = "# The model file `model.toml`\n\n`quell diagnose --model FILE`, `quell score FILE RECORDING` and `quell \
     simulate FILE RECORDING` read it. It says what is believed. Units are SI.\n\n\
     ```toml,model\n\
     kind = \"flexible_joint\"         # which equation: a name of the table below\n\
     natural_frequency_hz = 8.2      # a key: a number, refitted by a diagnosis\n\
     damping_ratio = { value = 0.06, std = 0.02, bounds = [0.005, 0.3] }   # how well it is known\n\
     lever_arm_m = { value = 1.8, fixed = true }                           # not refitted\n\
     tip_height_m = 0.9\n\n\
     [[effect]]                      # any number of them\n\
     name = \"backlash\"               # a name of the catalogue\n\
     place = \"transmission\"          # the first of its places that the kind has, where it is left out\n\
     [effect.parameters]\n\
     gap = 2e-4                      # rad; or a table with value, std, bounds, fixed\n\
     # damping_in_gap = 0.3          # share of the damper that acts in the gap, too: oil\n\
     ```\n\n\
     A key or a parameter is a number, or a table with `value`, `std` (one standard deviation), `bounds` and `fixed`. A \
     diagnosis refits those that are not `fixed`. It refits an optional key only where the file gives it, and one of \
     which the tables below say \"not refitted\" only where the file gives a `std`.\n\n\
     The names of effects, places and parameters are [in the catalogue](effects.md). `input_hold = \"zero_order\"`, \
     `\"linear\"` or `\"spline\"` says what the input does between its samples. Without it `diagnose` tries both for a \
     force and for the command of a position loop, and says which one explains the recording better.\n\n## Kinds\n\n";

pub fn page() -> String {
    let mut page = format!("{HEAD}{}", kinds());
    let sources = Sources::of(&[
        "crates/model/src/flexible_joint.rs",
        "crates/model/src/rigid_axis.rs",
        "crates/model/src/oscillator.rs",
        "crates/model/src/two_mass.rs",
        "crates/model/src/inverse_dynamics.rs",
    ]);
    let equations = sources.constants("Kind");
    assert_eq!(
        equations.len(),
        KINDS.len(),
        "a kind in a file that is not named here"
    );
    for (kind, equation) in KINDS.iter().zip(equations) {
        page += &keys(kind, &equation);
    }
    page
}

/// Inputs, outputs and keys of each kind.
fn kinds() -> String {
    let all = KINDS.iter().map(|kind| {
        let (needed, optional): (Vec<&Key>, Vec<&Key>) =
            kind.keys.iter().partition(|key| key.default.is_none());
        let names = |keys: Vec<&Key>| codes(keys.iter().map(|key| key.name));
        let inputs = codes(kind.inputs.iter().map(|role| role.name()));
        let outputs = codes(kind.outputs.iter().map(|role| role.name()));
        [
            format!("`{}`", kind.name),
            inputs,
            outputs,
            names(needed),
            names(optional),
        ]
    });
    table(["kind", "in", "out", "needed keys", "optional keys"], all)
}

fn keys(kind: &Kind, equation: &str) -> String {
    let first = kind.keys[0].name;
    let units = Units {
        force: "N".into(),
        position: "m".into(),
        input: "input".into(),
        reference: "input".into(),
    };
    let rows = kind.keys.iter().map(|key| {
        let default = key
            .default
            .map_or("needed".into(), |value| value.to_string());
        let belief = match (key.belief, key.range.0 > 0.0) {
            (0.0, _) => "not refitted".to_string(),
            (width, true) => format!("a factor of {:.3}", width.exp()),
            (width, false) => width.to_string(),
        };
        let unit = key.quantity.unit(&units);
        let (low, high) = key.range;
        [
            format!("`{}`", key.name),
            unit,
            default,
            format!("{low:e} to {high:e}"),
            belief,
        ]
    });
    let header = [
        "key",
        "unit on a linear axis",
        "default",
        "range",
        "one standard deviation, if none is given",
    ];
    format!(
        "## `{}` by `{first}`\n\n{equation}\n\n{}",
        kind.name,
        table(header, rows)
    )
}
