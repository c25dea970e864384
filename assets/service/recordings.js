"use strict";
// Recordings, and what a diagnosis says of them. The last file: it starts the page.

async function listRecordings() {
  let list;
  try {
    list = await ask("/api/recordings");
  } catch {
    return;
  }
  $("no-recordings").hidden = list.length > 0;
  $("recordings").replaceChildren(...list.reverse().slice(0, 50).map((entry) => {
    const row = element("tr");
    const what = element("td", `${entry.joint}, ${new Date(1e3 * entry.unix_time_s).toLocaleString()}`);
    what.append(element("small", entry.name));
    const { result } = entry;
    const left = result?.residual_m != null ? `${number(1e3 * result.residual_m, 2)} mm` : result?.residual_rad != null ? `${number(1e3 * result.residual_rad, 2)} mrad` : "–";
    const button = element("button", "Diagnose", { type: "button", "aria-label": `Diagnose ${entry.name}` });
    button.onclick = () => diagnose(entry.name);
    const link = element("a", "Download", { href: withToken(`/api/recordings/${entry.name}`), download: "", "aria-label": `Download ${entry.name}` });
    const actions = element("td");
    actions.append(button, " ", link);
    row.append(what, element("td", left, { class: "number", "data-name": "left" }), element("td", `${number(entry.duration_s)} s`, { class: "number", "data-name": "length" }), actions);
    return row;
  }));
}

$("record").onclick = async () => {
  const on = $("record").getAttribute("aria-pressed") !== "true";
  try {
    const answer = await ask("/api/recordings", { joint: on ? state.joints[joint].name : undefined, recording: on });
    $("record").setAttribute("aria-pressed", String(on));
    $("record").textContent = on ? `End recording ${answer.name}` : "Record on demand";
    if (!on) setTimeout(listRecordings, 500);
  } catch (error) {
    $("record").setAttribute("aria-pressed", "false");
    $("record").textContent = "Record on demand";
    say(error.message, true);
  }
};

async function diagnose(recording) {
  try {
    follow(await ask("/api/diagnose", { recording }));
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
let followed = 0;

/** Shows a job until it is done. */
async function follow(job) {
  followed = job.id;
  $("diagnosis").hidden = false;
  $("job").hidden = false;
  $("verdict").hidden = $("report-row").hidden = $("report-frame").hidden = true;
  $("report-frame").removeAttribute("src");
  $("show-report").setAttribute("aria-expanded", "false");
  while (followed === job.id && (job.status === "waiting" || job.status === "running")) {
    $("doing").textContent = `Diagnosing ${job.recording}: ${job.doing}`;
    $("progress").value = job.progress;
    await new Promise((resolve) => setTimeout(resolve, 500));
    try {
      job = await ask(`/api/diagnose/${job.id}`);
    } catch (error) {
      return verdict("bad", error.message);
    }
  }
  if (followed !== job.id) return;
  if (job.status === "failed") return verdict("bad", job.error);
  verdict(KINDS[job.diagnosis.verdict], `${job.recording}: ${job.diagnosis.summary}`);
  $("report-row").hidden = false;
  $("report").href = withToken(`/api/diagnose/${job.id}/report`);
}

$("show-report").onclick = () => {
  const show = $("report-frame").hidden;
  $("report-frame").hidden = !show;
  $("show-report").setAttribute("aria-expanded", String(show));
  if (show) $("report-frame").src = $("report").href;
};

/** The last diagnosis, where the page was left while it ran. */
async function lastDiagnosis() {
  try {
    const last = (await ask("/api/diagnose")).pop();
    if (last) follow(await ask(`/api/diagnose/${last.id}`));
  } catch {
    // There is none to show, or no connection, which is told elsewhere.
  }
}

connect();
lastDiagnosis();
requestAnimationFrame(draw);
