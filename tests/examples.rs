//! The programs in `examples/`: each runs, and says what it is about.

use std::path::Path;
use std::process::Command;

#[test]
fn each_runs_and_says_what_it_is_about() {
    let said = [
        ("shape", "0.52360 rad"),
        ("simulate", "adaptive_next leaves 0.0"),
        ("identify", "8.1"),
        ("diagnose", "Coulomb friction"),
    ];
    let folder = Path::new(env!("CARGO_BIN_EXE_quell")).with_file_name("examples");
    for (name, expected) in said {
        let output = Command::new(folder.join(name)).output();
        // `cargo test` builds the programs, `cargo test --test examples` alone does not.
        let output = output.unwrap_or_else(|error| {
            panic!("{name}: {error}; cargo build --release --features full --examples")
        });
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{name}: {output:?}");
        assert!(text.contains(expected), "{name}: {text}");
    }
}

/// Twenty lines each, so that they are read at a glance; what stands in for a recording is not counted.
#[test]
fn each_is_short() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for name in ["shape", "simulate", "identify", "diagnose"] {
        let text = std::fs::read_to_string(folder.join(name).with_extension("rs")).expect(name);
        let main = text.split("fn main()").nth(1).expect(name);
        let main = main.split("\n}\n").next().expect(name);
        assert!(main.lines().count() <= 25, "{name}: {main}");
    }
}
