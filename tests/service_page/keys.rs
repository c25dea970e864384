//! Space and Escape, pressed wherever the focus can be.

use super::browser::{Browser, ESCAPE, SPACE};
use super::{RESTS, silence, until};
use serde_json::json;

/// The elements that can have the focus; all are on the page, the report in its frame included.
const FOCUSED: &[&str] = &[
    "#stop",
    "#enable",
    "#target",
    "#move .primary",
    "[data-by]",
    "#shaping",
    "#adaptation",
    "#shaper",
    "#payload",
    "#record",
    "#recordings button",
    "#recordings a",
    "#report",
    "#show-report",
];

/// All that a key could change on the page but what is said.
const SHOWN: &str = "JSON.stringify([scrollY, ...[...document.querySelectorAll('input, select')].map((one) => \
    [one.value, one.checked]), document.querySelector('#report-frame').hidden, \
    document.querySelector('#record').textContent])";

const SAID: &str = "document.querySelector('#said').textContent === 'Nothing was moving.'";

/// From every focus a key that is held sends one stop, and changes nothing else on the page.
pub fn space_and_escape_stop_and_do_nothing_else(browser: &mut Browser) {
    until(browser, RESTS);
    // The state is asked for by this test; what the page sends is what counts.
    browser.value("document.activeElement.blur()");
    one_stop(browser, "nothing");
    for selector in FOCUSED {
        browser.value(&format!("document.querySelector('{selector}').focus()"));
        let focused = format!("document.activeElement === document.querySelector('{selector}')");
        assert_eq!(
            browser.value(&focused),
            json!(true),
            "{selector} takes the focus"
        );
        one_stop(browser, selector);
    }
    // A click puts the focus into the report.
    browser.click("#report-frame", 1);
    browser.until("document.activeElement.id === 'report-frame'");
    one_stop(browser, "the report's frame");
}

fn one_stop(browser: &mut Browser, focus: &str) {
    for key in [SPACE, ESCAPE] {
        silence(browser);
        browser.commands();
        let before = browser.value(SHOWN);
        browser.press(key, 5);
        browser.until(SAID);
        assert_eq!(
            browser.commands(),
            ["POST /api/v1/stop"],
            "{} on {focus}",
            key.1
        );
        assert_eq!(browser.value(SHOWN), before, "{} on {focus}", key.1);
    }
}

/// Moves by a step end at sums of angles that are not exact; the field shows what was meant.
pub fn numbers_are_those_that_people_read(browser: &mut Browser) {
    browser.value("document.querySelector('#target').value = '0.1'");
    browser.click("#move .primary", 1);
    arrived(browser, "0.1");
    for (step, expected) in [
        ("10", "10.1"),
        ("10", "20.1"),
        ("-10", "10.1"),
        ("-10", "0.1"),
    ] {
        silence(browser);
        browser.click(&format!("[data-by=\"{step}\"]"), 1);
        browser.until("document.querySelector('#said').textContent.startsWith('The move takes ')");
        let shown = browser.value("document.querySelector('#target').value");
        assert_eq!(shown, json!(expected), "a step of {step}");
        arrived(browser, expected);
    }
    until(browser, RESTS);
}

/// Waits until the page has heard that the joint rests there.
fn arrived(browser: &mut Browser, target: &str) {
    browser.until(&format!(
        "document.querySelector('#figures').textContent.includes('target {target} deg') \
         && document.querySelector('#phase').textContent === 'rest'"
    ));
}
