"use strict";
// In the frame of another page the keys that stop a robot are that page's.
if (parent !== window) {
  for (const kind of ["keydown", "keypress", "keyup"]) {
    addEventListener(kind, (event) => {
      if (event.key !== "Escape" && event.key !== " " && event.code !== "Space") return;
      event.preventDefault();
      event.stopImmediatePropagation();
      if (kind === "keydown" && !event.repeat) parent.postMessage("quell: stop", "*");
    }, { capture: true });
  }
}
