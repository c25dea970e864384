//! Batches: jobs known by their hash, the queue of one process, shares, and what is set aside.

mod small;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use quell::batch::{
    BatchError, Folder, InProcess, Job, MOST_DELIVERIES, Queue, Submitted, Taken, Work, pack,
    unpack, work,
};
use serde_json::Value;

fn quell(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args(arguments).current_dir(folder);
    command.output().expect("it runs")
}

/// `quell diagnose --batch` of the folder `fleet`.
fn batch(more: &[&str], here: &Path) -> Output {
    let arguments = ["diagnose", "--batch", "--model", "model.toml", "fleet"];
    quell(&[&arguments, more].concat(), here)
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

/// The folders of results.
fn results(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("text");
    entries
        .map(|entry| entry.expect("an entry"))
        .filter(|entry| entry.path().is_dir())
        .map(name)
        .collect()
}

fn of(name: &str, all: &BTreeSet<String>) -> String {
    let found = all.iter().find(|one| one.starts_with(name));
    found.unwrap_or_else(|| panic!("{name} in {all:?}")).clone()
}

/// A batch says of each recording what it says alone; duplicates are done once, what cannot be read is set
/// aside with file and line, and what is done is not done again.
#[test]
fn a_batch_is_its_recordings_one_by_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::write(here.join("model.toml"), small::MODEL).expect("a file");
    let fleet = small::fleet(&here.join("fleet/monday"), 3);
    small::poison(&here.join("fleet"));
    fs::create_dir(here.join("fleet/twin")).expect("a folder");
    for file in ["recording.toml", "data.csv"] {
        let copy = here.join("fleet/twin").join(file);
        fs::copy(fleet[1].join(file), copy).expect("a copy");
    }
    let ran = batch(&["--json"], here);
    assert_eq!(ran.status.code(), Some(2), "one is set aside: {ran:?}");
    let told: Value = serde_json::from_slice(&ran.stdout).expect("JSON");
    assert_eq!(told.as_array().map(Vec::len), Some(4));
    let all = results(&here.join("out"));
    assert_eq!(all.len(), 4, "{all:?}");

    let aside = json(
        &here
            .join("out")
            .join(of("poison", &all))
            .join("result.json"),
    );
    let error = aside["error"].as_str().expect("an error");
    assert!(error.starts_with("recording.toml:4: file:"), "{error}");

    let alone = [
        "diagnose",
        "--model",
        "model.toml",
        "--out",
        "alone",
        "fleet/monday/r0000",
    ];
    assert!(quell(&alone, here).status.success());
    let one = here.join("out").join(of("r0000", &all));
    assert_eq!(
        json(&one.join("diagnosis.json")),
        json(&here.join("alone/diagnosis.json"))
    );
    let model = |folder: &Path| fs::read_to_string(folder.join("model.toml")).expect("a model");
    assert_eq!(model(&one), model(&here.join("alone")));

    // One page over all, with a link to the report of each, and what is set aside last.
    let page = fs::read_to_string(here.join("out/report.html")).expect("a page");
    for folder in all.iter().filter(|one| !one.starts_with("poison")) {
        assert!(page.contains(&format!("{folder}/report.html")), "{folder}");
        assert!(here.join("out").join(folder).join("report.html").is_file());
    }
    assert!(page.contains("1 could not be diagnosed."), "{page}");
    assert!(page.rfind("poison") > page.rfind("r0002"));

    let before = fs::read(one.join("result.json")).expect("a result");
    let again = batch(&["--json"], here);
    assert_eq!(again.stdout, ran.stdout);
    assert_eq!(before, fs::read(one.join("result.json")).expect("a result"));
}

/// The shares of a batch are disjoint, and together the whole.
#[test]
fn shares_make_the_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::write(here.join("model.toml"), small::MODEL).expect("a file");
    small::fleet(&here.join("fleet"), 8);
    let run = |out: &str, more: &[&str]| {
        let ran = batch(&[&["--out", out], more].concat(), here);
        assert!(ran.status.success(), "{ran:?}");
        results(&here.join(out))
    };
    let whole = run("whole", &[]);
    let shares = ["1/3", "2/3", "3/3"].map(|share| run(&share[..1], &["--shard", share]));
    assert_eq!(whole.len(), 8);
    assert_eq!(
        shares.iter().map(BTreeSet::len).sum::<usize>(),
        8,
        "{shares:?}"
    );
    let union: BTreeSet<_> = shares.iter().flatten().cloned().collect();
    assert_eq!(union, whole);
    for wrong in ["0/3", "4/3", "x", "1/0"] {
        let ran = batch(&["--shard", wrong], here);
        assert_eq!(ran.status.code(), Some(2), "{wrong}");
    }
}

/// A job whose workers die is handed out a few times, and then set aside; the others go on.
#[test]
fn what_no_worker_survives_is_set_aside() {
    let folder = tempfile::tempdir().expect("a folder");
    let recordings = small::fleet(folder.path(), 2);
    let out = Folder::open(&folder.path().join("out")).expect("a folder");
    let queue = InProcess::new(out, 4);
    let job = |path: &Path| {
        let packed = pack(path).expect("a recording");
        (Job::new("arm", &packed, small::MODEL, 1), packed)
    };
    let (deadly, packed) = job(&recordings[0]);
    assert_eq!(
        queue.submit(&deadly, packed.clone()).ok(),
        Some(Submitted::Queued)
    );
    assert_eq!(queue.submit(&deadly, packed).ok(), Some(Submitted::Waiting));
    for time in 1..=MOST_DELIVERIES {
        let Ok(Taken::Job(claim)) = queue.take() else {
            panic!("it waits")
        };
        assert_eq!(
            (claim.deliveries, claim.job.key.as_str()),
            (time, deadly.key.as_str())
        );
        claim.ticket.give_back();
    }
    let (other, packed) = job(&recordings[1]);
    assert_eq!(queue.submit(&other, packed).ok(), Some(Submitted::Queued));
    queue.close();
    let settings = Work {
        at_once: 1,
        threads: 1,
        drain: true,
    };
    work(&queue, settings, &AtomicBool::new(false), &|_| {}).expect("it works");
    let answer = |key: &str| {
        queue
            .folder()
            .answer(key)
            .expect("files")
            .expect("an answer")
    };
    let error = answer(&deadly.key).about.error.expect("an error");
    assert!(error.contains("its workers died"), "{error}");
    assert_eq!(answer(&other.key).about.error, None);
    assert_eq!(queue.left().ok(), Some(0));
}

/// The key of a job is that of its content, wherever it lies; a manifest may name files beside its folder,
/// not others; and what comes from elsewhere does not lead out of the folder that it is opened in.
#[test]
fn a_recording_travels_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let first = pack(&small::fleet(&here.join("a"), 1)[0]).expect("a recording");
    let second = pack(&small::fleet(&here.join("b/c"), 1)[0]).expect("a recording");
    assert_eq!(first, second);
    let key = |model: &str, seed| Job::new("arm", &first, model, seed).key;
    assert_eq!(
        key(small::MODEL, 1),
        Job::new("leg", &second, small::MODEL, 1).key
    );
    assert!(key("", 1) != key(small::MODEL, 1) && key("", 1) != key("", 2));

    let manifest = here.join("a/r0000/recording.toml");
    let text = fs::read_to_string(&manifest).expect("text");
    fs::rename(here.join("a/r0000/data.csv"), here.join("a/data.csv")).expect("a file");
    let naming = |name: &str| {
        fs::write(&manifest, text.replace("data.csv", name)).expect("a file");
        pack(manifest.parent().expect("a folder"))
    };
    let absolute = here.join("a/data.csv").display().to_string();
    assert!(matches!(
        naming(&absolute),
        Err(BatchError::Absolute { .. })
    ));
    let beside = naming("../data.csv").expect("a recording");
    let open = |bytes: &[u8], entry: &str| {
        let scratch = tempfile::tempdir().expect("a folder");
        let path = unpack(bytes, entry, scratch.path())?;
        quell::recording::Recording::from_path(path).map_err(BatchError::from)
    };
    assert_eq!(
        open(&beside.bytes, &beside.entry)
            .expect("a recording")
            .channels
            .len(),
        2
    );

    let outside = |result: Result<_, BatchError>| matches!(result, Err(BatchError::Archive(_)));
    assert!(outside(open(&beside.bytes, "../r0000/recording.toml")));
    let tar = |name: &[u8], content: &[u8]| {
        let mut header = tar::Header::new_old();
        header.as_old_mut().name[..name.len()].copy_from_slice(name);
        header.set_size(content.len() as u64);
        header.set_cksum();
        let mut archive = tar::Builder::new(Vec::new());
        archive.append(&header, content).expect("an archive");
        archive.into_inner().expect("an archive")
    };
    assert!(outside(open(&tar(b"../evil", b"x"), "evil")));
    let leading = text.replace("data.csv", "../../../etc/passwd");
    assert!(outside(open(
        &tar(b"recording.toml", leading.as_bytes()),
        "recording.toml"
    )));
    assert!(outside(open(b"no archive at all", "recording.toml")));
}

/// A build without the queue says so.
#[cfg(not(feature = "nats"))]
#[test]
fn the_queue_elsewhere_is_a_feature() {
    let folder = tempfile::tempdir().expect("a folder");
    let ran = quell(&["work", "--queue", "nats://127.0.0.1:4222"], folder.path());
    assert_eq!(ran.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&ran.stderr).contains("--features nats"));
}
