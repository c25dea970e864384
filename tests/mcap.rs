//! Recordings as MCAP files: what is written is read back, by others too, and what is damaged is refused.

use assert_cmd::Command;
use proptest::prelude::*;
use quell::recording::health::{health, remarks};
use quell::recording::{McapFile, McapWriter, Recording, RecordingError, Role};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;

/// 2023-11-14 22:13:20 UTC.
const ORIGIN: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;

/// A vector of a role, and a role that only a `Float64` carries.
const SAMPLES: [(Role, usize); 7] = [
    (Role::MotorPosition, 1),
    (Role::LinkPosition, 1),
    (Role::TipPosition, 3),
    (Role::LinkVelocity, 1),
    (Role::LinkAcceleration, 1),
    (Role::TipAcceleration, 3),
    (Role::Torque, 1),
];

fn values(tick: i64, role: Role, count: usize) -> Vec<f64> {
    let value =
        |column: usize| (tick as f64 * 0.01 + column as f64).sin() / (1.0 + role as usize as f64);
    (0..count).map(value).collect()
}

/// Commands at 1 kHz and each sensor at 250 Hz with its own phase, of `ticks` milliseconds.
fn write(writer: &mut McapWriter, ticks: i64) -> Result<(), RecordingError> {
    for tick in 0..ticks {
        let t = tick as f64 / 1e3;
        writer.write_command(t, "hip", t.sin(), t.cos(), -t.sin())?;
        for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
            if tick % 4 == index as i64 % 4 {
                // The bus delays by 2 ms what the sensor stamped.
                let stamp = (tick - 2) as f64 / 1e3;
                writer.write_sample(t, "hip", role, stamp, &values(tick, role, count))?;
            }
        }
    }
    Ok(())
}

/// A finished file of 3 s, made once.
fn whole() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("run.mcap");
        let mut writer = McapWriter::create_at(&path, &["hip"], ORIGIN).unwrap();
        write(&mut writer, 3000).unwrap();
        writer.finish().unwrap();
        std::fs::read(path).unwrap()
    })
}

fn save(folder: &TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn what_is_written_is_read_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let recording = Recording::from_path(save(&folder, whole())).unwrap();
    assert_eq!(recording.name, "run");
    assert_eq!(recording.channels.len(), 1 + SAMPLES.len());
    let command = recording.channel(Role::CommandPosition).unwrap();
    let times: Vec<_> = (0..3000).map(|tick| f64::from(tick) / 1e3).collect();
    assert_eq!(command.time, times);
    assert_eq!(
        command.columns[0],
        times.iter().map(|t| t.sin()).collect::<Vec<_>>()
    );
    for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
        let channel = recording.channel(role).unwrap();
        let ticks: Vec<i64> = (0..3000)
            .filter(|tick| tick % 4 == index as i64 % 4)
            .collect();
        let times: Vec<_> = ticks.iter().map(|tick| (tick - 2) as f64 / 1e3).collect();
        assert_eq!(channel.time, times, "{role}");
        assert!(channel.has_usual_unit(), "{role}");
        for (row, tick) in ticks.iter().enumerate() {
            let columns: Vec<_> = channel.columns.iter().map(|column| column[row]).collect();
            assert_eq!(columns, values(*tick, role, count), "{role}");
        }
    }
}

#[test]
fn a_file_that_is_cut_is_read_up_to_the_cut() {
    let folder = TempDir::new().unwrap();
    let all = Recording::from_path(save(&folder, whole())).unwrap();
    let full = &all.channel(Role::CommandPosition).unwrap().time;
    let mut state = 1_u64;
    for _ in 0..50 {
        // A step of Knuth's MMIX generator.
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let cut = (state >> 33) as usize % whole().len();
        let path = save(&folder, &whole()[..cut]);
        // What is lost is one chunk, of a quarter of a second.
        let least = cut as f64 / whole().len() as f64 * 3.0 - 0.3;
        let part = match Recording::from_path(&path) {
            Ok(part) => part,
            Err(error) => {
                assert!(least < 0.0, "{cut}: {error}");
                continue;
            }
        };
        let part = &part.channel(Role::CommandPosition).unwrap().time;
        assert_eq!(part[..], full[..part.len()], "{cut}");
        assert!(
            part[part.len() - 1] >= least,
            "{cut}: {} s",
            part[part.len() - 1]
        );
        // A cut in the index behind the messages costs nothing, and need not be known.
        if part.len() < full.len() {
            let file = McapFile::open(&path).unwrap();
            assert_eq!(file.cut().unwrap().length, cut);
        }
    }
}

#[test]
fn a_writer_that_is_killed_leaves_what_it_flushed() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("live.mcap");
    let mut writer = McapWriter::create_at(&path, &["hip"], ORIGIN).unwrap();
    write(&mut writer, 1500).unwrap();
    // What another process finds on the disk, nothing finished.
    let seen = save(&folder, &std::fs::read(&path).unwrap());
    let time = &Recording::from_path(&seen).unwrap().channels[0].time;
    assert!(time[time.len() - 1] >= 1.2, "{}", time[time.len() - 1]);
    writer.flush().unwrap();
    let seen = save(&folder, &std::fs::read(&path).unwrap());
    assert_eq!(
        Recording::from_path(&seen).unwrap().channels[0].time.len(),
        1500
    );
}

/// Runs a script of `tests/ros2`; none where its packages cannot be installed.
fn python(script: &str, argument: &Path) -> Option<Vec<u8>> {
    let run = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ros2/run.sh");
    let venv = std::env::var_os("QUELL_ROS2_VENV").map_or(
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("ros2-venv"),
        PathBuf::from,
    );
    let output = std::process::Command::new("sh")
        .args([run.as_os_str(), script.as_ref(), argument.as_os_str()])
        .env("QUELL_ROS2_VENV", venv)
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(77) {
        println!("{words}");
        return None;
    }
    assert!(output.status.success(), "{words}");
    Some(output.stdout)
}

/// A number as the other readers print it, so that no digit is lost on the way.
fn bits(number: f64) -> i64 {
    i64::from_le_bytes(number.to_le_bytes())
}

#[test]
fn other_readers_read_every_message() {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, whole());
    let Some(read) = python("read.py", &path) else {
        return;
    };
    let read: Value = serde_json::from_slice(&read).unwrap();
    let file = McapFile::open(&path).unwrap();
    for reader in ["rosbags", "mcap"] {
        let rows = read[reader].as_array().unwrap();
        let of = |topic: &str| {
            rows.iter()
                .filter(|row| row[0] == *topic)
                .collect::<Vec<_>>()
        };
        assert_eq!(file.topics().len(), 2 + SAMPLES.len());
        for topic in file.topics() {
            assert_eq!(
                of(&topic.name).len(),
                topic.messages,
                "{reader}: {}",
                topic.name
            );
        }
        for (tick, row) in (0..).zip(of("/quell/hip/command")) {
            let (t, now) = (tick as f64 / 1e3, ORIGIN + tick * MS);
            let values = serde_json::json!([bits(t.sin()), bits(t.cos())]);
            assert_eq!((&row[1], &row[3]), (&now.into(), &now.into()), "{reader}");
            assert_eq!((&row[4][0], &row[5]), (&"hip".into(), &values), "{reader}");
        }
        for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
            let topic = match role {
                Role::MotorPosition => "/joint_states".to_owned(),
                _ => format!("/quell/hip/{role}"),
            };
            for (row, sample) in of(&topic).into_iter().zip(0..) {
                let tick = 4 * sample + index as i64 % 4;
                assert_eq!(row[1], ORIGIN + tick * MS, "{reader}: {topic}");
                let stamp = ORIGIN + (tick - 2) * MS;
                let told = [&row[2], &row[3]]
                    .into_iter()
                    .filter(|v| **v != 0 && !v.is_null());
                for time in told {
                    assert_eq!(*time, stamp, "{reader}: {topic}");
                }
                let values = values(tick, role, count).into_iter().map(bits);
                let values = serde_json::json!(values.collect::<Vec<_>>());
                assert_eq!(row[5], values, "{reader}: {topic}");
            }
        }
    }
}

/// Roles and units are borrowed for what the fields hold; the test is of the fields.
const OTHERS: &str = r#"
name = "other writers"
[[channel]]
role = "tip_acceleration"
topic = "/imu"
fields = ["linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"]
unit = "m/s^2"
[[channel]]
role = "deformation"
topic = "/array"
field = "data[1]"
unit = "rad"
[[channel]]
role = "motor_position"
topic = "/arm"
field = "angles[knee]"
unit = "rad"
rows = [10, 20]
[[channel]]
role = "link_position"
topic = "/arm"
field = "axes[2].angle"
time = "log_time"
unit = "deg"
[[channel]]
role = "tip_position"
topic = "/arm"
fields = ["tip[0]", "counters[1]", "axes[1].counts"]
unit = "m"
"#;

#[test]
fn the_files_of_other_writers_are_read_by_their_definitions() {
    let folder = TempDir::new().unwrap();
    if python("write.py", folder.path()).is_none() {
        return;
    }
    for compression in ["none", "lz4", "zstd"] {
        let file = format!("file = \"{compression}.mcap\"\nrole");
        let manifest = folder.path().join(format!("{compression}.toml"));
        std::fs::write(&manifest, OTHERS.replace("role", &file)).unwrap();
        let recording = Recording::from_path(&manifest).unwrap();
        let channel = |role| recording.channel(role).unwrap();
        let tip = channel(Role::TipAcceleration);
        let arm = channel(Role::TipPosition);
        let link = channel(Role::LinkPosition);
        for k in 0..500 {
            let t = k as f64;
            // Stamps are 3 ms before the log, from which time counts.
            assert_eq!(tip.time[k], (10 * k as i64 - 3) as f64 / 1e3);
            assert_eq!(tip.columns[2][k], 2.0 * (t + 0.5));
            assert_eq!(channel(Role::Deformation).columns[0][k], -t / 8.0);
            assert_eq!(link.time[k], t / 1e2);
            assert_eq!(
                link.columns[0][k],
                (t + 2.0) / 4.0 * std::f64::consts::PI / 180.0
            );
            assert_eq!(arm.columns[0][k], t / 2.0);
            assert_eq!(arm.columns[1][k], 2_f64.powi(40) + t);
            assert_eq!(arm.columns[2][k], 1.0 - t);
        }
        let knee: Vec<_> = (10..20).map(|k| -f64::from(k) / 16.0).collect();
        assert_eq!(
            channel(Role::MotorPosition).columns,
            [knee],
            "{compression}"
        );
    }
}

#[test]
fn what_is_asked_for_in_vain_is_told_with_what_is_there() {
    let folder = TempDir::new().unwrap();
    save(&folder, whole());
    let entry = "name = \"x\"\n[[channel]]\nrole = \"motor_position\"\nfile = \"run.mcap\"\nunit = \"rad\"\n";
    let (states, column) = ("topic = \"/joint_states\"\n", "column = \"q\"\n");
    let cases = [
        (
            "field = \"position[0]\"\n".into(),
            "recording.toml:3: topic: an MCAP file needs topic",
        ),
        (format!("{states}{column}"), "field or fields"),
        (states.into(), "give either field"),
        (
            "topic = \"/joint\"\nfield = \"x\"\n".into(),
            "no such topic; the topics are: /quell/hip/command",
        ),
        (
            format!("{states}field = \"positon[0]\"\n"),
            "there is no field \"positon\"; its numbers are: header.stamp.sec",
        ),
        (
            format!("{states}field = \"position\"\n"),
            "say which, as in position[0]",
        ),
        (format!("{states}field = \"position[1]\"\n"), "byte"),
        (
            format!("{states}field = \"position[knee]\"\n"),
            "the names are: hip",
        ),
        (
            format!("{states}field = \"header.frame_id\"\n"),
            "it is no number",
        ),
        (
            format!("{states}field = \"header.stamp.sec.x\"\n"),
            "there is nothing in a number",
        ),
        (
            format!("{states}field = \"effort[0]\"\n"),
            "topic \"/joint_states\": field \"effort[0]\": it has 0 elements",
        ),
        (
            format!("{states}field = \"position[0]\"\ntime = \"stamp\"\n"),
            "there is no field \"stamp\"",
        ),
    ];
    for (lines, word) in cases {
        let path = folder.path().join("recording.toml");
        std::fs::write(&path, format!("{entry}{lines}")).unwrap();
        let error = Recording::from_path(&path).unwrap_err().to_string();
        assert!(error.contains(word), "{lines}: {error}");
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("run.mcap");
    let mut writer = McapWriter::create_at(&path, &["hip"], ORIGIN).unwrap();
    let position = Role::MotorPosition;
    let results = [
        writer.write_sample(0.0, "knee", position, 0.0, &[1.0]),
        writer.write_sample(0.0, "hip", position, 0.0, &[f64::NAN]),
        writer.write_sample(0.0, "hip", position, 0.0, &[1.0, 2.0, 3.0]),
        writer.write_sample(0.0, "hip", position, -2e9, &[1.0]),
        writer.write_command(f64::INFINITY, "hip", 0.0, 0.0, 0.0),
        McapWriter::create(&folder.path().join("no/run.mcap"), &[]).map(|_| ()),
    ];
    let words = ["\"knee\"", "NaN", "3 values", "1970", "inf", "no such file"];
    for (result, word) in results.into_iter().zip(words) {
        let error = result.unwrap_err().to_string();
        assert!(
            error.contains("run.mcap") && error.contains(word),
            "{error}"
        );
    }
    // A clock of its own is brought onto the file's.
    for tick in 0..100 {
        let t = f64::from(tick) / 1e2;
        writer.write_command(t, "hip", 0.0, 0.0, 0.0).unwrap();
        writer
            .write_sample(t, "hip", position, t + 12_345.0, &[t])
            .unwrap();
    }
    writer.finish().unwrap();
    let recording = Recording::from_path(&path).unwrap();
    assert_eq!(recording.channel(position).unwrap().time[50], 0.5);
}

#[test]
fn inspect_lists_topics_and_roles() {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, &whole()[..whole().len() / 2]);
    let inspect = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("quell").unwrap();
        let assert = command
            .arg("inspect")
            .arg(&path)
            .args(arguments)
            .assert()
            .success();
        String::from_utf8(assert.get_output().stdout.clone()).unwrap()
    };
    let text = inspect(&[]);
    for word in [
        "/joint_states",
        "sensor_msgs/msg/JointState",
        "position[hip]",
        "is cut",
        "What looks wrong",
    ] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    let all: Value = serde_json::from_str(&inspect(&["--json"])).unwrap();
    assert_eq!(all["joints"][0]["joint"], "hip");
    assert_eq!(
        all["joints"][0]["roles"].as_array().unwrap().len(),
        1 + SAMPLES.len()
    );
    assert_eq!(all["channels"].as_array().unwrap().len(), 1 + SAMPLES.len());
    assert_eq!(all["cut"]["of"], whole().len() / 2);

    let mut writer = McapWriter::create(&path, &["hip", "knee"]).unwrap();
    for joint in ["hip", "knee"] {
        writer
            .write_sample(0.0, joint, Role::Deformation, 0.0, &[0.1])
            .unwrap();
    }
    writer.finish().unwrap();
    assert!(inspect(&[]).contains("run.mcap#hip"));
    let error = Recording::from_path(&path).unwrap_err().to_string();
    assert!(error.contains("hip, knee"), "{error}");
    let knee = format!("{}#knee", path.display());
    assert_eq!(Recording::from_path(knee).unwrap().channels.len(), 1);
}

/// Runs a verb in a folder; what it prints.
fn quell(folder: &TempDir, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("quell").unwrap();
    let assert = command
        .current_dir(folder)
        .args(arguments)
        .assert()
        .success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

#[test]
fn every_verb_takes_an_mcap_file_as_it_takes_a_manifest() {
    let folder = TempDir::new().unwrap();
    quell(
        &folder,
        &[
            "simulate", "--target", "30", "--target", "0", "--out", "arm",
        ],
    );
    let recording = Recording::from_path(folder.path().join("arm")).unwrap();
    let path = folder.path().join("arm.mcap");
    let mut writer = McapWriter::create(&path, &["hip"]).unwrap();
    for channel in &recording.channels {
        for (sample, t) in channel.time.iter().enumerate() {
            let row: Vec<_> = channel
                .columns
                .iter()
                .map(|column| column[sample])
                .collect();
            writer
                .write_sample(*t, "hip", channel.role, *t, &row)
                .unwrap();
        }
    }
    writer.finish().unwrap();
    let model = "arm/model.toml";
    for (verb, lines) in [
        (
            &["identify", "IT", "--model", model][..],
            &["likelihood", "batch_fit", "clock"][..],
        ),
        (&["score", model, "IT"], &["rms"]),
        (&["simulate", model, "IT", "--out", "p.csv"], &["rms"]),
        (&["simulate", "--command", "IT", "--out", "again"], &["1 "]),
    ] {
        // Stamps are rounded to a nanosecond, which no digit that is printed shows.
        let [folder_says, file_says] = ["arm", "arm.mcap"].map(|name| {
            let arguments = verb.iter().map(|word| word.replace("IT", name));
            let arguments: Vec<String> = arguments.collect();
            let text = quell(
                &folder,
                &arguments.iter().map(String::as_str).collect::<Vec<_>>(),
            );
            let told = |line: &&str| lines.iter().any(|word| line.contains(word));
            text.lines()
                .filter(told)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        });
        assert_eq!(folder_says, file_says, "{verb:?}");
        assert!(file_says.len() >= lines.len(), "{verb:?}: {file_says:?}");
    }
}

#[test]
fn a_length_that_lies_takes_no_memory() {
    for place in (8..bare().len().min(6000) - 8).step_by(5) {
        for lie in [u64::MAX, 0x7fff_ffff, 0x7fff_ffff_7fff_ffff] {
            let mut bytes = bare().to_vec();
            bytes[place..place + 8].copy_from_slice(&lie.to_le_bytes());
            let used = allocation_counter::measure(|| look(&bytes));
            // A few copies of the file, its numbers and the text of an error.
            let most = 64 * bytes.len() as u64;
            assert!(
                used.bytes_max < most,
                "byte {place}: {} of {most}",
                used.bytes_max
            );
        }
    }
}

/// A file without compression and sums, so that changed bytes reach definitions and messages.
fn bare() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let options = mcap::WriteOptions::new()
            .compression(None)
            .calculate_chunk_crcs(false)
            .chunk_size(Some(2048));
        let mut out = options.create(std::io::Cursor::new(Vec::new())).unwrap();
        for message in mcap::MessageStream::new(whole()).unwrap().take(60) {
            out.write(&message.unwrap()).unwrap();
        }
        out.finish().unwrap();
        out.into_inner().into_inner()
    })
}

/// Reads a file as a recording and looks at it as `quell inspect` does.
fn look(bytes: &[u8]) {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, bytes);
    let Ok(file) = McapFile::open(&path) else {
        return;
    };
    for joint in file.joints() {
        if let Ok(recording) = file.recording(Some(&joint)) {
            for channel in &recording.channels {
                assert!(channel.time.windows(2).all(|pair| pair[0] < pair[1]));
                remarks(channel, &health(channel));
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_bytes_make_it_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in (any::<prop::sample::Index>(), any::<u64>()),
        cut in any::<prop::sample::Index>(),
        is_cut: bool,
        is_bare: bool,
        noise in proptest::collection::vec(any::<u8>(), 0..99),
    ) {
        let mut bytes = match is_bare {
            true => bare().to_vec(),
            false => whole()[..20_000.min(whole().len())].to_vec(),
        };
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        // A length that is far beyond what is there.
        let place = length.0.index(bytes.len() - 8);
        if length.1 % 2 == 0 {
            bytes[place..place + 8].copy_from_slice(&(u64::MAX >> (length.1 % 33)).to_le_bytes());
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        look(&bytes);
        look(&noise);
        look(&[mcap::MAGIC, &noise].concat());
    }
}
