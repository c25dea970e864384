//! A service that is told to end while clients hold what they can hold.

use std::io::Write;
use std::net::TcpStream;

use rustix::process::{Pid, Signal, kill_process};

use super::check_recording;
use super::client::Client;
use super::process::{go, serve, until};

/// Clients that neither read nor go: a reader of the stream, a download, and half of a request.
fn holding(address: std::net::SocketAddr) -> Vec<TcpStream> {
    let requests = [
        "GET /api/v1/stream HTTP/1.1\r\nHost: {}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        "GET /api/v1/recordings/move-000001 HTTP/1.1\r\nHost: {}\r\n\r\n",
        "POST /api/v1/move HTTP/1.1\r\nHost: {}\r\nContent-Type: application/json\r\n\
         Content-Length: 100\r\n\r\n{",
        "",
    ];
    let hold = |request: &str| {
        let mut stream = TcpStream::connect(address).expect("it listens");
        let request = request.replace("{}", &address.to_string());
        stream.write_all(request.as_bytes()).expect("it is taken");
        stream
    };
    requests.map(hold).into()
}

#[test]
fn a_service_that_is_told_to_end_does_so_whoever_holds_on_and_its_recordings_are_whole() {
    let data = tempfile::tempdir().expect("a folder");
    let mut process = serve(data.path());
    let mut client = Client::new(process.address);
    go(&mut client, 5.0);
    until(
        &mut client,
        "/api/recordings",
        "it is on the shelf",
        |list| list[0]["name"] == "move-000001",
    );
    let begun = client.post("/api/v1/recordings", r#"{"recording": true}"#);
    assert_eq!(begun.status, 200, "{}", begun.text());
    let on_demand = begun.json()["name"].as_str().expect("a name").to_owned();
    // It ends in the middle of this one.
    let body = r#"{"joint": "joint_1", "target_deg": 60}"#;
    assert_eq!(client.post("/api/v1/move", body).status, 200);
    let held = holding(process.address);
    until(&mut client, "/api/v1/state", "it moves", |state| {
        state["joints"][0]["phase"] == "moving"
    });
    let pid = Pid::from_child(&process.child);
    kill_process(pid, Signal::TERM).expect("it can be told");
    assert!(process.child.wait().expect("it ends").success());
    drop(held);
    for name in ["move-000002", &*on_demand] {
        let folder = data.path().join("recordings").join(name);
        check_recording(&folder);
        let about = std::fs::read(folder.join("about.json")).expect("a file");
        let about: serde_json::Value = serde_json::from_slice(&about).expect("JSON");
        assert_eq!(about["ended"], "service", "{about:#}");
    }
}
