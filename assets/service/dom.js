// What every part of the page uses: elements, numbers as people read them, and the line that says what became
// of a command.

export const DEG = 180 / Math.PI;

export const $ = (id) => document.getElementById(id);

export function element(kind, text = "", attributes = {}) {
  const made = document.createElement(kind);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/** A few significant digits; what is not known is a dash. */
export const number = (value, digits = 3) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits))));

/** A value to a thousandth, so that rounding does not show; never minus zero. */
export const rounded = (value) => Math.round(value * 1e3) / 1e3 + 0;

/** An angle, rad, in degrees. */
export const degrees = (angle) => String(rounded(angle * DEG));

/** Says what became of a command. */
export function say(text, bad = false) {
  $("said").textContent = text;
  $("said").className = bad ? "note bad" : "note";
}

/** Shows sentences, or nothing. A text that has not changed is not read out again. */
export function announce(where, sentences) {
  const text = sentences.join(" ");
  if ($(where).textContent !== text) $(where).textContent = text;
  $(where).hidden = !sentences.length;
}
