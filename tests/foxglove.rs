//! The live view, by a client that knows only the protocol: handshake, channels, messages.
#![cfg(feature = "foxglove")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use quell::service::config::{Config, ConfigError, Overrides};
use quell::service::contract::{Phase, Request};
use quell::service::start;
use serde_json::{Value, json};

/// Longest that anything here is waited for.
const PATIENCE: Duration = Duration::from_secs(30);

/// A client of a WebSocket, RFC 6455, for messages of one frame, as servers send them.
struct Client(TcpStream);

enum Message {
    Text(Value),
    /// Subscription, ns since 1970, what was sent.
    Data(u32, u64, Value),
}

impl Client {
    fn connect(address: SocketAddr) -> Self {
        let mut stream = TcpStream::connect(address).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let request = format!(
            "GET / HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).expect("a request");
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).expect("an answer");
            head.push(byte[0]);
        }
        let head = String::from_utf8(head).expect("text").to_lowercase();
        // The answer to that key, by the RFC's own example.
        assert!(head.starts_with("http/1.1 101") && head.contains("s3pplmbitxaq9kygzzhzrbk+xoo="));
        assert!(
            head.contains("sec-websocket-protocol: foxglove.sdk.v1\r\n"),
            "{head}"
        );
        Self(stream)
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).expect("bytes");
        bytes
    }

    fn next(&mut self) -> Message {
        loop {
            let [first, length] = self.bytes();
            let length = match length {
                126 => u64::from(u16::from_be_bytes(self.bytes())),
                127 => u64::from_be_bytes(self.bytes()),
                length => length.into(),
            };
            let mut body = vec![0; length as usize];
            self.0.read_exact(&mut body).expect("a body");
            let read = |bytes: &[u8]| serde_json::from_slice(bytes).expect("JSON");
            match first {
                0x81 => return Message::Text(read(&body)),
                0x82 if body[0] == 1 => {
                    let subscription = u32::from_le_bytes(body[1..5].try_into().expect("4"));
                    let time = u64::from_le_bytes(body[5..13].try_into().expect("8"));
                    return Message::Data(subscription, time, read(&body[13..]));
                }
                // What the service does not use, such as the time.
                _ => {}
            }
        }
    }

    /// The next text of a kind.
    fn text(&mut self, op: &str) -> Value {
        loop {
            if let Message::Text(text) = self.next()
                && text["op"] == op
            {
                return text;
            }
        }
    }

    fn send(&mut self, text: &Value) {
        let text = text.to_string();
        let length = u8::try_from(text.len()).ok().filter(|length| *length < 126);
        // A mask of zeros leaves the text as it is.
        let head = [0x81, 0x80 | length.expect("a short text"), 0, 0, 0, 0];
        self.0
            .write_all(&[&head, text.as_bytes()].concat())
            .expect("sent");
    }
}

fn config(folder: &std::path::Path, address: &str) -> Result<Config, ConfigError> {
    let file = folder.join("quell.toml");
    let text = format!("[tick]\nreal_time = false\n[foxglove]\naddress = \"{address}\"\n");
    std::fs::write(&file, text).expect("a file");
    let overrides = Overrides {
        data: Some(folder.join("data")),
        ..Overrides::default()
    };
    Config::load(Some(&file), &overrides)
}

#[test]
fn a_client_sees_a_move_and_what_it_left() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(
        config(folder.path(), "0.0.0.0:8765").is_err(),
        "there is no token"
    );
    let service = start(config(folder.path(), "127.0.0.1:0").expect("fine")).expect("a service");
    let handle = service.handle();
    let since = Instant::now();
    while handle
        .snapshot()
        .joints
        .first()
        .is_none_or(|joint| joint.phase != Phase::Rest)
    {
        assert!(since.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut client = Client::connect(service.foxglove_address().expect("a server"));
    assert_eq!(client.text("serverInfo")["name"], "quell");
    let mut channels = Vec::new();
    while channels.len() < 2 {
        let told = client.text("advertise");
        channels.extend(told["channels"].as_array().expect("channels").clone());
    }
    let topics = ["/quell/joint_1", "/quell/joint_1/moves"];
    let subscriptions = topics.iter().enumerate().map(|(id, topic)| {
        let channel = channels.iter().find(|channel| channel["topic"] == *topic);
        let channel = channel.expect("it is there");
        assert_eq!(
            (&channel["encoding"], &channel["schemaEncoding"]),
            (&"json".into(), &"jsonschema".into())
        );
        let schema: Value =
            serde_json::from_str(channel["schema"].as_str().expect("text")).expect("JSON");
        assert_eq!(schema["type"], "object");
        json!({ "id": id, "channelId": channel["id"] })
    });
    let subscriptions: Vec<_> = subscriptions.collect();
    client.send(&json!({ "op": "subscribe", "subscriptions": subscriptions }));
    let request = Request::Move {
        joint: "joint_1".into(),
        target: 0.3,
        shaper: None,
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .build()
        .expect("a runtime");
    runtime
        .block_on(handle.ask(Request::Enable))
        .expect("enabled");
    runtime.block_on(handle.ask(request)).expect("a move");

    let (mut frames, mut last, mut moved) = (0, (0, 0.0), None);
    while moved.is_none() {
        match client.next() {
            Message::Data(0, time, frame) => {
                let position = frame["command_rad"].as_f64().expect("a number");
                // In order, and never far from the frame before.
                assert!(time > last.0, "{time} after {}", last.0);
                assert!(frames == 0 || (position - last.1).abs() < 0.05, "{frame}");
                (frames, last) = (frames + 1, (time, position));
            }
            Message::Data(1, _, result) => moved = Some(result),
            _ => {}
        }
    }
    let moved = moved.expect("it was just there");
    assert_eq!(
        (&moved["joint"], &moved["target_rad"]),
        (&"joint_1".into(), &0.3.into())
    );
    assert!(
        frames > 50 && last.1 == 0.3,
        "{frames} frames, the last at {}",
        last.1
    );
}
