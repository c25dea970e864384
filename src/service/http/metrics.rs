//! `GET /metrics`: Prometheus text, format 0.0.4.
//!
//! It is written here and not by prometheus-client 0.25, which writes OpenMetrics only. There the family of a
//! counter has no `_total`, so that a reader of 0.0.4 takes it for untyped. Its collector of a snapshot also
//! took more lines.

mod joint;

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

use super::App;
use super::counters::Counters;
use crate::service::contract::{
    DiskPart, DiskView, EnableState, EnableView, JointSnapshot, KnownMode, LinkHealth, Snapshot,
    TickStatistics,
};
use joint::{JOINT, flag};

/// `GET /metrics`.
pub async fn metrics(State(app): State<Arc<App>>) -> Response {
    let snapshot = app.handle.snapshot();
    let mut text = Text::default();
    enabling(&mut text, &snapshot.enable);
    tick(&mut text, &snapshot.tick);
    link(&mut text, &snapshot.link);
    disk(&mut text, &snapshot.disk);
    for (name, help, value) in JOINT {
        text.each(&snapshot.joints, name, help, value);
    }
    sensors(&mut text, &snapshot.joints);
    moves(&mut text, &snapshot);
    modes(&mut text, &snapshot);
    http(&mut text, &app.counters);
    let kind = (CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8");
    ([kind, (CACHE_CONTROL, "no-store")], text.0).into_response()
}

/// The text; a metric's samples follow its description.
#[derive(Default)]
struct Text(String);

impl Text {
    /// A metric with one sample for each list of labels; unknown values are left out.
    fn metric<'a, L>(
        &mut self,
        name: &str,
        help: &str,
        samples: impl IntoIterator<Item = (L, Option<f64>)>,
    ) where
        L: AsRef<[(&'a str, &'a str)]>,
    {
        let kind = if name.ends_with("_total") {
            "counter"
        } else {
            "gauge"
        };
        // Writing to a string does not fail.
        let _ = writeln!(
            self.0,
            "# HELP quell_{name} {help}\n# TYPE quell_{name} {kind}"
        );
        for (labels, value) in samples {
            let Some(value) = value else { continue };
            let label = |(key, value): &(&str, &str)| format!("{key}=\"{}\"", escaped(value));
            let labels: Vec<_> = labels.as_ref().iter().map(label).collect();
            let braces = match labels.is_empty() {
                true => String::new(),
                false => format!("{{{}}}", labels.join(",")),
            };
            let _ = writeln!(self.0, "quell_{name}{braces} {value}");
        }
    }

    fn one(&mut self, name: &str, help: &str, value: f64) {
        self.metric(name, help, [([], Some(value))]);
    }

    fn count(&mut self, name: &str, help: &str, value: u64) {
        self.one(name, help, value as f64);
    }

    /// One sample for each joint.
    fn each(
        &mut self,
        joints: &[JointSnapshot],
        name: &str,
        help: &str,
        value: impl Fn(&JointSnapshot) -> Option<f64>,
    ) {
        let sample = |joint| ([("joint", joint_name(joint))], value(joint));
        self.metric(name, help, joints.iter().map(sample));
    }
}

fn joint_name(joint: &JointSnapshot) -> &str {
    &joint.name
}

fn escaped(label: &str) -> String {
    let label = label.replace('\\', "\\\\").replace('"', "\\\"");
    label.replace('\n', "\\n")
}

fn enabling(text: &mut Text, enable: &EnableView) {
    let is = |state| flag(enable.state == state);
    text.one(
        "enabled",
        "Whether moves are enabled.",
        is(EnableState::Enabled),
    );
    let help = "Whether a fault waits for its reset.";
    text.one("faulted", help, is(EnableState::Faulted));
    text.count("faults_total", "Faults since the start.", enable.faults);
}

fn tick(text: &mut Text, tick: &TickStatistics) {
    text.one("tick_rate_hertz", "Ticks asked for a second.", tick.rate_hz);
    text.count("ticks_total", "Ticks run.", tick.ticks);
    let help = "Ticks that had not ended when the next one was due.";
    text.count("tick_overruns_total", help, tick.overruns);
    let help = "Ticks left out, their time made up for.";
    text.count("ticks_skipped_total", help, tick.skipped);
    let quantiles = [
        ("0.5", tick.lateness_p50_s),
        ("0.99", tick.lateness_p99_s),
        ("1", tick.lateness_max_s),
    ];
    let samples = quantiles.map(|(quantile, value)| ([("quantile", quantile)], Some(value)));
    let help = "Lateness of the beginning of a tick since the start.";
    text.metric("tick_lateness_seconds", help, samples);
    let quantiles = [("0.5", tick.work_p50_s), ("0.99", tick.work_p99_s)];
    let samples = quantiles.map(|(quantile, value)| ([("quantile", quantile)], Some(value)));
    text.metric(
        "tick_work_seconds",
        "Work of a tick since the start.",
        samples,
    );
    let help = "Whether the tick has a real-time priority.";
    text.one("tick_real_time", help, flag(tick.real_time));
    let help = "Records for the stream that found no room.";
    text.count("records_lost_total", help, tick.records_lost);
}

fn link(text: &mut Text, link: &LinkHealth) {
    let counts = [
        ("received", link.received),
        ("sent", link.sent),
        ("send_failure", link.send_failures),
        ("lost", link.lost),
        ("late", link.late),
        ("doubled", link.doubled),
        ("reordered", link.reordered),
        ("foreign", link.foreign),
        ("malformed", link.malformed),
        ("unknown_joint", link.unknown_joint),
        ("unsigned", link.unsigned),
        ("replayed", link.replayed),
        ("overflowed", link.overflowed),
    ];
    let samples = counts.map(|(what, count)| ([("kind", what)], Some(count as f64)));
    text.metric(
        "link_total",
        "What came over the link and went out.",
        samples,
    );
    let samples = [([], link.clock_offset_s)];
    let help = "The robot's clock minus the service's.";
    text.metric("link_clock_offset_seconds", help, samples);
}

fn disk(text: &mut Text, disk: &DiskView) {
    let failing = |what| disk.faults.iter().any(|fault| fault.what == what);
    let samples = DiskPart::ALL.map(|what| ([("what", what.name())], Some(flag(failing(what)))));
    let help = "Whether it cannot be written to the data folder now.";
    text.metric("disk_failing", help, samples);
    let since = disk.faults.iter().map(|fault| {
        let labels = [("what", fault.what.name())];
        (labels, Some(fault.since_unix_time_s))
    });
    let help = "Since when it cannot be written, seconds since 1970.";
    text.metric("disk_failing_since_seconds", help, since);
    let help = "Attempts to write to the data folder that failed.";
    text.count("disk_failures_total", help, disk.failures);
    let help = "Recordings that are not whole on the shelf.";
    text.count("recordings_lost_total", help, disk.recordings_lost);
}

fn sensors(text: &mut Text, joints: &[JointSnapshot]) {
    let all = || {
        let of = |joint| move |sensor| (joint, sensor);
        joints
            .iter()
            .flat_map(move |joint| joint.sensors.iter().map(of(joint_name(joint))))
    };
    let samples = all().map(|(joint, sensor)| {
        (
            [("joint", joint), ("sensor", sensor.name)],
            Some(sensor.samples as f64),
        )
    });
    text.metric("sensor_samples_total", "Samples taken.", samples);
    let refused = all().flat_map(|(joint, sensor)| {
        sensor.refused.iter().map(move |&(reason, count)| {
            let labels = [
                ("joint", joint),
                ("sensor", sensor.name),
                ("reason", reason),
            ];
            (labels, Some(count as f64))
        })
    });
    text.metric("sensor_refused_total", "Samples refused.", refused);
    let faults = all().map(|(joint, sensor)| {
        (
            [("joint", joint), ("sensor", sensor.name)],
            Some(flag(sensor.fault.is_some())),
        )
    });
    text.metric(
        "sensor_fault",
        "Whether something is wrong with the sensor.",
        faults,
    );
}

/// Name, description, and value.
type OfAMode = (&'static str, &'static str, fn(&KnownMode) -> f64);

/// The learned modes, counted from 1.
fn modes(text: &mut Text, snapshot: &Snapshot) {
    let each = |of: fn(&KnownMode) -> f64| {
        let joints = snapshot.joints.iter();
        let all = joints.flat_map(move |joint| {
            let modes = joint.learning.modes.iter().enumerate();
            modes.map(move |(k, mode)| (joint.name.clone(), (k + 1).to_string(), of(mode)))
        });
        all.collect::<Vec<_>>()
    };
    let metrics: [OfAMode; 6] = [
        (
            "known_mode_frequency_hertz",
            "Natural frequency of a mode in the middle of the last way.",
            |m| m.frequency_hz,
        ),
        (
            "known_mode_frequency_std_hertz",
            "One standard deviation of it.",
            |m| m.frequency_std_hz,
        ),
        (
            "known_mode_damping_ratio",
            "Damping ratio of a mode.",
            |m| m.damping_ratio,
        ),
        (
            "known_mode_damping_ratio_std",
            "One standard deviation of it.",
            |m| m.damping_ratio_std,
        ),
        (
            "known_mode_contribution_ratio",
            "Part of a mode in what the last move leaves unshaped.",
            |m| m.contribution_percent / 100.0,
        ),
        ("known_mode_shaped", "Whether a mode is shaped for.", |m| {
            flag(m.shaped)
        }),
    ];
    for (name, help, of) in metrics {
        let values = each(of);
        let samples = values.iter().map(|(joint, mode, value)| {
            (
                [("joint", joint.as_str()), ("mode", mode.as_str())],
                Some(*value),
            )
        });
        text.metric(name, help, samples);
    }
}

/// The residual vibration of each joint's last move.
fn moves(text: &mut Text, snapshot: &Snapshot) {
    let last = |joint: &JointSnapshot| {
        let of_joint = |result: &&_| -> bool {
            let result: &crate::service::contract::MoveResult = result;
            result.joint == joint.name && !result.interrupted
        };
        snapshot.moves.iter().rev().find(of_joint)
    };
    let help = "Vibration that the last move left.";
    text.each(&snapshot.joints, "residual_radians", help, |j| {
        last(j)?.residual_rad
    });
    let help = "Vibration that it would have left unshaped.";
    text.each(&snapshot.joints, "unshaped_radians", help, |j| {
        last(j)?.unshaped_rad
    });
    let help = "Largest vibration of the last move, in cruise and after its end.";
    text.each(&snapshot.joints, "vibration_radians", help, |j| {
        last(j)?.vibration_rad
    });
    let help = "Largest vibration that it would have made unshaped.";
    text.each(&snapshot.joints, "unshaped_vibration_radians", help, |j| {
        last(j)?.unshaped_vibration_rad
    });
}

fn http(text: &mut Text, counters: &Counters) {
    let load = |count: &AtomicU64| count.load(Relaxed);
    text.count(
        "http_requests_total",
        "Requests answered.",
        load(&counters.requests),
    );
    let refused: Vec<_> = counters
        .refused()
        .map(|(code, n)| (code.to_string(), n))
        .collect();
    let samples = refused
        .iter()
        .map(|(code, n)| ([("code", code.as_str())], Some(*n as f64)));
    text.metric(
        "http_refused_total",
        "Requests refused, by status.",
        samples,
    );
    text.count(
        "http_connections",
        "Connections open.",
        load(&counters.connections),
    );
    let help = "Connections refused since too many were open.";
    text.count(
        "http_connections_refused_total",
        help,
        load(&counters.connections_refused),
    );
    text.count("streams", "WebSockets open.", load(&counters.streams));
    let help = "WebSockets closed since nobody read.";
    text.count("streams_closed_total", help, load(&counters.streams_closed));
    let help = "Batches that slow readers lost.";
    text.count(
        "stream_batches_lost_total",
        help,
        load(&counters.batches_lost),
    );
}
