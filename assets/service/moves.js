// What the last moves left, as bars.

import { $, degrees, element, number } from "./dom.js";

const BARS = 10; // moves that are shown

/** The moves of a joint that ran to their end, oldest first: what another one leaves says nothing of its shaping. */
export const whole = (moves, joint) => moves.filter((move) => move.joint === joint && !move.interrupted);

/**
 * The share of the vibration after the end without shaping that a move has left there, percent, and words on how well it is known. What
 * it would have been without shaping is an estimate: two standard deviations more or less by the modes, and as if the motor side had
 * followed exactly. Where it may have been none there is no share. The vibration on the way is another figure: after a long cruise it is
 * mostly larger than what is left.
 */
export function share(move) {
  const { residual_rad: left, unshaped_rad: without, unshaped_std_rad: std } = move;
  const most = without - 2 * (std ?? 0);
  if (left === null || !(most > 0)) return { percent: "–", note: "not known: its modes are not known well enough" };
  if (left === 0) return { percent: "0", note: "below the noise of the sensor" };
  const percent = (of) => number((100 * left) / of, 2);
  const [low, high] = [percent(without + 2 * (std ?? 0)), percent(most)];
  return { percent: percent(without), note: `of the estimated vibration without shaping${low === high ? "" : ` (${low} to ${high}, if the motor side follows exactly)`}` };
}

/** The bars of a move: what is drawn, in which colour, and words behind it. */
function bars(move, of) {
  const [left, without, most] = ["residual", "unshaped", "vibration"].map((what) => of(move, what));
  const known = move.shaped && left ? share(move).percent : ""; // below the noise the share says no more
  const words = { "": "", "–": ", share not known" }[known] ?? `, ${known} %`;
  const own = { value: left, kind: move.shaped ? "with" : "without", words, onWay: left !== null && most > 1.1 * left ? most : null };
  return move.shaped && without !== null ? [{ value: without, kind: "without", words: "" }, own] : [own];
}

/** Shows the last moves of a joint, newest first. */
export function showMoves(moves, joint) {
  const all = moves.filter((move) => move.joint === joint);
  const shown = JSON.stringify([joint, all]);
  if ($("bars").dataset.shown === shown) return;
  $("bars").dataset.shown = shown;
  const drawn = whole(all, joint).slice(-BARS).reverse();
  const out = all.filter((move) => move.interrupted).length;
  const note = [drawn.length ? "" : "No move yet.", out ? `Not shown: ${out} ${out === 1 ? "move that was" : "moves that were"} interrupted.` : ""];
  const inMetres = drawn.every((move) => move.residual_rad === null || move.residual_m !== null);
  const of = (move, what) => move[`${what}_${inMetres ? "m" : "rad"}`] ?? null;
  const most = Math.max(...drawn.flatMap((move) => bars(move, of).map(({ value }) => value ?? 0)), 1e-12);
  const rows = drawn.flatMap((move) => [name(move), track(bars(move, of), most, inMetres ? "mm" : "mrad")]);
  $("bars").replaceChildren(...rows);
  $("bars-note").textContent = note.filter(Boolean).join(" ");
  $("bars-keys").hidden = !drawn.length;
}

function name(move) {
  const words = [move.shaper === "none" ? "unshaped" : move.shaper.toUpperCase().replaceAll("_", " "), move.shaped && move.adaptive ? "adaptive" : "", move.payload_kg ? `${number(move.payload_kg)} kg` : ""];
  const box = element("div", `${degrees(move.from_rad)}° to ${degrees(move.target_rad)}°`, { class: "name" });
  box.append(element("small", words.filter(Boolean).join(", ")));
  return box;
}

function track(bars, most, unit) {
  const box = element("div", "", { class: "track" });
  for (const { value, kind, words, onWay } of bars) {
    const row = element("div", "", { class: "bar" });
    const colour = element("i", "", { class: kind });
    colour.style.width = `${(72 * (value ?? 0)) / most}%`;
    const left = value === null ? "not measured" : value === 0 ? "below the noise" : `${number(1e3 * value, 2)} ${unit}`;
    const before = onWay ? `; ${number(1e3 * onWay, 2)} ${unit} on its way` : "";
    row.append(colour, element("span", left + words + before));
    box.append(row);
  }
  return box;
}
