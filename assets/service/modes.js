// What the moves have taught of a joint's modes: a line each, and a map of their frequencies over the pose.

import { ask, command } from "./ask.js";
import { $, DEG, degrees, element, number } from "./dom.js";
import { angles, ticks } from "./ticks.js";

const [HEIGHT, LEFT, BELOW] = [240, 34, 30];
const SHOWN = 0.25; // a frequency whose two standard deviations are a larger share of it is none to show

const make = (kind, attributes, text = "") => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
};

let map = null;
new ResizeObserver(() => map && drawMap()).observe($("map"));

/** Shows what is known of a joint; where its modes have changed the map is asked for anew. */
export function showModes(now) {
  const { modes, held_reason: held, expected_percent: expected } = now.learning;
  $("modes").hidden = !modes.length;
  const shown = JSON.stringify([now.name, now.learning]);
  if ($("modes").dataset.shown === shown) return;
  $("modes").dataset.shown = shown;
  if (!modes.length) return;
  $("modes-rows").replaceChildren(...modes.map(row));
  const words = [expected === null ? "" : `Expected of the last move: ${number(expected, 2)} % of the vibration without shaping.`, held ? `No retune in motion: ${held}.` : ""];
  $("modes-note").textContent = words.filter(Boolean).join(" ");
  const path = `/api/v1/joints/${encodeURIComponent(now.name)}/map`;
  const take = (answer) => {
    map = answer;
    drawMap();
  };
  ask(path).then(take, () => {}); // the next change asks again
  $("map-json").href = path;
  $("map-csv").href = `${path}.csv`;
}

function row(mode, k) {
  const made = element("tr");
  const [first, last] = mode.along_hz;
  const along = Math.abs(last - first) > 4 * mode.frequency_std_hz ? `, ${number(first, 3)} to ${number(last, 3)} on the way` : "";
  const cells = [
    `${k + 1}`,
    `${number(mode.frequency_hz, 4)} ± ${number(mode.frequency_std_hz, 2)}${along}`,
    `${number(mode.damping_ratio)} ± ${number(mode.damping_ratio_std, 2)}`,
    `${number(mode.contribution_percent, 2)} %`,
    mode.shaped ? "yes" : "no: it hardly rings",
  ];
  const names = ["mode", "frequency, Hz", "damping ratio", "part of the vibration", "shaped for"];
  made.append(...cells.map((text, column) => element("td", text, { ...(column && column < 4 && { class: "number" }), "data-name": names[column] })));
  return made;
}

/** Frequencies over the pose, the band of two standard deviations, and what each move said. */
function drawMap() {
  // What was never near a move is not known.
  const parts = map.modes.map((mode) => mode.curve.filter((at) => 2 * at.frequency_std_hz < SHOWN * at.frequency_hz));
  const points = parts.flat();
  const width = Math.max($("map").clientWidth, 240);
  if (!points.length) return $("map").replaceChildren();
  const ends = (values) => [Math.min(...values), Math.max(...values)];
  const [from, to] = ends([...points.map((at) => at.position_rad), ...map.modes.flatMap((mode) => mode.moves.flatMap((move) => [move.from_rad, move.to_rad]))]);
  const [least, most] = around(points);
  const x = (position) => LEFT + ((position - from) / Math.max(to - from, 1e-9)) * (width - LEFT - 14);
  const y = (hertz) => (HEIGHT - BELOW) * (1 - (hertz - least) / (most - least)) + 6;
  const svg = make("svg", { width, height: HEIGHT, role: "img", "aria-label": `Frequencies of ${map.modes.length} modes from ${degrees(from)} to ${degrees(to)} degrees` });
  for (const hertz of ticks(least, most)) {
    svg.append(make("line", { class: "grid", x1: LEFT, x2: width, y1: y(hertz), y2: y(hertz) }), make("text", { x: LEFT - 8, y: y(hertz) + 4, "text-anchor": "end" }, String(hertz)));
  }
  for (const angle of angles(from * DEG, to * DEG)) {
    svg.append(make("text", { x: x(angle / DEG), y: HEIGHT - 8, "text-anchor": "middle" }, `${angle}°`.replace("-", "\u2212")));
  }
  parts.forEach((curve, k) => {
    const edge = (sign) => curve.map((at) => `${x(at.position_rad)},${y(at.frequency_hz + sign * 2 * at.frequency_std_hz)}`);
    svg.append(
      make("polygon", { class: `band m${k}`, points: [...edge(1), ...edge(-1).reverse()].join(" ") }),
      make("polyline", { class: `curve m${k}`, points: curve.map((at) => `${x(at.position_rad)},${y(at.frequency_hz)}`).join(" ") }),
      ...map.modes[k].moves.map(({ average }) => make("circle", { class: `m${k}`, cx: x(average.position_rad), cy: y(average.frequency_hz), r: 3.5 })),
    );
  });
  $("map").replaceChildren(svg);
}

/** The ends of the axis of frequency: those of the bands, and a tenth more, or a fiftieth of the frequency where that is more. */
function around(points) {
  const low = Math.min(...points.map((at) => at.frequency_hz - 2 * at.frequency_std_hz));
  const high = Math.max(...points.map((at) => at.frequency_hz + 2 * at.frequency_std_hz));
  const more = Math.max(0.1 * (high - low), 0.02 * high);
  return [Math.max(low - more, 0), high + more];
}

/** Has the button forget what was learned of the joint that is shown. */
export function forgets(joint) {
  $("forget").onclick = () => {
    const now = joint();
    if (now) command(`/api/v1/joints/${encodeURIComponent(now.name)}/forget`, {}, () => "Forgotten: the mode of the configuration is believed again.");
  };
}
