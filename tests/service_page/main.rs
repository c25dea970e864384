//! The page in a browser: a robot is moved, stopped and diagnosed from it, by real keys and clicks; what it says is
//! read, and any error of its scripts fails the test. Without Chromium this is skipped with a word.

mod browser;
mod disk;
mod keys;
mod process;
mod radians;
#[path = "../absent/skipped.rs"]
mod skipped;

use browser::{Browser, ENTER, ESCAPE};
use process::service;
use serde_json::{Value, json};

/// The first joint as the service says it is, whatever the page shows.
const STATE: &str = "(await (await fetch('/api/state')).json())";

/// Waits until an expression of the service's `state` holds.
fn until(browser: &mut Browser, holds: &str) {
    browser.until(&format!(
        "(async () => {{ const state = {STATE}; return {holds}; }})()"
    ));
}

const RESTS: &str = "state.joints[0].phase === 'rest'";

/// Lets moves begin by the button, as a person does.
fn enable(browser: &mut Browser) {
    until(browser, RESTS);
    browser.until("document.querySelector('#enable').textContent === 'Enable moves'");
    browser.click("#enable", 1);
    until(browser, "state.enable.state === 'enabled'");
    browser.until("document.querySelector('#enable').textContent === 'Disable moves'");
}

/// Types a target and presses Enter, and waits for the bar.
fn travel(browser: &mut Browser, degrees: i32, moves: usize) {
    until(browser, RESTS);
    browser.value(&format!(
        "(() => {{ const target = document.querySelector('#target'); \
         target.value = '{degrees}'; target.focus(); }})()"
    ));
    browser.commands();
    silence(browser);
    browser.press(ENTER, 20);
    browser.until("document.querySelector('#said').textContent.startsWith('The move takes ')");
    assert_eq!(
        browser.commands(),
        ["POST /api/v1/move"],
        "Enter is held, and moves once"
    );
    browser.until(&format!(
        "document.querySelectorAll('#bars .name').length === {moves}"
    ));
}

/// The share that is shown of the last move is that of what vibrates after its end.
fn left(browser: &mut Browser) {
    until(
        browser,
        "(({ shaped, residual_rad: left, unshaped_rad: without }) => { \
            const shown = [...document.querySelectorAll('#figures div')].at(-1).querySelector('dd').textContent; \
            const share = left === 0 ? '0' : String(Number((100 * left / without).toPrecision(2))); \
            return shaped && (shown.startsWith('–') || shown === `${share} %`); })(state.moves.at(-1))",
    );
}

/// Forgets what was said, so that what is said next is read.
fn silence(browser: &mut Browser) {
    browser.value("void (document.querySelector('#said').textContent = '')");
}

/// Switches shaping, and reads what the page says of it.
fn shaping(browser: &mut Browser, on: bool) {
    silence(browser);
    browser.click("#shaping", 1);
    until(browser, &format!("state.joints[0].shaping === {on}"));
    browser.until("document.querySelector('#said').textContent === 'Changed; in force with the next move from rest.'");
}

/// After the start a move is refused, with a sentence that says what to do.
fn disabled(browser: &mut Browser) {
    browser.click("#move .primary", 1);
    browser.until("document.querySelector('#said').textContent.startsWith('moves are not enabled: the service has started; enable first')");
    assert_eq!(browser.text("#enabled"), "disabled");
    until(browser, "Math.abs(state.joints[0].command_rad) < 0.01");
}

/// In the middle of a long move: the page says how long the stop takes, and the bars leave the move out.
fn stopped_by_key(browser: &mut Browser) {
    let bars = browser.value("document.querySelectorAll('#bars .name').length");
    browser.value("(() => { document.querySelector('#target').value = '-150'; })()");
    // A double click is one command.
    browser.commands();
    browser.click("#move .primary", 2);
    until(
        browser,
        "state.joints[0].phase === 'moving' && state.joints[0].command_rad < 0.3",
    );
    assert_eq!(browser.commands(), ["POST /api/v1/move"]);
    browser.press(ESCAPE, 20);
    browser.until("/^joint_1: stopping, at rest in [0-9.]+ s\\.$/.test(document.querySelector('#said').textContent)");
    assert_eq!(
        browser.commands(),
        ["POST /api/v1/stop"],
        "Escape is held, and stops once"
    );
    until(
        browser,
        "state.joints[0].phase === 'rest' && state.moves.at(-1).interrupted",
    );
    until(browser, "state.joints[0].command_rad > -2.5");
    browser.until(
        "document.querySelector('#bars-note').textContent === 'Not shown: 1 move that was interrupted.'",
    );
    assert_eq!(
        browser.value("document.querySelectorAll('#bars .name').length"),
        bars
    );
}

/// One that waits behind others is cancelled from the page.
fn cancelled(browser: &mut Browser) {
    browser.until("document.querySelectorAll('#recordings button').length >= 3");
    let order = "Promise.all([1, 2, 3].map(async () => { \
        const headers = { 'Content-Type': 'application/json' }; \
        const body = JSON.stringify({ recording: 'move-000001' }); \
        return (await fetch('/api/diagnose', { method: 'POST', headers, body })).status; }))";
    assert_eq!(browser.value(order), json!([202, 202, 202]));
    browser.click("#recordings tr:last-child button", 1);
    browser.until(
        "document.querySelector('#doing').textContent.startsWith('Diagnosing move-000001: ')",
    );
    browser.click("#cancel", 1);
    browser.until(
        "document.querySelector('#verdict').textContent === 'move-000001: the diagnosis was cancelled.'",
    );
    let others =
        "Promise.all([1, 2, 3].map((id) => fetch(`/api/diagnose/${id}`, { method: 'DELETE' })))";
    browser.value(&format!("(async () => {{ await {others}; }})()"));
}

#[test]
fn a_robot_is_moved_and_diagnosed_from_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut browser) = Browser::start(&folder.path().join("profile")) else {
        return;
    };
    let (mut process, page) = service(folder.path(), &[]);
    browser.open(&page);
    until(&mut browser, RESTS);
    disabled(&mut browser);
    enable(&mut browser);

    shaping(&mut browser, false);
    travel(&mut browser, 30, 1);
    shaping(&mut browser, true);
    travel(&mut browser, 0, 2);
    travel(&mut browser, 30, 3);
    left(&mut browser);
    // The newest is the first; its second bar is what was left.
    let bars = "[...document.querySelectorAll('#bars .track')].map((track) => \
        [...track.querySelectorAll('i')].map((bar) => bar.getBoundingClientRect().width))";
    let bars = browser.value(bars);
    let (without, with) = (bars[0][0].as_f64().unwrap(), bars[0][1].as_f64().unwrap());
    assert!(with < 0.1 * without, "the bars show the drop: {bars}");
    let unshaped = bars[2].as_array().map(Vec::len);
    assert_eq!(unshaped, Some(1), "an unshaped move has one bar: {bars}");
    assert_eq!(browser.text("#deformation-unit"), " of the tip, mm");

    stopped_by_key(&mut browser);
    cancelled(&mut browser);
    diagnosed(&mut browser);
    keys::space_and_escape_stop_and_do_nothing_else(&mut browser);
    keys::numbers_are_those_that_people_read(&mut browser);

    // A narrow screen needs no scrolling sideways.
    let narrow = json!({"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": true});
    browser.call("Emulation.setDeviceMetricsOverride", narrow);
    browser.until("document.documentElement.scrollWidth <= innerWidth");
    browser.call("Emulation.clearDeviceMetricsOverride", json!({}));

    process.0.kill().unwrap();
    gone(&mut browser);
}

fn diagnosed(browser: &mut Browser) {
    browser.click("#recordings tr:last-child button", 1);
    browser.until("document.querySelector('#verdict').textContent.includes('Nothing ')");
    let verdict = browser.text("#verdict");
    // Where a busy machine has skipped ticks, the motor side has leapt between two samples of its encoder: a little more than the
    // noise may then be left.
    let skipped = browser.value(&format!(
        "(async () => {{ const state = {STATE}; return state.tick.skipped; }})()"
    ));
    let nothing = match skipped.as_u64() {
        Some(0) => "move-000001: Nothing is missing",
        _ => "move-000001: Nothing ",
    };
    assert!(verdict.starts_with(nothing), "{skipped}: {verdict}");
    browser.until("document.querySelector('#report').href.endsWith('/report')");
    browser.click("#show-report", 1);
    browser.until("!document.querySelector('#report-frame').hidden");
    // The button that stops is in sight also where the report is read.
    for place in ["#bars", "#report-frame", "footer"] {
        browser.value(&format!(
            "document.querySelector('{place}').scrollIntoView()"
        ));
        browser.until(
            "(() => { const box = document.querySelector('#stop').getBoundingClientRect(); \
             return box.height > 0 && box.top >= 0 && box.bottom <= innerHeight; })()",
        );
    }
}

/// Without the service nothing that is shown is taken for the present, and a stop says that it was none.
fn gone(browser: &mut Browser) {
    browser
        .until("document.querySelector('#connection').textContent.startsWith('connection lost')");
    browser.until("!document.querySelector('#old').hidden");
    let old = browser.text("#old");
    assert!(
        old.starts_with("The service does not answer. What is shown is of "),
        "{old}"
    );
    let grey = "['.views', '#moves', '#tick'].map((of) => getComputedStyle(document.querySelector(of)).filter)";
    let grey: Value = browser.value(grey);
    assert_eq!(
        grey,
        json!(["grayscale(1)", "grayscale(1)", "grayscale(1)"])
    );
    let disabled = "[...document.querySelectorAll('.controls button')].map((one) => one.disabled)";
    let disabled = browser.value(disabled);
    assert_eq!(
        disabled,
        json!([vec![false], vec![true; 9]].concat()),
        "only Stop can be pressed"
    );
    browser.click("#stop", 1);
    browser.until(
        "document.querySelector('#said').textContent === 'NOT stopped from here: the service does not answer.'",
    );
    browser.assert_sound();
}
