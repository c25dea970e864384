//! The page in a browser: a move is commanded from it, the bars show the drop, a diagnosis is started
//! and its verdict read. Without Chromium this is skipped with a word.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket, client::client};

/// What a slow machine may take for one step.
const PATIENCE: Duration = Duration::from_secs(120);

/// A process that ends with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The first word of the output that begins so.
fn announced(output: impl std::io::Read + Send + 'static, beginning: &str) -> String {
    let mut lines = BufReader::new(output).lines().map_while(Result::ok);
    let word = lines.find_map(|line| {
        let mut words = line.split_whitespace().map(String::from);
        words.find(|word| word.starts_with(beginning))
    });
    // Its output must be taken as long as it lives.
    std::thread::spawn(move || lines.for_each(drop));
    word.unwrap_or_else(|| panic!("no {beginning} was announced"))
}

fn service(data: &std::path::Path) -> (Process, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args(["serve", "--http", "127.0.0.1:0", "--data"]);
    command.arg(data).stdout(Stdio::piped());
    let mut process = Process(command.spawn().unwrap());
    let page = announced(process.0.stdout.take().unwrap(), "http://");
    (process, page)
}

/// A page in a browser, driven by the DevTools protocol.
struct Browser {
    socket: WebSocket<TcpStream>,
    session: Option<String>,
    last: u64,
    _process: Process,
}

impl Browser {
    /// None where there is no Chromium.
    fn start(profile: &std::path::Path) -> Option<Self> {
        let mut command = Command::new("chromium");
        command.args(["--headless=new", "--no-sandbox", "--disable-gpu"]);
        command.args(["--remote-debugging-port=0", "about:blank"]);
        command.arg(format!("--user-data-dir={}", profile.display()));
        let process = command.stderr(Stdio::piped()).spawn().ok()?;
        let mut process = Process(process);
        let address = announced(process.0.stderr.take().unwrap(), "ws://");
        let host = address.trim_start_matches("ws://").split('/').next()?;
        let stream = TcpStream::connect(host).unwrap();
        let mut browser = Self {
            socket: client(&address, stream).unwrap().0,
            session: None,
            last: 0,
            _process: process,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", target);
        browser.session = session["sessionId"].as_str().map(String::from);
        Some(browser)
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last += 1;
        let mut message = json!({"id": self.last, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let message = Message::text(message.to_string());
        self.socket.send(message).unwrap();
        loop {
            let heard = self.socket.read().unwrap();
            let heard: Value = serde_json::from_slice(&heard.into_data()).unwrap_or_default();
            if heard["id"] == self.last {
                return heard["result"].clone();
            }
        }
    }

    /// Value of an expression in the page.
    fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({"expression": expression, "returnByValue": true});
        let result = self.call("Runtime.evaluate", parameters);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    fn until(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while self.value(expression) != json!(true) {
            let text = "document.querySelector('main')?.innerText";
            assert!(
                Instant::now() < end,
                "{expression} never holds: {}",
                self.value(text)
            );
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn key(&mut self, key: &str, code: u32) {
        for kind in ["keyDown", "keyUp"] {
            let event =
                json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", event);
        }
    }
}

const RESTS: &str = "state?.joints[0].phase === 'rest'";

/// Types a target and presses Enter, and waits for the bar.
fn travel(browser: &mut Browser, degrees: i32, moves: usize) {
    browser.until(RESTS);
    browser.value(&format!(
        "$('target').value = '{degrees}'; $('target').focus()"
    ));
    browser.value("$('move').requestSubmit()");
    browser.until(&format!(
        "document.querySelectorAll('#bars .name').length === {moves}"
    ));
}

#[test]
fn a_robot_is_moved_and_diagnosed_from_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut browser) = Browser::start(&folder.path().join("profile")) else {
        println!("skipped: there is no chromium on this machine");
        return;
    };
    let (_service, page) = service(&folder.path().join("data"));
    browser.call("Page.navigate", json!({"url": page}));
    browser.until("document.readyState === 'complete' && typeof $ === 'function'");
    browser.until("$('connection').textContent === 'connected'");
    browser.until(RESTS);

    browser.value("$('shaping').click()");
    browser.until("state.joints[0].shaping === false");
    travel(&mut browser, 30, 1);
    browser.value("$('shaping').click()");
    browser.until("state.joints[0].shaping === true");
    travel(&mut browser, 0, 2);
    travel(&mut browser, 30, 3);
    // The newest is the first; its second bar is what was left.
    let bars = "[...document.querySelectorAll('#bars .track')].map((track) => \
        [...track.querySelectorAll('i')].map((bar) => bar.getBoundingClientRect().width))";
    let bars = browser.value(bars);
    let (without, with) = (bars[0][0].as_f64().unwrap(), bars[0][1].as_f64().unwrap());
    assert!(with < 0.1 * without, "the bars show the drop: {bars}");
    assert_eq!(
        bars[2].as_array().unwrap().len(),
        1,
        "an unshaped move has one bar: {bars}"
    );

    // A narrow screen needs no scrolling sideways.
    let narrow = json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": true});
    browser.call("Emulation.setDeviceMetricsOverride", narrow);
    browser.until("document.documentElement.scrollWidth <= innerWidth");

    // Stopped by key in the middle of a long move.
    browser.value("document.activeElement.blur()");
    browser.value("move(-150)");
    browser.until("state.joints[0].phase === 'moving' && state.joints[0].command_rad < 0.3");
    browser.key("Escape", 27);
    browser.until("state.joints[0].phase === 'rest' && state.moves.at(-1).interrupted");
    assert_eq!(
        browser.value("state.joints[0].command_rad > -2.5"),
        json!(true)
    );

    browser.until("document.querySelectorAll('#recordings button').length >= 3");
    browser.value("[...document.querySelectorAll('#recordings button')].at(-1).click()");
    browser.until("!$('verdict').hidden");
    let verdict = browser.value("$('verdict').textContent");
    let verdict = verdict.as_str().unwrap();
    println!("{verdict}");
    assert!(
        verdict.starts_with("move-000001: Nothing is missing"),
        "{verdict}"
    );
    browser.until("$('report').href.endsWith('/report') && !$('report-row').hidden");
}
