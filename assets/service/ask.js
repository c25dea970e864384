// What the service is asked for.

import { $, number, say } from "./dom.js";

const PATIENCE = 10000; // ms after which an answer is not waited for any more
const AGAIN = 500; // ms after which a stop that has no answer yet is sent again when it is asked for again
const TRIES = 3; // of a stop, where the service does not answer or has no time

export const token = { get: () => sessionStorage.getItem("quell-token"), set: (text) => sessionStorage.setItem("quell-token", text) };

/** Adds the token to an address that the browser itself asks for. */
export const withToken = (path) => (token.get() ? `${path}?token=${encodeURIComponent(token.get())}` : path);

/** Requests that give way to a stop: a browser has a few connections only. */
const waiting = new Set();

/** An error that the service has answered has its `status`; where it did not answer there is none. */
export async function ask(path, { method = "GET", body, signal } = {}) {
  const headers = token.get() ? { Authorization: `Bearer ${token.get()}` } : {};
  if (body !== undefined) headers["Content-Type"] = "application/json";
  const own = new AbortController();
  const timer = setTimeout(() => own.abort(new Error(`no answer within ${PATIENCE / 1e3} s`)), PATIENCE);
  if (!signal) waiting.add(own);
  let response, answer;
  try {
    response = await fetch(path, { method, headers, body: body && JSON.stringify(body), signal: signal ?? own.signal });
    answer = await response.json();
  } catch {
    const stopped = signal ?? own.signal;
    throw stopped.aborted ? stopped.reason : new Error("the service does not answer");
  } finally {
    clearTimeout(timer);
    waiting.delete(own);
  }
  if (response.status === 401) $("token-form").hidden = false;
  if (!response.ok) throw Object.assign(new Error(answer.error), { status: response.status });
  return answer;
}

let busy = false;

/** Asks for something, and says what became of it. One at a time: what is pressed meanwhile is not sent. */
export async function command(path, body, done) {
  if (busy) return say("Not sent: the service is still at the last command.", true);
  busy = true;
  try {
    say(done(await ask(path, { method: "POST", body })));
  } catch (error) {
    say(error.message, true);
  } finally {
    busy = false;
  }
}

let sent = -Infinity;

/** Stops every joint. It waits for nothing, and all else gives way to it. */
export async function stop() {
  const now = performance.now();
  if (now - sent < AGAIN) return;
  sent = now;
  for (const other of waiting) other.abort(new Error("a stop came first"));
  try {
    say(stopped((await send(TRIES)).joints));
  } catch (error) {
    say(`NOT stopped from here: ${error.message}.`, true);
  } finally {
    if (sent === now) sent = -Infinity;
  }
}

/** Sends a stop, at once again where that may help: to stop twice is to stop. */
async function send(tries) {
  try {
    return await ask("/api/v1/stop", { method: "POST", signal: AbortSignal.timeout(PATIENCE) });
  } catch (error) {
    const helps = [undefined, 408, 503].includes(error.status);
    if (!helps || tries === 1) throw error;
    return send(tries - 1);
  }
}

/** What a stop did. */
function stopped(joints) {
  if (!joints.length) return "Nothing was moving.";
  const one = ({ joint, duration_s: s }) => `${joint}: stopping, ${s === null ? "as soon as it can" : `at rest in ${number(s, 2)} s`}`;
  return `${joints.map(one).join("; ")}.`;
}
