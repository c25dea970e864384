//! A page in Chromium, driven by the DevTools protocol: real keys and clicks, and every error that the page makes.

use serde_json::{Value, json};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket, client::client};

use super::process::{Process, announced};

/// The time that a slow machine may take for one step.
const PATIENCE: Duration = Duration::from_secs(600);

/// Notes what the page asks for, before any script of it runs.
const NOTES: &str = "globalThis.asked = []; const plain = fetch; \
    globalThis.fetch = (path, options) => { \
        asked.push(`${options?.method ?? 'GET'} ${path}`); return plain(path, options); };";

/// A key as the browser gets it: name, code, number, and the text that it types.
pub type Key = (&'static str, &'static str, u32, &'static str);
pub const SPACE: Key = (" ", "Space", 32, " ");
pub const ESCAPE: Key = ("Escape", "Escape", 27, "");
pub const ENTER: Key = ("Enter", "Enter", 13, "\r");

pub struct Browser {
    socket: WebSocket<TcpStream>,
    session: Option<String>,
    last: u64,
    /// The errors of the page, and of the frames in it.
    errors: Vec<String>,
    _process: Process,
}

impl Browser {
    /// None, with a word, where there is no Chromium.
    pub fn start(profile: &Path) -> Option<Self> {
        let mut command = Command::new("chromium");
        command.args(["--headless=new", "--no-sandbox", "--disable-gpu"]);
        command.args(["--disable-background-networking", "--window-size=1280,900"]);
        command.args(["--remote-debugging-port=0", "about:blank"]);
        command.arg(format!("--user-data-dir={}", profile.display()));
        let Ok(process) = command.stderr(Stdio::piped()).spawn() else {
            super::skipped::skipped("there is no chromium: the page is not tried");
            return None;
        };
        let mut process = Process(process);
        let address = announced(process.0.stderr.take().unwrap(), "ws://");
        let host = address.trim_start_matches("ws://").split('/').next()?;
        let stream = TcpStream::connect(host).unwrap();
        let mut browser = Self {
            socket: client(&address, stream).unwrap().0,
            session: None,
            last: 0,
            errors: Vec::new(),
            _process: process,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", target);
        browser.session = session["sessionId"].as_str().map(String::from);
        // A frame of another origin is a target of its own.
        let attach = json!({"autoAttach": true, "waitForDebuggerOnStart": false, "flatten": true});
        browser.call("Target.setAutoAttach", attach);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        let notes = json!({"source": NOTES});
        browser.call("Page.addScriptToEvaluateOnNewDocument", notes);
        Some(browser)
    }

    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        let session = self.session.clone();
        let id = self.send(method, &parameters, session.as_deref());
        loop {
            let heard = self.socket.read().unwrap();
            let heard: Value = serde_json::from_slice(&heard.into_data()).unwrap_or_default();
            if heard["id"] == id {
                assert!(heard["error"].is_null(), "{method} {parameters}: {heard}");
                return heard["result"].clone();
            }
            self.note(&heard);
        }
    }

    fn send(&mut self, method: &str, parameters: &Value, session: Option<&str>) -> u64 {
        self.last += 1;
        let mut message = json!({"id": self.last, "method": method, "params": parameters});
        if let Some(session) = session {
            message["sessionId"] = json!(session);
        }
        self.socket
            .send(Message::text(message.to_string()))
            .unwrap();
        self.last
    }

    /// An event beside the answers.
    fn note(&mut self, event: &Value) {
        let told = &event["params"];
        let wrong = match event["method"].as_str().unwrap_or_default() {
            "Target.attachedToTarget" => {
                let session = told["sessionId"].as_str().map(String::from);
                for domain in ["Runtime.enable", "Log.enable"] {
                    self.send(domain, &json!({}), session.as_deref());
                }
                false
            }
            "Runtime.exceptionThrown" => true,
            "Runtime.consoleAPICalled" => told["type"] == "error" || told["type"] == "assert",
            // An answer that is an error is told by the page itself.
            "Log.entryAdded" => {
                told["entry"]["level"] == "error" && told["entry"]["source"] != "network"
            }
            _ => false,
        };
        if wrong {
            self.errors.push(told.to_string());
        }
    }

    /// Fails where the page has made an error.
    pub fn assert_sound(&mut self) {
        // Errors that came before this answer are noted with it.
        self.value("1");
        assert!(
            self.errors.is_empty(),
            "errors of the page: {:#?}",
            self.errors
        );
    }

    /// Value of an expression in the page, awaited where it is a promise.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters =
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let result = self.call("Runtime.evaluate", parameters);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].clone()
    }

    /// Text of the first element of this selector.
    pub fn text(&mut self, selector: &str) -> String {
        let text = self.value(&format!("document.querySelector('{selector}').textContent"));
        text.as_str().unwrap_or_default().into()
    }

    /// Waits until an expression is true.
    pub fn until(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while self.value(expression) != json!(true) {
            let text = "document.querySelector('main')?.innerText";
            assert!(
                Instant::now() < end,
                "{expression} never holds: {}",
                self.value(text)
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        assert!(
            self.errors.is_empty(),
            "errors of the page: {:#?}",
            self.errors
        );
    }

    /// Shows a page of the service, once it has heard of it.
    pub fn open(&mut self, page: &str) {
        self.call("Page.navigate", json!({"url": page}));
        self.until("document.querySelector('#connection')?.textContent === 'connected'");
        self.until("document.querySelector('#phase').textContent !== ''");
    }

    /// Presses a key, holds it for so many repetitions, and lets it go.
    pub fn press(&mut self, (key, code, number, text): Key, repetitions: usize) {
        let event = json!({"key": key, "code": code, "windowsVirtualKeyCode": number});
        let of = |kind: &str, repeated: bool| {
            let mut event = event.clone();
            (event["type"], event["autoRepeat"]) = (json!(kind), json!(repeated));
            if kind == "keyDown" && !text.is_empty() {
                event["text"] = json!(text);
            }
            event
        };
        for repetition in 0..=repetitions {
            self.call("Input.dispatchKeyEvent", of("keyDown", repetition > 0));
        }
        self.call("Input.dispatchKeyEvent", of("keyUp", false));
    }

    /// Clicks in the middle of an element, so many times in a row.
    pub fn click(&mut self, selector: &str, times: u32) {
        let middle = format!(
            "(() => {{ const element = document.querySelector('{selector}'); \
             element.scrollIntoView({{ block: 'center' }}); \
             const box = element.getBoundingClientRect(); \
             return [box.x + box.width / 2, box.y + box.height / 2]; }})()"
        );
        let middle = self.value(&middle);
        for count in 1..=times {
            for kind in ["mousePressed", "mouseReleased"] {
                let event = json!({"type": kind, "x": middle[0], "y": middle[1],
                    "button": "left", "clickCount": count});
                self.call("Input.dispatchMouseEvent", event);
            }
        }
    }

    /// Commands that the page has sent since the last time.
    pub fn commands(&mut self) -> Vec<String> {
        let sent = self.value("asked.splice(0).filter((one) => !one.startsWith('GET '))");
        let sent = sent.as_array().cloned().unwrap_or_default();
        let path = |one: &Value| one.as_str().unwrap_or_default().to_string();
        sent.iter().map(path).collect()
    }
}
