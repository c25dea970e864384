//! `quell serve` as a user types it: what it prints of its configuration.

use std::path::Path;
use std::process::Command;

use quell::service::config::{Config, Overrides, listed};

fn load(folder: &Path, text: &str) -> Result<Config, String> {
    let file = folder.join("quell.toml");
    std::fs::write(&file, text).expect("a file");
    Config::load(Some(&file), &Overrides::default()).map_err(|error| error.to_string())
}

#[test]
fn the_printed_configuration_is_one_and_changes_nothing() {
    let output = Command::new(assert_cmd::cargo::cargo_bin!("quell"))
        .args(["serve", "--print-config"])
        .output()
        .expect("it starts");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(text, listed());
    let folder = tempfile::tempdir().expect("a folder");
    let printed = load(folder.path(), &text).expect("it is a configuration");
    let default = Config::load(None, &Overrides::default()).expect("defaults");
    assert_eq!(printed.period, default.period);
    assert_eq!(printed.http, default.http);
    assert_eq!(printed.watchdog, default.watchdog);
    assert_eq!(printed.recording, default.recording);
    assert_eq!(printed.zenoh, default.zenoh);
    assert_eq!(printed.joints.len(), default.joints.len());
    for key in ["following_error_deg", "rate_hz", "timeout_s", "server"] {
        assert!(text.contains(&format!("{key} =")), "{key}: {text}");
    }
    // Each key has its sentence before it.
    let lines: Vec<_> = text.lines().collect();
    for pair in lines.windows(2) {
        let is_key = pair[1].contains(" =") && !pair[1].starts_with("# Every");
        assert!(!is_key || pair[0].len() > 4, "{pair:?}");
    }
}

/// A list of values that is printed is the one that is taken, and what is said to be needed is needed.
#[test]
fn the_printed_names_are_those_that_are_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = listed();
    assert!(
        text.contains("(needed in each [[joint]])\n# name ="),
        "{text}"
    );
    for (table, key, head) in [
        ("[service]", "robot", "[service]\n"),
        ("[[joint]]", "shaper", "[[joint]]\nname = \"a\"\n"),
        ("[[joint]]", "estimator", "[[joint]]\nname = \"a\"\n"),
    ] {
        let (_, keys) = text.split_once(&format!("{table}\n")).expect("the table");
        let lines: Vec<_> = keys
            .lines()
            .map(|line| line.trim_start_matches("# "))
            .collect();
        let own = |pair: &&[&str]| pair[1].starts_with(&format!("{key} ="));
        let pair = lines.windows(2).find(own).expect("the key");
        let (_, names) = pair[0].split_once("One of ").expect("a list");
        for name in names.trim_end_matches('.').split(", ") {
            let taken = load(folder.path(), &format!("{head}{key} = {name:?}\n"));
            assert_eq!(taken.err(), None, "{key} = {name}");
        }
    }
}

/// A range that is printed is the one that is checked: its ends are taken, and what is beyond is refused.
#[test]
fn the_printed_ranges_are_those_that_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = listed();
    let (mut table, mut range, mut checked) = (String::new(), None, 0);
    for line in text.lines() {
        let bare = line.trim_start_matches("# ");
        if bare.starts_with('[') {
            table = bare.into();
        }
        let found = line.rsplit_once(" [").and_then(|(_, end)| {
            let (low, rest) = end.trim_end_matches(']').split_once(" to ")?;
            let high = rest.split(' ').next()?;
            Some([low.parse::<f64>().ok()?, high.parse::<f64>().ok()?])
        });
        if let Some(found) = found {
            range = Some(found);
            continue;
        }
        let (Some([low, high]), Some((key, default))) = (range.take(), bare.split_once(" ="))
        else {
            continue;
        };
        let number = |value: f64| match default.contains('.') || default.is_empty() {
            true => format!("{value:?}"),
            false => format!("{value:.0}"),
        };
        let name = if table == "[[joint]]" {
            "name = \"a\"\n"
        } else {
            ""
        };
        let with = |value| {
            load(
                folder.path(),
                &format!("{table}\n{name}{key} = {}\n", number(value)),
            )
        };
        for end in [low, high] {
            let refused = with(end).err().unwrap_or_default();
            assert!(!refused.contains(key), "{key} = {end}: {refused}");
        }
        for beyond in [low - low.abs().max(1.0) * 0.5 - 0.5, high * 1.5 + 1.0] {
            assert!(with(beyond).is_err(), "{table} {key} = {beyond}");
        }
        checked += 1;
    }
    assert_eq!(checked, 10, "{text}");
}

/// A misspelt key or table is refused in a line, with what was probably meant.
#[test]
fn a_configuration_is_refused_with_line_key_and_what_was_meant() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        (
            "[tick]\nratehz = 500\n",
            ":2: unknown key \"ratehz\"; did you mean \"rate_hz\"?",
        ),
        (
            "[tik]\nrate_hz = 500\n",
            ":1: unknown key \"tik\"; did you mean \"tick\"?",
        ),
        (
            "[tick]\nrate_hz = \"500\"\n",
            ":2: tick.rate_hz = \"500\": it must be a number",
        ),
        ("[[joint]]\nshaper = \"zv\"\n", "missing key `name`"),
        (
            "[tick]\nrate_hz = 5\n",
            ":2: tick.rate_hz = 5: it must be from 250 to 4000",
        ),
        (
            "[joint]\nname = \"a\"\n",
            ":1: joint: it must be a list of tables, each headed [[joint]]",
        ),
        (
            "[service]\nrobot = \"upd\"\n",
            ":2: service.robot = \"upd\": it must be one of embedded, udp, zenoh; did you mean \"udp\"?",
        ),
        (
            "[[joint]]\nname = \"a\"\n\ndamping_ratio = 2\n",
            ":4: joint[1].damping_ratio = 2: it must be 0 or more, below 1",
        ),
        (
            "[[joint]]\nname = \"a\"\nfrequency_hz = -1\n",
            ":3: joint[1].frequency_hz = -1: it must be finite and above 0",
        ),
        (
            "[[joint]]\nname = \"a\"\nfrequency_hz = 0.0001\n",
            ":3: joint[1].frequency_hz = 0.0001: it must be at least 0.2 Hz",
        ),
        (
            "[[joint]]\nname = \"a\"\nshaper = \"umzv\"\n",
            ":3: joint[1].shaper = \"umzv\": it must be a shaper of positive impulses",
        ),
        (
            "[[joint]]\nname = \"a\"\nencoder_resolution_deg = 90\n",
            ":3: joint[1].encoder_resolution_deg = 90: it must be from 0 to 60",
        ),
        (
            "[[joint]]\nname = \"a\"\njerk_deg_s3 = 0\n",
            ":3: joint[1].jerk_deg_s3 = 0: it must be above 0 and at most 1e9",
        ),
        (
            "[[joint]]\nname = \"a\"\ndamping_ratio=.05\n",
            ":3:15: damping_ratio = .05: a number has a digit before its point, as 0.5",
        ),
        (
            "[tick]\nrate_hz = 500\nrate_hz = 600\n",
            ":3:1: rate_hz = 600: this key stands a second time",
        ),
        (
            "[[joint]]\nname = \"a\"\nrange_deg = [-90, 0, 90]\n",
            ":3: joint[1].range_deg = [-90, 0, 90]: it must be a list of 2 numbers",
        ),
    ];
    for (text, words) in cases {
        let refused = load(folder.path(), text).err().unwrap_or_default();
        assert!(refused.contains(words), "{refused}");
        assert_eq!(refused.lines().count(), 1, "{refused}");
    }
}

/// The range of a robot that is not simulated is not known: a default is told as one.
#[test]
fn a_range_that_nobody_gave_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for (robot, range, assumed) in [
        ("udp", "", true),
        ("udp", "range_deg = [-90.0, 90.0]\n", false),
        ("embedded", "", false),
    ] {
        let text = format!("[service]\nrobot = \"{robot}\"\n[[joint]]\nname = \"a\"\n{range}");
        let joint = &load(folder.path(), &text).expect("a configuration").joints[0];
        assert_eq!(joint.range_assumed, assumed, "{text}");
    }
    assert!(listed().contains("Where absent -360 and 360"));
}
