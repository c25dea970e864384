//! No information is not health: recordings that say nothing of a model, through every verb that reads one.

mod small;

use assert_cmd::Command;
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde_json::Value;
use small::MANIFEST;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Time, motor position and deformation of a sample, s and rad.
type Row = [f64; 3];

/// A move there and back of a joint that rings.
fn good() -> Vec<Row> {
    let folder = TempDir::new().unwrap();
    let path = small::fleet(folder.path(), 1).remove(0);
    let text = fs::read_to_string(path.join("data.csv")).unwrap();
    let row = |line: &str| -> Row {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        [cells[0], cells[1], cells[2]]
    };
    text.lines().skip(1).map(row).collect()
}

/// The same with other values.
fn with(change: impl Fn(usize, Row) -> Row) -> Vec<Row> {
    let rows = good().into_iter().enumerate();
    rows.map(|(k, row)| change(k, row)).collect()
}

/// Noise of 6 urad: the sum of twelve uniform numbers has the variance 1.
fn noise(sample: usize, seed: u64) -> f64 {
    let mut state = (sample as u64 + 1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(seed.wrapping_mul(0xd1b5_4a32_d192_ed03));
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // The first numbers of neighbouring seeds are alike.
    6e-6 * ((0..20).map(|_| uniform()).skip(8).sum::<f64>() - 6.0)
}

fn write(folder: &Path, rows: &[Row]) {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("recording.toml"), MANIFEST).unwrap();
    let mut text = String::from("time_s,motor_rad,deformation_rad\n");
    for [time, motor, deformation] in rows {
        let cell = |value: &f64| match value.is_nan() {
            true => "nan".to_string(),
            false => format!("{value:?}"),
        };
        writeln!(text, "{time},{},{}", cell(motor), cell(deformation)).unwrap();
    }
    fs::write(folder.join("data.csv"), text).unwrap();
}

/// The output of a run, on both streams, and its exit code.
struct Ran {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn quell(here: &Path, arguments: &str) -> Ran {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.current_dir(here).args(arguments.split_whitespace());
    let output = command.output().unwrap();
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    Ran {
        code: output.status.code(),
        stdout,
        stderr,
    }
}

fn workplace(rows: &[Row]) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("model.toml"), small::MODEL).unwrap();
    write(&folder.path().join("fleet/one"), rows);
    folder
}

/// Recordings that say nothing, what `diagnose` says of each, and what `identify` does.
fn silent() -> Vec<(&'static str, Vec<Row>, &'static str, &'static str)> {
    let still = "nothing vibrates";
    let none = "no mode was found";
    let few = "samples";
    let moved = |rows: usize| good().into_iter().skip(25).take(rows).collect::<Vec<_>>();
    let step = 2e-5;
    vec![
        (
            "zeros",
            with(|_, r| [r[0], 0.0, 0.0]),
            "Nothing moved",
            still,
        ),
        (
            "constants",
            with(|_, r| [r[0], 0.3, -0.1]),
            "Nothing moved",
            still,
        ),
        (
            "tiny",
            with(|_, r| [r[0], 1e-200 * r[1], 1e-200 * r[2]]),
            "Nothing moved",
            still,
        ),
        (
            "rest",
            with(|k, r| [r[0], noise(k, 1), noise(k, 2)]),
            "does not excite the model",
            none,
        ),
        (
            "rest, input known",
            with(|k, r| [r[0], 0.3, noise(k, 3)]),
            "Record a move of at least",
            none,
        ),
        (
            "rest, slow noise",
            with(|k, r| {
                [
                    r[0],
                    0.3,
                    (0..40)
                        .map(|j| 0.9_f64.powi(j as i32) * noise(k + 40 - j, 9))
                        .sum(),
                ]
            }),
            "does not excite the model",
            none,
        ),
        (
            "rest, rounded",
            with(|k, r| [r[0], 0.3, (0.1 * noise(k, 4) / step).round() * step + 0.1]),
            "Nothing moved",
            still,
        ),
        (
            "rest, one step",
            with(|k, r| [r[0], 0.3, if k == 77 { 0.1 + step } else { 0.1 }]),
            "does not excite the model",
            none,
        ),
        (
            "slow",
            with(|k, r| [r[0], 1e-4 * (0.5 * r[0]).sin(), noise(k, 5)]),
            "does not excite the model",
            none,
        ),
        (
            "dead",
            with(|_, r| [r[0], r[1], 0.0]),
            "a dead sensor",
            "a dead sensor",
        ),
        (
            "dead, noisy",
            with(|k, r| [r[0], r[1], noise(k, 6)]),
            "shows nothing but noise",
            none,
        ),
        (
            "huge",
            with(|_, r| [r[0], 1e200 * r[1], 1e200 * r[2]]),
            "which nothing measures",
            "which nothing measures",
        ),
        ("1 row", moved(1), few, few),
        ("2 rows", moved(2), few, few),
        ("4 rows", moved(4), few, few),
        ("20 rows", moved(20), few, few),
        (
            "one time",
            with(|_, r| [0.0, r[1], r[2]]),
            "time repeats",
            "time repeats",
        ),
        (
            "not a number",
            with(|k, r| [r[0], r[1], if k == 100 { f64::NAN } else { r[2] }]),
            "not a finite number",
            "not a finite number",
        ),
    ]
}

#[test]
fn what_says_nothing_is_never_healthy() {
    for (name, rows, diagnosed, identified) in silent() {
        let place = workplace(&rows);
        let here = place.path();
        let ran = quell(here, "diagnose --model model.toml fleet/one");
        let said = format!("{}{}", ran.stdout, ran.stderr);
        assert_eq!(ran.code, Some(2), "{name}: {said}");
        assert!(said.contains(diagnosed), "{name}: {said}");
        sound(&said);
        if let Ok(text) = fs::read_to_string(here.join("out/diagnosis.json")) {
            let diagnosis: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(diagnosis["verdict"], "not_excited", "{name}");
            let page = fs::read_to_string(here.join("out/report.html")).unwrap();
            assert!(page.contains("class=\"verdict bad\""), "{name}");
        }
        let ran = quell(here, "identify fleet/one");
        assert_eq!(ran.code, Some(2), "{name}: {}", ran.stdout);
        assert!(ran.stderr.contains(identified), "{name}: {}", ran.stderr);
        assert!(!here.join("out/identify.html").exists(), "{name}");
        let ran = quell(here, "identify fleet/one --model model.toml");
        assert_eq!(ran.code, Some(2), "{name}: {}", ran.stdout);
    }
}

/// A link that rings on a motor side at rest tells its mode: it is not the motion of the input that counts.
#[test]
fn a_free_decay_says_much() {
    let decay = |r: Row| 1e-3 * (-1.25 * r[0]).exp() * (25.1 * r[0]).cos();
    let place = workplace(&with(|k, r| [r[0], 0.3, decay(r) + noise(k, 7)]));
    let here = place.path();
    let ran = quell(here, "diagnose --model model.toml fleet/one --json");
    let told: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(
        (ran.code, &told["verdict"]),
        (Some(0), &"no_mismatch".into())
    );
    let ran = quell(here, "identify fleet/one --json");
    let told: Value = serde_json::from_str(&ran.stdout).unwrap();
    let mode = &told["recordings"][0]["modes"][0];
    let frequency = mode["frequency_hz"].as_f64().unwrap();
    assert!((frequency - 4.0).abs() < 0.02, "{frequency}");
}

/// The moves judge nothing where what was held out is a rest.
#[test]
fn a_rest_judges_nothing() {
    let place = workplace(&good());
    let here = place.path();
    write(&here.join("rest"), &with(|k, r| [r[0], 0.3, noise(k, 8)]));
    write(&here.join("dead"), &with(|_, r| [r[0], 0.3, 0.1]));
    let held_out = "diagnose --model model.toml fleet/one --held-out";
    let ran = quell(here, &format!("{held_out} rest --out a"));
    let said = "The recording that was held out does not excite the model";
    assert!(ran.stdout.starts_with(said), "{}{}", ran.stdout, ran.stderr);
    assert_eq!(ran.code, Some(2));
    let ran = quell(here, &format!("{held_out} dead --out b"));
    assert_eq!(ran.code, Some(2));
    let ran = quell(here, "score model.toml dead");
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("nothing moves in"), "{}", ran.stderr);
}

/// Noise is no machine at work, white or coloured (`x_k = a x_{k-1} + e_k`), whatever its draw: strong evidence for a mode
/// is rarer than one draw in a hundred.
#[test]
fn noise_at_rest_has_no_modes() {
    let place = TempDir::new().unwrap();
    let rows = good();
    for colour in [0.0, 0.9] {
        let has_modes = |seed: &u64| {
            let mut random = ChaCha8Rng::seed_from_u64(*seed);
            let mut value = 0.0;
            let noisy: Vec<Row> = rows
                .iter()
                .map(|r| {
                    value = colour * value + 6e-6 * random.sample::<f64, _>(StandardNormal);
                    [r[0], 0.3, value]
                })
                .collect();
            write(&place.path().join("noise"), &noisy);
            quell(place.path(), "identify noise").code != Some(2)
        };
        let told: Vec<u64> = (0..100).filter(has_modes).collect();
        assert!(
            told.len() <= 2,
            "of 100 draws of colour {colour} these have modes: {told:?}"
        );
    }
}

/// A fleet with dead and idle machines does not look healthy.
#[test]
fn a_fleet_tells_who_says_nothing() {
    let place = workplace(&good());
    let here = place.path();
    write(&here.join("fleet/dead"), &with(|_, r| [r[0], r[1], 0.0]));
    write(
        &here.join("fleet/idle"),
        &with(|k, r| [r[0], 0.3, noise(k, 2)]),
    );
    write(&here.join("fleet/off"), &with(|_, r| [r[0], 0.0, 0.0]));
    small::poison(&here.join("fleet"));
    let ran = quell(
        here,
        "diagnose --batch --model model.toml fleet --out results",
    );
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    let line = |name: &str| {
        let mut lines = ran.stdout.lines();
        let found = lines.find(|line| line.starts_with(name));
        found
            .unwrap_or_else(|| panic!("{}", ran.stdout))
            .to_string()
    };
    assert!(line("one").contains("no_mismatch"), "{}", ran.stdout);
    assert!(line("dead").contains("set aside"), "{}", ran.stdout);
    for name in ["idle", "off"] {
        let cells = line(name);
        let cells: Vec<&str> = cells.split_whitespace().collect();
        assert_eq!(cells, [name, "not_excited", "-", "-", "-"]);
    }
    for words in [
        "no diagnosis of 2 of 5 recordings",
        "2 of 5 recordings say nothing about the model (not_excited)",
    ] {
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
}

/// The faults that a recording may have.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Constant { column: usize, value: f64 },
    Scale { column: usize, power: i32 },
    Offset { column: usize, power: i32 },
    Keep { rows: usize },
    Clip { column: usize, share: f64 },
    Round { column: usize, power: i32 },
    Noise { column: usize },
    NaN { column: usize, row: usize },
    Swap,
}

fn fault() -> impl Strategy<Value = Fault> {
    let column = 1..3_usize;
    prop_oneof![
        (
            column.clone(),
            prop::sample::select(vec![0.0, 0.3, -1e9, 1e-300])
        )
            .prop_map(|(column, value)| Fault::Constant { column, value }),
        (column.clone(), -320..300_i32).prop_map(|(column, power)| Fault::Scale { column, power }),
        (column.clone(), -6..30_i32).prop_map(|(column, power)| Fault::Offset { column, power }),
        (1..60_usize).prop_map(|rows| Fault::Keep { rows }),
        (column.clone(), -1.0..1.0).prop_map(|(column, share)| Fault::Clip { column, share }),
        (column.clone(), -8..2_i32).prop_map(|(column, power)| Fault::Round { column, power }),
        column.clone().prop_map(|column| Fault::Noise { column }),
        (column, 0..200_usize).prop_map(|(column, row)| Fault::NaN { column, row }),
        Just(Fault::Swap),
    ]
}

impl Fault {
    fn on(self, rows: &mut Vec<Row>) {
        if let Self::Keep { rows: count } = self {
            rows.truncate(count);
        }
        for (k, row) in rows.iter_mut().enumerate() {
            match self {
                Self::Constant { column, value } => row[column] = value,
                Self::Scale { column, power } => row[column] *= 10_f64.powi(power),
                Self::Offset { column, power } => row[column] += 10_f64.powi(power),
                Self::Clip { column, share } => row[column] = row[column].min(0.01 * share),
                Self::Round { column, power } => {
                    let step = 10_f64.powi(power);
                    row[column] = (row[column] / step).round() * step;
                }
                Self::Noise { column } => row[column] = noise(k, column as u64),
                Self::NaN { column, row: bad } if bad == k => row[column] = f64::NAN,
                Self::Swap => row.swap(1, 2),
                Self::Keep { .. } | Self::NaN { .. } => {}
            }
            // A file of infinities is another test's.
            if row.iter().any(|value| value.is_infinite()) {
                *row = [row[0], 0.0, 0.0];
            }
        }
    }
}

/// No number that is none, and none of a hundred digits.
fn sound(text: &str) {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let words: Vec<&str> = text.split(|c| !is_word(c)).collect();
    for wrong in ["NaN", "inf", "Infinity"] {
        assert!(!words.contains(&wrong), "{wrong} in {text}");
    }
    let runs = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let longest = runs.max_by_key(|run| run.len()).unwrap_or("");
    assert!(longest.len() <= 23, "{longest} in {text}");
}

/// A page without its styles and its program, but with the curves' data.
fn page(html: &str) -> String {
    let parts = [
        ("<style>", "</style>"),
        ("<!--", "-->"),
        ("<script>", "</script>"),
    ];
    let without = |text: String, (from, to): (&str, &str)| {
        let mut pieces = text.split(from);
        let first = pieces.next().unwrap_or("").to_string();
        let after = pieces.map(|piece| piece.split_once(to).map_or("", |(_, after)| after));
        first + &after.collect::<String>()
    };
    parts.into_iter().fold(html.to_string(), without)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Each verb refuses a recording in words, or prints numbers that are numbers, whatever it holds.
    #[test]
    fn no_verb_prints_a_number_that_is_none(faults in prop::collection::vec(fault(), 1..4)) {
        let mut rows = good();
        faults.iter().for_each(|fault| fault.on(&mut rows));
        let place = workplace(&rows);
        let here = place.path();
        for command in [
            "inspect fleet/one",
            "inspect fleet/one --json",
            "score model.toml fleet/one",
            "score model.toml fleet/one --json",
            "simulate model.toml fleet/one --out p.csv",
            "identify fleet/one --model model.toml",
            "identify fleet/one --json",
            "diagnose --model model.toml fleet/one",
            "diagnose --batch --model model.toml fleet --out results",
        ] {
            let ran = quell(here, command);
            prop_assert!(matches!(ran.code, Some(0 | 2)), "{command}: {}", ran.stderr);
            sound(&ran.stdout);
            sound(&ran.stderr);
        }
        for file in ["out/report.html", "out/identify.html"] {
            if let Ok(html) = fs::read_to_string(here.join(file)) {
                sound(&page(&html));
            }
        }
        if let Ok(text) = fs::read_to_string(here.join("p.csv")) {
            sound(&text);
        }
        if let Ok(text) = fs::read_to_string(here.join("out/diagnosis.json")) {
            sound(&text);
            let read = serde_json::from_str::<quell::diagnosis::Diagnosis>(&text);
            prop_assert!(read.is_ok(), "{read:?}");
        }
    }
}
