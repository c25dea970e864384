// A joint moves while its button is pressed: the service is told so ten times a second, and stops the joint where it
// is not told any more.

import { ask } from "./ask.js";
import { DEG, say } from "./dom.js";

const AGAIN = 100; // ms between two words that the button is still pressed
const SHARE = 0.2; // of the joint's limit of velocity: a person watches

let held = null;

function send(velocity_deg_s) {
  const { joint, hold } = held;
  return ask("/api/v1/jog", { method: "POST", body: { joint, velocity_deg_s, hold } });
}

function press(joint, button) {
  if (held || !joint) return;
  const sign = Number(button.dataset.jog);
  // No other press has this number.
  held = { joint: joint.name, hold: Math.floor(Date.now() * 1000 + Math.random() * 1000), velocity: sign * SHARE * joint.limits[0] * DEG };
  say("Jogging while the button is pressed.");
  const again = () => {
    // Without a connection the buttons are disabled, and one that is does not say when it is let go.
    if (button.disabled) return release();
    send(held.velocity).catch((error) => {
      say(error.message, true);
      release();
    });
  };
  held.timer = setInterval(again, AGAIN);
  again();
}

function release() {
  if (!held) return;
  clearInterval(held.timer);
  // Where this is lost the joint stops all the same.
  send(0).catch(() => {});
  held = null;
}

/** The buttons that jog the joint that is chosen. */
export function jogs(joint) {
  for (const button of document.querySelectorAll("[data-jog]")) {
    button.onpointerdown = (event) => event.button === 0 && press(joint(), button);
    button.addEventListener("pointerleave", release);
    button.oncontextmenu = (event) => event.preventDefault();
  }
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, release, { capture: true });
  addEventListener("blur", release);
  document.addEventListener("visibilitychange", release);
}
