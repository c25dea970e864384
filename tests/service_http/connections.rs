//! Connections that are too many, too slow or say nothing: they keep out no stop, and they end.

use super::client::{Answer, Client};
use super::stand_in::{BOUNDS, outside, settings};
use quell::service::contract::{Accepted, Request, ServiceError, Snapshot, channels};
use quell::service::http::Settings;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;
use tokio::task::{JoinSet, yield_now};

const PLACES: usize = 4;
/// More than the places, and those that are kept for a stop.
const FLOOD: usize = 100;

fn few_places() -> Settings {
    Settings {
        max_connections: PLACES,
        ..settings()
    }
}

/// A stop on a connection of its own.
fn stop(address: SocketAddr) -> Answer {
    Client::new(address).post("/api/stop", "")
}

/// A connection on which these bytes are sent, and no more.
fn says(address: SocketAddr, bytes: &[u8]) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    let patience = Some(Duration::from_secs(60));
    stream.set_read_timeout(patience).unwrap();
    // It may be cut already, where others came after it.
    let _ = stream.write_all(bytes);
    stream
}

/// All that a connection is told until it ends.
fn told(mut stream: TcpStream) -> String {
    let mut bytes = Vec::new();
    // A reset ends it as well.
    let _ = stream.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into()
}

#[test]
fn one_beyond_the_places_may_stop_and_do_nothing_else() {
    let outside = outside(few_places(), None);
    let mut held: Vec<_> = (0..PLACES).map(|_| Client::new(outside.address)).collect();
    for client in &mut held {
        assert_eq!(client.get("/metrics").status, 200);
    }
    for (path, body) in [
        ("/api/move", "{}"),
        ("/api/shaper", "{}"),
        ("/api/nothing", ""),
    ] {
        let refused = Client::new(outside.address).post(path, body);
        assert_eq!(refused.status, 503, "{path}");
        assert!(refused.error().contains("only POST /api/v1/stop"), "{path}");
    }
    assert_eq!(Client::new(outside.address).get("/api/stop").status, 503);
    let stopped = stop(outside.address);
    assert_eq!(stopped.status, 200, "{}", stopped.text());
    assert_eq!(stopped.json()["joints"][0]["joint"], "joint_1");
    let metrics = held[0].get("/metrics").text();
    assert!(
        metrics.contains("quell_http_connections_refused_total 4\n"),
        "{metrics}"
    );
    // A place that is given back is there for the next one.
    held.pop();
    while Client::new(outside.address).get("/metrics").status != 200 {
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn no_flood_of_slow_connections_keeps_a_stop_out() {
    let outside = outside(few_places(), None);
    let kinds: [&[u8]; 4] = [
        b"",
        b"P",
        b"POST /api/stop HTTP/1.1\r\nHost: localhost\r\n",
        b"POST /api/stop HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{",
    ];
    for bytes in kinds {
        let slow: Vec<_> = (0..FLOOD).map(|_| says(outside.address, bytes)).collect();
        let stopped = stop(outside.address);
        assert_eq!(stopped.status, 200, "{}", stopped.text());
        assert_eq!(stopped.json()["accepted"], "stop");
        drop(slow);
    }
}

#[test]
fn what_is_slow_is_told_so_and_cut() {
    let outside = outside(settings(), None);
    let heads = ["P", "POST /api/stop HTTP/1.1\r\nHost: "];
    for head in heads {
        let told = told(says(outside.address, head.as_bytes()));
        assert!(told.starts_with("HTTP/1.1 408 "), "{head}: {told}");
        let sentence = "{\"error\": \"the head of the request was not here within a second\"}";
        assert!(told.ends_with(sentence), "{told}");
    }
    // A browser that has connected ahead of its request must not take this for the answer to it.
    assert_eq!(told(says(outside.address, b"")), "");
    let head = "POST /api/move HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 50\r\n\r\n{";
    let mut client = says(outside.address, head.as_bytes());
    let mut answer = [0; 4096];
    let length = client.read(&mut answer).unwrap();
    let answer = String::from_utf8_lossy(&answer[..length]);
    assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    assert!(
        answer.contains("the body was not here within 1 s"),
        "{answer}"
    );
    // One that dribbles is cut as well: it would else go on for ever.
    let mut dribble = says(outside.address, b"GET / HTTP/1.1\r\nX-Slow: ");
    while dribble.write_all(b"a").is_ok() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let metrics = Client::new(outside.address).get("/metrics").text();
    assert!(
        metrics.contains("quell_http_refused_total{code=\"408\"} 4\n"),
        "{metrics}"
    );
}

#[test]
fn recordings_that_nobody_takes_are_sent_to_a_few_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for recording in super::small::fleet(folder.path(), 1) {
        std::fs::write(recording.join("about.json"), "{}").unwrap();
        // More than the systems of both sides keep of a connection.
        std::fs::write(recording.join("large.bin"), vec![7; 40_000_000]).unwrap();
    }
    let bounds = quell::service::recorder::Bounds {
        bytes: 1_000_000_000,
        ..BOUNDS
    };
    let outside = outside(settings(), Some((folder.path(), bounds)));
    let get = b"GET /api/recordings/r0000 HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let mut sleepers: Vec<_> = (0..4).map(|_| says(outside.address, get)).collect();
    for sleeper in &mut sleepers {
        let mut begun = [0; 15];
        sleeper.read_exact(&mut begun).unwrap();
        assert_eq!(&begun, b"HTTP/1.1 200 OK");
    }
    let refused = Client::new(outside.address).get("/api/recordings/r0000");
    assert_eq!(refused.status, 503, "{}", refused.error());
    assert!(
        refused.error().contains("too many recordings"),
        "{}",
        refused.error()
    );
    // All else is answered beside them.
    assert_eq!(stop(outside.address).status, 200);
    drop(sleepers);
}

#[test]
fn a_stop_goes_before_the_requests_that_wait_for_the_engine() {
    let runtime = tokio::runtime::Builder::new_current_thread().build();
    runtime.unwrap().block_on(async {
        let (handle, mut ends) = channels(Snapshot::default());
        let mut waiting = JoinSet::new();
        for _ in 0..100 {
            let handle = handle.clone();
            let request = Request::Payload { mass: 1.0 };
            waiting.spawn(async move { handle.ask(request).await });
        }
        // Each has been sent or refused once this task comes again and again.
        for _ in 0..100 {
            yield_now().await;
        }
        let mut refused = 0;
        while let Some(answer) = waiting.try_join_next() {
            assert_eq!(answer.unwrap(), Err(ServiceError::Busy));
            refused += 1;
        }
        assert!(refused > 0, "more are asked for than may wait");
        let stop = tokio::spawn(async move { handle.ask(Request::Stop).await });
        let done = Accepted::Stop {
            duration_s: 0.0,
            joints: Vec::new(),
        };
        yield_now().await;
        let first = ends.requests.recv().await.unwrap();
        assert_eq!(first.request, Request::Stop);
        first.reply.send(Ok(done.clone())).unwrap();
        let next = ends.requests.recv().await.unwrap();
        assert!(next.number < first.number, "it was asked before");
        assert_eq!(stop.await.unwrap(), Ok(done));
    });
}
