// The page: what the service says, and what it is asked for.

import { ask, command, stop, token, withToken } from "./ask.js";
import { Live, Trace, drawTrain, impulses } from "./charts.js";
import { $, DEG, announce, degrees, element, number, rounded, say } from "./dom.js";
import "./keys.js";
import { share, showMoves, whole } from "./moves.js";
import { jogs } from "./jog.js";
import { forgets, showModes } from "./modes.js";
import { lastDiagnosis, listRecordings } from "./recordings.js";

const QUIET = 4000; // ms without a word after which a connection counts as lost
const STALE = 400; // ms for which a control keeps what was asked for, until the service says it
const SETTLED = 200; // ms for which a slider rests before its value is sent

let state = null;
let joint = 0;
let traces = [];
let drawn = false;
let asked = 0;

// --- what the service says ---

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}${withToken("/api/v1/stream")}`);
  let heard = Date.now();
  // A service that is gone does not close: its silence is the end.
  const watch = setInterval(() => Date.now() - heard > QUIET && lost(), 500);
  socket.onmessage = (event) => {
    heard = Date.now();
    take(JSON.parse(event.data));
  };
  socket.onopen = () => connection(true);
  socket.onclose = lost;
  function lost() {
    socket.onmessage = socket.onopen = socket.onclose = null;
    clearInterval(watch);
    socket.close();
    connection(false);
    // A refused WebSocket does not say why; a plain request does.
    ask("/api/v1/state").catch(() => {});
    setTimeout(connect, 1000);
  }
}

/** Whether the service is there. Where it is not, all that is shown is old: it is grey, and says of when it is. */
function connection(there) {
  const pill = $("connection");
  pill.textContent = there ? "connected" : "connection lost, trying again";
  pill.className = there ? "pill good" : "pill bad";
  // What was said of the last command is old as well, once.
  if (!there && !document.body.classList.contains("old")) say("");
  document.body.classList.toggle("old", !there);
  for (const control of document.querySelectorAll(".controls button, .controls input, .controls select")) control.disabled = !there && control.id !== "stop";
  const at = state && new Date(1e3 * state.unix_time_s).toLocaleTimeString();
  announce("old", there || !at ? [] : [`The service does not answer. What is shown is of ${at}: the robot may be doing something else.`]);
  if (there) listRecordings();
}

function take(message) {
  if (message.type === "state") {
    // The service has begun anew, perhaps with other joints.
    if (state && message.state.time_s < state.time_s) traces = [];
    state = message.state;
    showState();
  } else if (message.type === "batch") {
    for (const frame of message.frames) (traces[frame.joint] ||= new Trace()).push(frame);
    if (message.events.some((event) => event.event === "move_ended")) setTimeout(listRecordings, 1500); // it rests for a second in the recording
    drawn = false;
  } else if (message.type === "lost") {
    announce("slow", [`This page was too slow: ${message.batches} batches were left out.`]);
  }
}

function showState() {
  const names = state.joints.map((one) => one.name);
  if ([...$("joint").options].map((one) => one.value).join() !== names.join()) {
    $("joint").replaceChildren(...names.map((name) => element("option", name, { value: name })));
  }
  $("joint-row").hidden = names.length < 2;
  joint = Math.max(0, $("joint").selectedIndex);
  const now = state.joints[joint];
  if (!now) return;
  $("about").textContent = `${state.robot} robot, ${now.name}, version ${state.version}`;
  showEnabled(state.enable);
  $("phase").hidden = false;
  $("phase").textContent = now.phase;
  $("phase").className = now.phase === "rest" ? "pill quiet" : "pill plain";
  const { rate_hz: rate, overruns, lateness_p99_s: late } = state.tick;
  $("tick").hidden = !rate;
  $("tick").className = "pill quiet";
  $("tick").textContent = `${number(rate, 4)} Hz, 99 % of ticks within ${number(1e6 * late, 2)} µs, ${overruns} overrun${overruns === 1 ? "" : "s"}`;
  showControls(now);
  showTrouble(now);
  showFigures(now);
  showMoves(state.moves, now.name);
  showModes(now);
  $("train-words").textContent = now.mode ? `${now.shaper.toUpperCase().replaceAll("_", " ")} for ${number(now.mode.frequency_hz, 4)} Hz, damping ${number(now.mode.damping_ratio)}` : "";
  // Drawn anew only where it has changed, so that it can be selected and read.
  const train = JSON.stringify(now.train);
  if ($("train").dataset.shown !== train) {
    $("train").dataset.shown = train;
    drawTrain($("train"), impulses(now.train, 1 / state.tick.rate_hz));
  }
  showHealth(now);
}

function showControls(now) {
  if (Date.now() - asked < STALE) return;
  $("range").textContent = `from ${now.range_rad.map(degrees).join(" to ")}`;
  $("shaping").checked = now.shaping;
  $("adaptation").checked = now.adaptation;
  $("shaper").value = now.shaper;
  if (!$("feed").matches(":active")) $("feed").value = state.feed_percent;
  $("feed-value").textContent = `${$("feed").value} % of full speed`;
  $("demo-row").hidden = state.robot !== "embedded";
  $("payload-row").hidden = state.robot !== "embedded";
  if (state.payload_kg !== null && !$("payload").matches(":active")) {
    $("payload").value = state.payload_kg;
    showPayload();
  }
}

function showPayload() {
  $("payload-value").textContent = `${$("payload").value} kg`;
}

/** Whether moves may begin, and the one thing that can be done about it. */
function showEnabled({ state: enabled, reason }) {
  $("enabled").hidden = false;
  $("enabled").textContent = enabled;
  $("enabled").className = { enabled: "pill good", disabled: "pill quiet", faulted: "pill bad" }[enabled];
  $("enable").textContent = { enabled: "Disable moves", disabled: "Enable moves", faulted: "Reset the fault" }[enabled];
  $("enable").className = enabled === "enabled" ? "" : "primary";
  announce("fault", enabled === "faulted" ? [`Fault: ${reason}. The robot was stopped; see to it, then reset the fault, then enable moves.`] : []);
}

/** What is wrong now, or nothing. */
function showTrouble(now) {
  const wrong = [];
  if (state.stopping) wrong.push("The service is ending: the robot is brought to rest.");
  for (const fault of state.disk?.faults ?? []) {
    const what = fault.what === "recordings" ? "Moves are not recorded" : "What is learned is not kept";
    wrong.push(`${what} since ${new Date(1e3 * fault.since_unix_time_s).toLocaleString()}: ${fault.reason}.`);
  }
  if (now.watchdog === "silent") wrong.push("No measurements come: adaptation waits.");
  if (now.watchdog === "stopped") wrong.push("No measurements come.");
  for (const sensor of now.sensors) if (sensor.fault) wrong.push(`${sensor.name.replaceAll("_", " ")}: ${sensor.fault === "not_finite" ? "it sends no number" : `${sensor.fault}; its data are refused`}.`);
  announce("trouble", wrong);
  const advice = [];
  if (!state.tick.real_time || !state.tick.memory_locked) {
    const rights = [!state.tick.real_time && "no real-time priority", !state.tick.memory_locked && "no locked memory"].filter(Boolean);
    if (state.tick.skipped) advice.push(`The tick has ${rights.join(" and ")}, and ${state.tick.skipped} ticks were skipped: see docs/src/guide/real-time.md.`);
  }
  if (now.limits_assumed) {
    const [velocity, acceleration] = now.limits.map((limit) => number(limit * DEG));
    advice.push(`No limits were given for ${now.name}: those of the embedded arm are in force (${velocity} deg/s, ${acceleration} deg/s²). Set velocity_deg_s, acceleration_deg_s2 and jerk_deg_s3.`);
  }
  if (now.awaits_registration) advice.push("Where the tip's sensor stands is not known yet: nothing is learned from it. A long move tells it; service.description must say where the tip is.");
  announce("advice", advice);
}

function figure(name, value, unit, note) {
  const box = element("div");
  const number = element("dd", value, { class: "value" });
  number.append(" ", element("small", unit));
  box.append(element("dt", name), number, element("dd", note, { class: "note" }));
  return box;
}

function showFigures(now) {
  const { estimate, mode } = now;
  const truth = now.true_mode ? `simulated with ${number(now.true_mode.frequency_hz, 4)} Hz` : "";
  const word = !estimate ? "move to learn it" : estimate.refused || (estimate.converged ? "settled" : "not yet settled");
  const last = whole(state.moves, now.name).filter((move) => move.residual_rad !== null).pop();
  const left = last?.shaped ? share(last) : null;
  $("figures").replaceChildren(
    // Before the robot has said where it stands nothing is commanded.
    now.phase === "waiting" ? figure("position", "–", "deg", "not heard yet") : figure("position", degrees(now.command_rad), "deg", `target ${degrees(now.target_rad)} deg`),
    figure("estimated frequency", estimate ? number(estimate.frequency_hz, 4) : "–", "Hz", [word, truth].filter(Boolean).join("; ")),
    figure("damping ratio", estimate ? number(estimate.damping_ratio) : "–", "", estimate ? `± ${number(estimate.damping_ratio_std, 2)}` : ""),
    figure("shaped for", mode ? number(mode.frequency_hz, 4) : "–", "Hz", `trains learned: ${now.retunes}`),
    figure("vibration left, last move", left ? left.percent : "–", "%", left?.note ?? "of the vibration without shaping"),
  );
}

function showHealth(now) {
  const { link } = state;
  const counted = ["lost", "late", "doubled", "reordered", "foreign", "malformed", "unsigned"].filter((what) => link[what]).map((what) => `${link[what]} ${what}`);
  const refused = (sensor) => sensor.refused.reduce((sum, [, count]) => sum + count, 0);
  const sensors = now.sensors.map((sensor) => `${sensor.name.replaceAll("_", " ")} ${number(sensor.rate_hz)} Hz${refused(sensor) ? `, ${refused(sensor)} readings refused` : ""}`);
  const words = [`link: ${counted.join(", ") || "nothing lost"}`, sensors.join(", "), `${state.tick.skipped} ticks skipped`];
  $("health").textContent = words.filter(Boolean).join("; ");
}

// --- drawing ---

const charts = {
  position: new Live($("position"), [{ name: "planned", colour: "c2", width: 5, alpha: 0.5 }, { name: "command", colour: "c0" }, { name: "measured (motor)", colour: "c1", width: 1 }], { least: 2 }),
  deformation: new Live($("deformation"), [{ name: "link minus motor", colour: "c2" }], { least: 0.2 }),
  estimate: new Live($("estimate"), [{ name: "estimate", colour: "c0" }, { name: "high" }, { name: "low" }], {
    least: 0.5,
    bands: [[2, 3, "c0"]],
    level: () => state?.joints[joint]?.true_mode?.frequency_hz ?? null,
    levelName: "truth, where the arm is simulated",
  }),
};

function draw() {
  requestAnimationFrame(draw);
  if (drawn || document.hidden) return;
  drawn = true;
  // A joint that was never heard has no curves.
  const trace = traces[joint] ?? new Trace();
  const { rows } = trace;
  const ago = trace.ago();
  $("deformation-unit").textContent = { mm: " of the tip, mm", mrad: ", mrad" }[trace.unit] ?? "";
  charts.position.draw([ago, rows.planned, rows.command, rows.motor]);
  charts.deformation.draw([ago, trace.deformation()]);
  charts.estimate.draw([ago, rows.frequency, rows.high, rows.low]);
}

// --- what the service is asked for ---

function move(target) {
  const name = state?.joints[joint]?.name;
  if (!name) return;
  // What is sent is what is shown.
  const target_deg = rounded(target);
  $("target").value = target_deg;
  command("/api/v1/move", { joint: name, target_deg }, (answer) => `The move takes ${number(answer.duration_s)} s${answer.speed < 1 ? ` at ${number(100 * answer.speed)} % of full speed` : ""}.`);
}

function change(what) {
  asked = Date.now();
  command("/api/v1/shaper", what, () => "Changed; in force with the next move from rest.");
}

let settling;

/** Sends the payload once the slider rests. */
function carry() {
  asked = Date.now();
  showPayload();
  clearTimeout(settling);
  settling = setTimeout(() => command("/api/v1/payload", { mass_kg: Number($("payload").value) }, () => "Another payload."), SETTLED);
}

$("move").onsubmit = (event) => {
  event.preventDefault();
  move(Number($("target").value));
};
$("stop").onclick = stop;
$("enable").onclick = () => {
  if (!state) return;
  // What is asked for is what the button says.
  const [path, done] = {
    enabled: ["/api/v1/disable", "Moves are disabled."],
    disabled: ["/api/v1/enable", "Moves are enabled."],
    faulted: ["/api/v1/reset", "The fault was reset. Moves are disabled."],
  }[state.enable.state];
  command(path, {}, () => done);
};
for (const button of document.querySelectorAll("[data-by]")) {
  button.onclick = () => state && move(state.joints[joint].target_rad * DEG + Number(button.dataset.by));
}
$("feed").onchange = () => {
  asked = Date.now();
  const percent = Number($("feed").value);
  $("feed-value").textContent = `${percent} % of full speed`;
  command("/api/v1/feed", { percent }, () => (percent ? "In force." : "Everything stops."));
};
$("demo").onclick = () => command("/api/v1/demo", {}, () => "Unshaped, wrong belief, adapted: some ten seconds.");
jogs(() => state?.joints[joint]);
forgets(() => state?.joints[joint]);
$("joint").onchange = () => {
  drawn = false;
  if (state) showState();
};
$("shaping").onchange = () => change({ enabled: $("shaping").checked });
$("adaptation").onchange = () => change({ adaptation: $("adaptation").checked });
$("shaper").onchange = () => change({ kind: $("shaper").value });
$("payload").oninput = () => {
  asked = Date.now();
  showPayload();
};
$("payload").onchange = carry;
$("token-form").onsubmit = (event) => {
  event.preventDefault();
  token.set($("token").value);
  $("token-form").hidden = true;
};

// Stop, and what it said, stay in sight where their place is not.
const place = $("stop-place");
new IntersectionObserver(([seen]) => place.classList.toggle("away", seen.intersectionRatio < 1), { threshold: 1 }).observe(place);

connect();
lastDiagnosis();
requestAnimationFrame(draw);
