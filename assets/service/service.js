"use strict";
// The page: what the service says, and what it is asked for.

const $ = (id) => document.getElementById(id);
const QUIET = 4000; // ms without a word after which a connection counts as lost
const BARS = 10; // moves that are shown as bars
const STALE = 400; // ms for which a switch keeps what was asked for, until the service says it

let state = null;
let joint = 0;
let traces = [];
let drawn = false;
let asked = 0;
const token = { get: () => sessionStorage.getItem("quell-token"), set: (text) => sessionStorage.setItem("quell-token", text) };

/** Adds the token to an address that the browser itself asks for. */
const withToken = (path) => (token.get() ? `${path}?token=${encodeURIComponent(token.get())}` : path);

function element(kind, text = "", attributes = {}) {
  const made = document.createElement(kind);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/** A few significant digits; what is not known is a dash. */
const number = (value, digits = 3) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits))));

/** An angle, rad, in degrees to a thousandth, so that rounding does not show. */
const degrees = (angle) => String(Math.round(angle * DEG * 1e3) / 1e3 + 0);

async function ask(path, body) {
  const headers = token.get() ? { Authorization: `Bearer ${token.get()}` } : {};
  const options = body === undefined ? { headers } : { method: "POST", headers: { ...headers, "Content-Type": "application/json" }, body: JSON.stringify(body) };
  const response = await fetch(path, options);
  if (response.status === 401) wantToken();
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.error);
  return answer;
}

function say(text, bad = false) {
  $("said").textContent = text;
  $("said").className = bad ? "note bad" : "note";
}

/** Asks for something, and says what became of it. */
async function command(path, body, done) {
  try {
    const answer = await ask(path, body);
    say(done(answer));
  } catch (error) {
    say(error.message, true);
  }
}

// --- what the service says ---

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}${withToken("/api/stream")}`);
  let heard = Date.now();
  const watch = setInterval(() => Date.now() - heard > QUIET && socket.close(), 1000);
  socket.onopen = () => connection(true);
  socket.onmessage = (event) => {
    heard = Date.now();
    take(JSON.parse(event.data));
  };
  socket.onclose = () => {
    clearInterval(watch);
    connection(false);
    // A refused WebSocket does not say why; a plain request does.
    ask("/api/state").catch(() => {});
    setTimeout(connect, 1000);
  };
}

function connection(there) {
  const pill = $("connection");
  pill.textContent = there ? "connected" : "connection lost, trying again";
  pill.className = there ? "pill good" : "pill bad";
  for (const control of document.querySelectorAll(".controls button, .controls input, .controls select")) control.disabled = !there && control.id !== "stop";
  if (!there) $("phase").hidden = true;
  else listRecordings();
}

function take(message) {
  if (message.type === "state") {
    state = message.state;
    showState();
  } else if (message.type === "batch") {
    for (const frame of message.frames) (traces[frame.joint] ||= new Trace()).push(frame);
    if (message.events.some((event) => event.event === "move_ended")) setTimeout(listRecordings, 1500); // it rests for a second in the recording
    drawn = false;
  } else if (message.type === "lost") {
    say(`this page was too slow: ${message.batches} batches were left out`);
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
  $("phase").hidden = false;
  $("phase").textContent = now.phase;
  $("phase").className = now.phase === "rest" ? "pill quiet" : "pill plain";
  const { rate_hz: rate, overruns, lateness_p99_s: late } = state.tick;
  $("tick").hidden = !rate;
  $("tick").className = "pill quiet";
  $("tick").textContent = `${number(rate, 4)} Hz, ${number(1e6 * late)} µs late at p99, ${overruns} overruns`;
  showControls(now);
  showTrouble(now);
  showFigures(now);
  showBars(now);
  $("train-words").textContent = now.mode ? `${now.shaper.toUpperCase().replaceAll("_", " ")} for ${number(now.mode.frequency_hz, 4)} Hz, damping ${number(now.mode.damping_ratio)}` : "";
  // Drawn anew only where it has changed, so that it can be selected and read.
  const train = JSON.stringify(now.train);
  if ($("train").dataset.shown !== train && now.train.times_s.length) {
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
  if (document.activeElement !== $("shaper")) $("shaper").value = now.shaper;
  $("payload-row").hidden = state.payload_kg === null;
  if (document.activeElement !== $("payload") && state.payload_kg !== null) {
    $("payload").value = state.payload_kg;
    showPayload();
  }
}

function showPayload() {
  $("payload-value").textContent = `${$("payload").value} kg`;
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
  if (now.watchdog === "stopped") wrong.push("No measurements come: the joint was stopped.");
  for (const sensor of now.sensors) if (sensor.fault) wrong.push(`${sensor.name.replaceAll("_", " ")}: ${sensor.fault}; its data are refused.`);
  say("trouble", wrong);
  const advice = [];
  if (now.limits_assumed) {
    const [velocity, acceleration] = now.limits.map((limit) => number(limit * DEG));
    advice.push(`No limits were given for ${now.name}: those of the embedded arm are in force (${velocity} deg/s, ${acceleration} deg/s²). Set velocity_deg_s, acceleration_deg_s2 and jerk_deg_s3.`);
  }
  if (now.awaits_registration) advice.push("Where the tip's sensor stands is not known yet: nothing is learned from it. A long move tells it; service.description must say where the tip is.");
  say("advice", advice);
}

/** Shows sentences, or nothing. A text that has not changed is not read out again. */
function say(where, sentences) {
  const text = sentences.join(" ");
  if ($(where).textContent !== text) $(where).textContent = text;
  $(where).hidden = !sentences.length;
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
  const truth = now.true_mode ? `in truth ${number(now.true_mode.frequency_hz, 4)} Hz` : "";
  const word = !estimate ? "move to learn it" : estimate.refused || (estimate.converged ? "settled" : "not yet settled");
  const last = state.moves.filter((move) => move.joint === now.name && move.unshaped_rad && move.residual_rad !== null).pop();
  const share = last && last.shaped ? number((100 * last.residual_rad) / last.unshaped_rad, 2) : null;
  $("figures").replaceChildren(
    figure("position", degrees(now.command_rad), "deg", `target ${degrees(now.target_rad)} deg`),
    figure("estimated frequency", estimate ? number(estimate.frequency_hz, 4) : "–", "Hz", [word, truth].filter(Boolean).join("; ")),
    figure("damping ratio", estimate ? number(estimate.damping_ratio) : "–", "", estimate ? `± ${number(estimate.damping_ratio_std, 2)}` : ""),
    figure("shaped for", mode ? number(mode.frequency_hz, 4) : "–", "Hz", `trains learned: ${now.retunes}`),
    figure("last move left", share ?? "–", "%", "of the vibration without shaping"),
  );
}

/** Bars of the last moves: what was left, and what would have been left without shaping. */
function showBars(now) {
  const moves = state.moves.filter((move) => move.joint === now.name).slice(-BARS).reverse();
  const shown = JSON.stringify(moves);
  if (!moves.length || $("bars").dataset.shown === shown) return;
  $("bars").dataset.shown = shown;
  const inMetres = moves.every((move) => move.residual_rad === null || move.residual_m !== null);
  const unit = inMetres ? "mm" : "mrad";
  const of = (move, what) => (move[`${what}_${inMetres ? "m" : "rad"}`] ?? null);
  const values = moves.flatMap((move) => [of(move, "residual"), of(move, "unshaped")]);
  const most = Math.max(...values.filter((value) => value !== null), 1e-12);
  $("bars").replaceChildren(...moves.flatMap((move) => {
    const words = [move.shaper === "none" ? "unshaped" : move.shaper.toUpperCase().replaceAll("_", " "), move.shaped && move.adaptive ? "adaptive" : "", move.payload_kg ? `${number(move.payload_kg)} kg` : "", move.interrupted ? "interrupted" : ""];
    const name = element("div", `${degrees(move.from_rad)}° to ${degrees(move.target_rad)}°`, { class: "name" });
    name.append(element("small", words.filter(Boolean).join(", ")));
    const track = element("div", "", { class: "track" });
    const bar = (value, kind, note) => {
      const row = element("div", "", { class: "bar" });
      const colour = element("i", "", { class: kind });
      colour.style.width = `${(72 * (value ?? 0)) / most}%`;
      row.append(colour, element("span", value === null ? "not measured" : `${number(1e3 * value, 2)} ${unit}${note}`));
      track.append(row);
    };
    const [left, without] = [of(move, "residual"), of(move, "unshaped")];
    if (move.shaped && without !== null) bar(without, "without", "");
    bar(left, move.shaped ? "with" : "without", move.shaped && without && left !== null ? `, ${number((100 * left) / without, 2)} %` : "");
    return [name, track];
  }));
  $("bars-keys").hidden = false;
}

function showHealth(now) {
  const { link } = state;
  const counted = ["lost", "late", "doubled", "reordered", "foreign", "malformed", "unsigned"].filter((what) => link[what]).map((what) => `${link[what]} ${what}`);
  const sensors = now.sensors.map((sensor) => `${sensor.name.replaceAll("_", " ")} ${number(sensor.rate_hz)} Hz`);
  const words = [`link: ${counted.join(", ") || "nothing lost"}`, sensors.join(", "), `${state.tick.skipped} ticks skipped`];
  $("health").textContent = words.filter(Boolean).join("; ");
}

// --- drawing ---

const charts = {
  position: new Live($("position"), [{ name: "planned", colour: "c4", width: 5, alpha: 0.5 }, { name: "command", colour: "c0" }, { name: "measured (motor)", colour: "c1", width: 1 }], { least: 2 }),
  deformation: new Live($("deformation"), [{ name: "link minus motor", colour: "c2" }], { least: 0.2 }),
  estimate: new Live($("estimate"), [{ name: "estimate", colour: "c3" }, { name: "high" }, { name: "low" }], {
    least: 0.5,
    bands: [[2, 3, "c3"]],
    level: () => state?.joints[joint]?.true_mode?.frequency_hz ?? null,
    levelName: "truth, where the arm is simulated",
  }),
};

function draw() {
  requestAnimationFrame(draw);
  const trace = traces[joint];
  if (drawn || !trace || document.hidden) return;
  drawn = true;
  const { rows } = trace;
  const ago = trace.ago();
  const inMetres = rows.tip.some((value) => value !== null);
  $("deformation-unit").textContent = inMetres ? " of the tip, mm" : ", mrad";
  charts.position.draw([ago, rows.planned, rows.command, rows.motor]);
  charts.deformation.draw([ago, inMetres ? rows.tip : rows.angle]);
  charts.estimate.draw([ago, rows.frequency, rows.high, rows.low]);
}

// --- what the service is asked for ---

function move(target) {
  const name = state?.joints[joint]?.name;
  if (!name) return;
  $("target").value = number(target, 6);
  command("/api/move", { joint: name, target_deg: target }, (answer) => `Moving, ${number(answer.duration_s)} s${answer.speed < 1 ? ` at ${number(100 * answer.speed)} % of full speed` : ""}.`);
}

function stop() {
  command("/api/stop", {}, (answer) => `Stopping, ${number(answer.duration_s)} s.`);
}

function change(what) {
  asked = Date.now();
  command("/api/shaper", what, () => "Changed; in force with the next move from rest.");
}

function wantToken() {
  $("token-form").hidden = false;
}

$("move").onsubmit = (event) => {
  event.preventDefault();
  move(Number($("target").value));
};
$("stop").onclick = stop;
for (const button of document.querySelectorAll("[data-by]")) {
  button.onclick = () => move(state.joints[joint].target_rad * DEG + Number(button.dataset.by));
}
$("joint").onchange = () => state && showState();
$("shaping").onchange = () => change({ enabled: $("shaping").checked });
$("adaptation").onchange = () => change({ adaptation: $("adaptation").checked });
$("shaper").onchange = () => change({ kind: $("shaper").value });
$("payload").oninput = showPayload;
$("payload").onchange = () => command("/api/payload", { mass_kg: Number($("payload").value) }, () => "Another payload.");
$("token-form").onsubmit = (event) => {
  event.preventDefault();
  token.set($("token").value);
  $("token-form").hidden = true;
};
document.addEventListener("keydown", (event) => {
  // Space belongs to whatever has the focus and understands it.
  const taken = event.target.closest("button, input, select, a, iframe");
  if (event.key === "Escape" || (event.key === " " && !taken)) {
    event.preventDefault();
    stop();
  }
});
