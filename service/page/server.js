// The server: requests, the problems it answers with, and the events of a job.

/** What the server refused: its problem document (RFC 9457). */
export class Problem extends Error {
  constructor(document) {
    super(document.detail || document.title);
    this.status = document.status;
    /** Every wrong field: {field, value, allowed}. */
    this.fields = document.errors ?? [];
  }
}

/** The server is away or busy: the same request may succeed later. `afterS` says when to try. */
export class Away extends Error {
  constructor(message, afterS = 1) {
    super(message);
    this.afterS = afterS;
  }
}

const BUSY = new Set([429, 502, 503, 504]);
// A server with nothing to tell sends a sign of life every ten seconds.
const SILENT_MS = 30_000;
const KEY = "samplerscope-key";

/** Keep the key of a server that wants one, for as long as the tab lives. */
export const keepKey = (key) => sessionStorage.setItem(KEY, key);

/** Whether there is a key. */
export const hasKey = () => Boolean(sessionStorage.getItem(KEY));

/** A response that is fine. Throws Problem, Away, or the AbortError of the signal. */
export async function request(path, { headers = {}, ...options } = {}) {
  const key = sessionStorage.getItem(KEY);
  const wanted = { accept: "application/json", ...headers, ...(key ? { "x-api-key": key } : {}) };
  let reply;
  try {
    reply = await fetch(path, { ...options, headers: wanted });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Away("The service does not answer");
  }
  if (reply.ok) return reply;
  const problem = await reply.json().catch(() => ({ status: reply.status, title: reply.statusText }));
  if (BUSY.has(reply.status))
    throw new Away(problem.detail || problem.title, Number(reply.headers.get("retry-after")) || 1);
  throw new Problem(problem);
}

/** The body of a response as JSON; a connection that breaks in the middle is Away. */
export async function json(path, options) {
  const reply = await request(path, options);
  return whole(() => reply.json());
}

/** The body of a response as a Blob. */
export async function blob(path, options) {
  const reply = await request(path, options);
  return whole(() => reply.blob());
}

async function whole(read) {
  try {
    return await read();
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Away("The connection was lost");
  }
}

/** Server-sent events as {name, data}. Read with fetch: an EventSource cannot carry a key. */
export async function* events(path, signal) {
  const reply = await request(path, { signal, headers: { accept: "text/event-stream" } });
  const reader = reply.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  try {
    for (;;) {
      const { done, value } = await whole(() => soon(reader.read()));
      if (done) return;
      const parts = (rest + value).split("\n\n");
      rest = parts.pop();
      for (const part of parts) {
        const found = /^event: (.*)\ndata: (.*)$/s.exec(part);
        if (found) yield { name: found[1], data: JSON.parse(found[2]) };
      }
    }
  } finally {
    reader.cancel().catch(() => {});
  }
}

/** What a promise brings; an error where it takes longer than a server that is there stays silent. */
function soon(promise) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error("silent")), SILENT_MS);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** Wait; ends early, with the signal's AbortError. */
function pause(seconds, signal) {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(new DOMException("stopped", "AbortError"));
    };
    const timer = setTimeout(() => {
      signal.removeEventListener("abort", stop);
      resolve();
    }, 1e3 * seconds);
    if (signal.aborted) stop();
    signal.addEventListener("abort", stop, { once: true });
  });
}

/** Wait until the server answers again. */
export async function untilBack(afterS, signal) {
  for (let wait = afterS; ; wait = Math.min(5, 1.5 * wait)) {
    await pause(wait, signal);
    try {
      await request("/healthz", { signal });
      return;
    } catch (error) {
      if (!(error instanceof Away)) throw error;
    }
  }
}
