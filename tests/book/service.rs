//! A service of the tests' own, and requests to it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};

/// It ends when it is dropped.
pub struct Service {
    process: Child,
    /// Held open: what it says at its end has a reader.
    _said: BufReader<ChildStdout>,
    /// Where page and interface are.
    pub http: String,
    /// The port of the UDP link, where there is one.
    pub udp: Option<String>,
}

impl Service {
    pub fn start(arguments: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_quell"))
            .args(["serve", "--http", "127.0.0.1:0", "--udp", "127.0.0.1:0"])
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(process.stdout.take().unwrap());
        let mut line = String::new();
        said.read_line(&mut line).unwrap();
        let after = |start: &str| {
            let rest = line.split_once(start)?.1;
            let end =
                rest.find(|letter: char| letter == '/' || letter == ',' || letter.is_whitespace());
            Some(rest[..end.unwrap_or(rest.len())].to_string())
        };
        Self {
            http: after("http://").unwrap(),
            udp: after("UDP at 127.0.0.1:"),
            process,
            _said: said,
        }
    }

    /// Status and body of an answer.
    pub fn ask(&self, method: &str, path: &str, body: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.http).unwrap();
        let (host, length) = (&self.http, body.len());
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, body.to_string())
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
