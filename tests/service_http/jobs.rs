//! Diagnoses as jobs: cancelled, given up after their time, and stopped at any moment of their work.

use super::client::Client;
use super::small::{MODEL, fleet, poison};
use super::stand_in::{BOUNDS, Outside, outside, settings};
use quell::diagnosis::{Diagnosis, DiagnosisError, Options, Stop, Traces, diagnose};
use quell::model::Model;
use quell::page::Page;
use quell::recording::Recording;
use quell::report::page;
use quell::service::http::Settings;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The service's outside, with a recording on its shelf.
fn with_a_recording(folder: &Path, settings: Settings) -> Outside {
    for recording in fleet(folder, 1) {
        std::fs::write(recording.join("about.json"), "{}").unwrap();
    }
    outside(settings, Some((folder, BOUNDS)))
}

fn order(client: &mut Client) -> (u16, Value) {
    order_of(client, "r0000")
}

fn order_of(client: &mut Client, recording: &str) -> (u16, Value) {
    let body = json!({"recording": recording, "model": MODEL}).to_string();
    let answer = client.post("/api/diagnose", &body);
    (answer.status, answer.json())
}

fn cancel(client: &mut Client, id: u64) -> (u16, Value) {
    let answer = client.send("DELETE", &format!("/api/diagnose/{id}"), &[], b"");
    (answer.status, answer.json())
}

/// A job, once it has this status.
fn until(client: &mut Client, id: u64, status: &str) -> Value {
    loop {
        let job = client.get(&format!("/api/diagnose/{id}")).json();
        if job["status"] == status {
            return job;
        }
        let ended = ["done", "failed", "cancelled"];
        assert!(!ended.iter().any(|end| job["status"] == *end), "{job}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Held while reports shall not be made.
static GATE: Mutex<()> = Mutex::new(());

fn closed() -> MutexGuard<'static, ()> {
    GATE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn gated(diagnosis: &Diagnosis, traces: &Traces, model: &str, names: &[String]) -> Page {
    drop(closed());
    page(diagnosis, traces, model, names)
}

#[test]
fn a_job_is_cancelled_while_it_waits_and_while_it_runs() {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings {
        report: gated,
        ..settings()
    };
    let outside = with_a_recording(folder.path(), settings);
    let mut client = Client::new(outside.address);
    let gate = closed();
    assert_eq!(order(&mut client).0, 202);
    let running = until(&mut client, 1, "running");
    assert_eq!(running["limit_s"], 600.0);
    for id in 2..=5 {
        let (status, job) = order(&mut client);
        assert_eq!((status, &job["id"]), (202, &json!(id)), "{job}");
    }
    assert_eq!(order(&mut client).0, 503, "four wait already");
    // One that waits is cancelled at once, and makes room.
    let (status, job) = cancel(&mut client, 3);
    assert_eq!(
        (status, &job["status"]),
        (200, &json!("cancelled")),
        "{job}"
    );
    assert_eq!(cancel(&mut client, 3).0, 200, "twice is once");
    assert_eq!(order(&mut client).1["id"], 6);
    let (status, job) = cancel(&mut client, 1);
    assert_eq!(
        (status, &job["doing"]),
        (200, &json!("being cancelled")),
        "{job}"
    );
    drop(gate);
    let job = until(&mut client, 1, "cancelled");
    assert!(
        job["diagnosis"].is_null() && job["error"].is_null(),
        "{job}"
    );
    assert_eq!(client.get("/api/diagnose/1/report").status, 409);
    // The others are done, and what is done cannot be cancelled.
    let job = until(&mut client, 6, "done");
    assert_eq!(job["diagnosis"]["verdict"], "no_mismatch", "{job}");
    let (status, refused) = cancel(&mut client, 6);
    assert_eq!(
        (status, &refused["error"]),
        (409, &json!("diagnosis 6 has ended: it is done"))
    );
    assert_eq!(cancel(&mut client, 7).0, 404);
}

#[test]
fn a_job_is_given_up_after_its_time_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings {
        diagnosis_limit: Duration::ZERO,
        ..settings()
    };
    let outside = with_a_recording(folder.path(), settings);
    let mut client = Client::new(outside.address);
    assert_eq!(order(&mut client).0, 202);
    let job = until(&mut client, 1, "failed");
    let error = job["error"].as_str().unwrap();
    assert!(
        error.contains("not done within 0 s (diagnosis.time_limit_s"),
        "{error}"
    );
}

#[test]
fn a_recording_that_cannot_be_read_fails_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(poison(folder.path()).join("about.json"), "{}").unwrap();
    let outside = with_a_recording(folder.path(), settings());
    let mut client = Client::new(outside.address);
    assert_eq!(order_of(&mut client, "poison").0, 202);
    let job = until(&mut client, 1, "failed");
    let error = job["error"].as_str().unwrap();
    assert!(error.contains("data.csv"), "{error}");
}

/// Wherever a diagnosis is stopped it ends with that, and not with a verdict on what was left out.
#[test]
fn a_diagnosis_can_be_stopped_before_any_of_its_simulations() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::from_path(&fleet(folder.path(), 1)[0]).unwrap();
    let model = Model::from_toml(MODEL, "model").unwrap();
    let asked = Arc::new(AtomicUsize::new(0));
    let run = |most: usize| {
        asked.store(0, Relaxed);
        let count = Arc::clone(&asked);
        let options = Options {
            stop: Stop::when(move || count.fetch_add(1, Relaxed) >= most),
            ..Options::default()
        };
        diagnose(
            &model,
            std::slice::from_ref(&recording),
            &[],
            &options,
            &|_, _| {},
        )
    };
    assert!(run(usize::MAX).is_ok());
    let all = asked.load(Relaxed);
    println!("asked {all} times");
    assert!(all > 100, "{all}");
    for part in 0..40 {
        let stopped = run(all * part / 40);
        assert!(
            matches!(stopped, Err(DiagnosisError::Stopped)),
            "part {part}"
        );
    }
}
