// The keyboard: space and Escape stop, from wherever the focus is, and do nothing else. No key and no click
// commands twice.

import { stop } from "./ask.js";
import { $ } from "./dom.js";

const stops = (event) => event.key === "Escape" || event.key === " " || event.code === "Space";

function onKey(event) {
  if (stops(event)) {
    // Also on release: there it would press the button that has the focus.
    event.preventDefault();
    event.stopImmediatePropagation();
    if (event.type === "keydown" && !event.repeat) stop();
  } else if (event.key === "Enter" && event.repeat) {
    event.preventDefault();
  }
}

/** The second click of a double click is a slip of the hand, but on the button that stops. */
function onClick(event) {
  if (event.detail > 1 && event.target.closest("button, .switch") && !event.target.closest("#stop")) {
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}

for (const kind of ["keydown", "keypress", "keyup"]) addEventListener(kind, onKey, { capture: true });
addEventListener("click", onClick, { capture: true });
// The report is a page of its own: it tells of its keys.
addEventListener("message", (event) => {
  if (event.source === $("report-frame").contentWindow && event.data === "quell: stop") stop();
});
