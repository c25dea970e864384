//! Proposals for exports of drives, scopes and laboratory programs.

use super::{Proposal, propose};

/// The proposal for a file with these lines above rows of a motion, each made from its instant in ms and two values.
fn proposed(head: &str, row: impl Fn(usize, f64, f64) -> String) -> Proposal {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("export.csv");
    let rows = (0..200).map(|k| {
        let angle = 0.05 * k as f64;
        row(2 * k, 40.0 * angle.sin(), 39.0 * angle.cos())
    });
    let lines: Vec<String> = head.lines().map(String::from).chain(rows).collect();
    std::fs::write(&file, lines.join("\r\n")).unwrap();
    propose(&file).unwrap_or_else(|error| panic!("{head}: {error}"))
}

/// Asserts that a proposal has these words, and asks for nothing but whether a role is right.
fn has(head: &str, told: &Proposal, words: &[&str]) {
    let text = &told.manifests[0].text;
    for own in words {
        assert!(text.contains(own), "{own:?} of {head} is not in {text}");
    }
    let mut open = told.open.iter();
    assert!(
        open.all(|own| own.contains(" is a ")),
        "{head}: {:?}",
        told.open
    );
}

#[test]
fn properties_above_the_names_or_below_them_are_no_names() {
    let names = "Name\tAxis1.MotorPos [deg]\tAxis1.LoadPos [deg]";
    for head in [
        format!("File\tmove.svdx\nSampleTime[ms]\t2\n\n{names}"),
        format!("File\tmove.svdx\n{names}\nSampleTime[ms]\t2\t2"),
        format!("{names}\nSampleTime[ms]\t2"),
    ] {
        let told = proposed(&head, |ms, u, y| format!("{ms}\t{u:.5}\t{y:.5}"));
        let first = ["column = \"2\"", "column = \"Axis1.MotorPos [deg]\""];
        let text = &told.manifests[0].text;
        assert!(first.iter().any(|own| text.contains(own)), "{text}");
        let words = [
            "motor_position",
            "link_position",
            "time_unit = \"ms\"\n",
            "unit = \"deg\"",
        ];
        has(&head, &told, &words);
    }
    let head = "Name\tAxis1.MotorPos\tName\tAxis1.LoadPos\nSampleTime[ms]\t2\tSampleTime[ms]\t2";
    let told = proposed(head, |ms, u, y| format!("{ms}\t{u:.5}\t{ms}\t{y:.5}"));
    has(
        head,
        &told,
        &["skip = 2", "column = \"2\"  # Axis1.MotorPos"],
    );
    // The key has no cell beside the rows.
    let head = "SampleTime[ms]\t2\nName\tTime\tAxis1.MotorPos\tAxis1.LoadPos\nUnit\tms\tdeg\tdeg";
    let told = proposed(head, |ms, u, y| format!("\t{ms}\t{u:.5}\t{y:.5}"));
    has(
        head,
        &told,
        &[
            "time = \"2\"\ntime_unit = \"ms\"\n",
            "column = \"3\"  # Axis1.MotorPos [deg]",
        ],
    );
}

#[test]
fn the_step_of_a_waveform_is_told_as_a_rate() {
    let names = "Motor position [deg],Load position [deg]";
    for head in [
        format!(
            "wf_start_time,5/14/2024 9:14:02 AM\nwf_increment,0.002\nwf_samples,200\n\n{names}"
        ),
        format!("# wf_increment: 0.002\n{names}"),
        format!(
            "Group,Channels\nTest,2\n\nChannel,Unit,wf_increment\na,g,0.002\nb,g,0.002\n\n{names}"
        ),
    ] {
        let told = proposed(&head, |_, u, y| format!("{u:.5},{y:.5}"));
        has(
            &head,
            &told,
            &["rate_hz = 500  # wf_increment above the table says it"],
        );
    }
    let head = "Channel,Motor position,Load position\nunit_string,deg,deg\nwf_increment,0.002,0.002\nwf_samples,200,200";
    let told = proposed(head, |_, u, y| format!(",{u:.5},{y:.5}"));
    has(
        head,
        &told,
        &["rate_hz = 500", "column = \"2\"  # Motor position [deg]"],
    );
    // Stamps are what was measured.
    let head = format!("wf_increment,0.004\nTime [ms],{names}");
    let told = proposed(&head, |ms, u, y| format!("{ms},{u:.5},{y:.5}"));
    has(&head, &told, &["time = \"Time [ms]\""]);
}

#[test]
fn the_second_encoder_of_a_drive_is_of_the_load() {
    for head in [
        "Time [ms];Actual position encoder 1 [\u{b0}];Actual position encoder 2 [\u{b0}]",
        "Zeit [ms];Lageistwert Geber 1 [\u{b0}];Lageistwert Geber 2 [\u{b0}]",
        "Time [ms];r0482[0];r0482[1]",
        "Time [ms];r482[0] Encoder actual position value Gn_XIST1;r482[1] Encoder actual position value Gn_XIST1",
        "Time [ms];Drive_1: r0482[0]: Encoder 1 actual position;Drive_1: r0482[1]: Encoder 2 actual position",
    ] {
        let told = proposed(head, |ms, u, y| format!("{ms};{u:.5};{y:.5}"));
        has(
            head,
            &told,
            &[
                "role = \"motor_position\"  # guessed",
                "role = \"link_position\"  # guessed",
            ],
        );
        assert!(told.joints.is_empty(), "{head}: {:?}", told.joints);
        let text = &told.manifests[0].text;
        assert!(
            text.find("motor_position") < text.find("link_position"),
            "{text}"
        );
    }
    let head = "Time [ms];r0063[0] [rpm];r0080 [Nm]";
    let told = proposed(head, |ms, u, y| format!("{ms};{u:.5};{y:.5}"));
    let text = &told.manifests[0].text;
    assert!(
        text.contains("motor_velocity") && text.contains("\"torque\""),
        "{text}"
    );
    assert!(!text.contains("joint ="), "{text}");
    // Two drives are two joints.
    let head = "Time [ms];Drive_1: r0482[0];Drive_2: r0482[0]";
    let told = proposed(head, |ms, u, y| format!("{ms};{u:.5};{y:.5}"));
    assert_eq!(told.joints, ["drive_1", "drive_2"]);
}

#[test]
fn commands_name_the_signals_of_a_recorder() {
    let head = "Time [s],PX,DV[3],IQ";
    let told = proposed(head, |ms, u, y| {
        format!("{},{u:.0},{u:.0},{y:.3}", 1e-3 * ms as f64)
    });
    let words = [
        "\"motor_position\"  # guessed",
        "\"command_position\"\n",
        "\"motor_current\"\n",
        "unit = \"A\"",
    ];
    has(head, &told, &words);
    // Two axes of a tracker are no drive.
    let told = proposed("Time [s],PX,PY", |ms, u, y| {
        format!("{},{u:.0},{y:.0}", 1e-3 * ms as f64)
    });
    assert!(
        !told.manifests[0].text.contains("role = \"motor_position\""),
        "{told:?}"
    );
    let head = "Time [s],Motor[1].ActPos,Motor[1].DesPos";
    let told = proposed(head, |ms, u, y| {
        format!("{},{u:.0},{y:.0}", 1e-3 * ms as f64)
    });
    has(
        head,
        &told,
        &["role = \"motor_position\"", "role = \"command_position\""],
    );
}
