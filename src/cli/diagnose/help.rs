//! The text of the help after the options.

use crate::effects::{Catalogue, LEARNED};

/// Number of columns of a line.
const WIDTH: usize = 100;

/// Examples.
const EXAMPLES: &str = "\
Examples:
  quell diagnose --model model.toml arm7
  quell diagnose --model model.toml monday tuesday --held-out friday --out friday-report
  quell diagnose --model model.toml arm7 --json
  quell diagnose --robot arm.urdf six_axes --out arm-report
  quell diagnose --robot arm.urdf --model models six_axes
  quell diagnose --batch --model model.toml fleet --out out
";

/// What the help says of a queue, in a program that has one: an example and its meaning.
const QUEUE: [&str; 2] = match cfg!(feature = "nats") {
    true => [
        "  quell diagnose --queue nats://host:4222 submit --model model.toml fleet\n",
        "\
With --queue they are only put in: `quell work` does them, `quell results` shows what came out.

",
    ],
    false => ["", ""],
};

/// Model and recordings.
const INPUT: &str = "
The model says what is believed, such as
  kind = \"flexible_joint\"
  natural_frequency_hz = 8.2
  damping_ratio = 0.06
  lever_arm_m = 1.8
  tip_height_m = 0.9
Its parameters are refitted first, and what is still missing is looked for in the catalogue of \
effects. Without --held-out every third stretch of three periods judges what the rest was fitted to.

With --robot each channel names its joint, and every joint is diagnosed: with gravity, the motion of \
the other joints and its own inertia as the description says them. What the robot carries and which \
joints are coupled beside the description is looked for first, where torques were measured.

With --batch each recording is diagnosed by itself, and a folder stands for the recordings below it; \
what has its result already is not done again.

";

/// Verdicts and what is written.
const OUTPUT: &str = "\
Verdicts: no_mismatch, named, ambiguous (several explanations fit alike), \
partly_explained, unexplained, not_excited (the recording cannot contradict the model: the exit code \
is 2, and what to record is told). The folder of --out gets report.html, diagnosis.json and \
model.toml with the physics in it, which `quell simulate` and `quell score` run.";

/// Examples and verdicts.
pub fn help() -> String {
    let [example, meaning] = QUEUE;
    [EXAMPLES, example, INPUT, meaning, OUTPUT].concat()
}

/// The same, and the effects of a catalogue at each place.
pub fn long_help(catalogue: Catalogue) -> String {
    let mut help = help() + "\n\nThe catalogue:\n";
    list(&mut help, catalogue);
    help += "\nLaws of learned shape, which the model may have:\n";
    list(&mut help, Catalogue(LEARNED));
    help
}

/// Effects at each place.
fn list(help: &mut String, catalogue: Catalogue) {
    for (place, names) in catalogue.by_place() {
        if names.is_empty() {
            continue;
        }
        let mut line = format!("  {:13}", place.name());
        for (index, name) in names.iter().enumerate() {
            let end = if index + 1 == names.len() { "" } else { "," };
            if line.len() + 1 + name.len() + end.len() > WIDTH {
                *help += &format!("{line}\n");
                line = " ".repeat(15);
            }
            line += &format!(" {name}{end}");
        }
        *help += &format!("{line}\n");
    }
}
