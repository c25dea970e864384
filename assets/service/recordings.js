// Recordings, and what a diagnosis says of them.

import { ask, withToken } from "./ask.js";
import { $, element, number, say } from "./dom.js";

/** Why a move did not end at its target. */
const INTERRUPTED = { fault: "fault", replaced: "another move", stopped: "stopped" };

export async function listRecordings() {
  let list;
  try {
    list = await ask("/api/v1/recordings");
  } catch {
    return;
  }
  $("no-recordings").hidden = list.length > 0;
  $("recordings").replaceChildren(...list.reverse().slice(0, 50).map((entry) => {
    const row = element("tr");
    const what = element("td", `${entry.joint}, ${new Date(1e3 * entry.unix_time_s).toLocaleString()}`);
    what.append(element("small", entry.name));
    const { result } = entry;
    const left = !result ? "–" : result.interrupted ? `–, ${INTERRUPTED[result.ended] ?? "interrupted"}` : vibration(result);
    const button = element("button", "Diagnose", { type: "button", "aria-label": `Diagnose ${entry.name}` });
    button.onclick = () => diagnose(entry.name);
    const link = element("a", "Download", { href: withToken(`/api/v1/recordings/${entry.name}`), download: "", "aria-label": `Download ${entry.name}` });
    const actions = element("td");
    actions.append(button, " ", link);
    row.append(what, element("td", left, { class: "number", "data-name": "vibration left", title: result?.fault ?? "" }), element("td", `${number(entry.duration_s)} s`, { class: "number", "data-name": "length" }), actions);
    return row;
  }));
}

/** What a move has left, in words. */
function vibration({ residual_m: metres, residual_rad: radians }) {
  const [value, unit] = metres != null ? [metres, "mm"] : [radians, "mrad"];
  if (value == null) return "–";
  return value === 0 ? "below the noise" : `${number(1e3 * value, 2)} ${unit}`;
}

$("record").onclick = async () => {
  const on = $("record").getAttribute("aria-pressed") !== "true";
  try {
    const body = on ? { joint: $("joint").value || undefined, recording: true } : { recording: false };
    showRecording(on, await ask("/api/v1/recordings", { method: "POST", body }));
    if (!on) setTimeout(listRecordings, 500);
  } catch (error) {
    if (error.status) showRecording(false);
    say(error.message, true);
  }
};

function showRecording(on, answer) {
  $("record").setAttribute("aria-pressed", String(on));
  $("record").textContent = on ? `End recording ${answer.name}` : "Start a recording";
}

async function diagnose(recording) {
  try {
    follow(await ask("/api/v1/diagnose", { method: "POST", body: { recording } }));
  } catch (error) {
    verdict("bad", error.message);
  }
  $("diagnosis").scrollIntoView({ block: "nearest" });
}

function verdict(kind, text) {
  $("diagnosis").hidden = false;
  $("job").hidden = true;
  $("verdict").className = `verdict ${kind}`;
  $("verdict").replaceChildren(element("span", text));
  $("verdict").hidden = false;
}

const KINDS = { no_mismatch: "good", named: "plain", ambiguous: "plain", partly_explained: "bad", unexplained: "bad", not_excited: "bad" };
const FOLLOW = 500; // ms between questions how a job stands
let followed = 0;

function showJob(job) {
  const time = job.limit_s === null ? "" : `, ${Math.round(job.seconds)} s of at most ${number(job.limit_s)} s`;
  $("doing").textContent = `Diagnosing ${job.recording}: ${job.doing}${time}`;
  $("progress").value = job.progress;
}

/** Shows a job until it has ended. */
async function follow(job) {
  followed = job.id;
  $("diagnosis").hidden = $("job").hidden = false;
  $("verdict").hidden = $("report-row").hidden = $("report-frame").hidden = true;
  $("report-frame").removeAttribute("src");
  $("show-report").setAttribute("aria-expanded", "false");
  $("show-report").textContent = "Show it here";
  while (followed === job.id && (job.status === "waiting" || job.status === "running")) {
    showJob(job);
    await new Promise((resolve) => setTimeout(resolve, FOLLOW));
    try {
      job = await ask(`/api/v1/diagnose/${job.id}`);
    } catch (error) {
      // Without an answer nothing is known of it: it is asked again.
      if (error.status) return verdict("bad", error.message);
    }
  }
  if (followed === job.id) showEnd(job);
}

function showEnd(job) {
  if (job.status === "cancelled") return verdict("plain", `${job.recording}: the diagnosis was cancelled.`);
  if (job.status === "failed") return verdict("bad", `${job.recording}: ${job.error}`);
  verdict(KINDS[job.diagnosis.verdict], `${job.recording}: ${job.diagnosis.summary}`);
  $("report-row").hidden = false;
  $("report").href = withToken(`/api/v1/diagnose/${job.id}/report`);
}

$("cancel").onclick = async () => {
  try {
    showJob(await ask(`/api/v1/diagnose/${followed}`, { method: "DELETE" }));
  } catch (error) {
    say(error.message, true);
  }
};

$("show-report").onclick = () => {
  const show = $("report-frame").hidden;
  $("report-frame").hidden = !show;
  $("show-report").setAttribute("aria-expanded", String(show));
  $("show-report").textContent = show ? "Hide it" : "Show it here";
  if (show) $("report-frame").src = $("report").href;
};

/** The last diagnosis, where the page was left while it ran. */
export async function lastDiagnosis() {
  try {
    const last = (await ask("/api/v1/diagnose")).pop();
    if (last) follow(await ask(`/api/v1/diagnose/${last.id}`));
  } catch {
    // There is none to show, or no connection, which is told elsewhere.
  }
}
