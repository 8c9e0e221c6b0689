// A question put to the server as a job: watched, cancelled, and asked again when the server was away.

import { Away, Problem, events, json, request, untilBack } from "./server.js";

/** The job was cancelled, here or by someone else who watches it. */
export class Cancelled extends Error {}

/** One question at a time; a new one ends the one before. */
export class Question {
  #controller = new AbortController();
  #job = null;

  /**
   * The result of a question. `progress` (see progress.js) shows how far it is, `onPartial(series)` hears of a series in
   * the middle of its samples. Throws Problem, Cancelled, or an AbortError where a newer question took its place.
   */
  async ask(path, progress, onPartial = () => {}) {
    this.drop();
    const { signal } = (this.#controller = new AbortController());
    for (;;) {
      try {
        return await this.#once(path, progress, onPartial, signal);
      } catch (error) {
        if (!(error instanceof Away)) throw error;
        progress.away(error.message);
        await untilBack(error.afterS, signal);
      }
    }
  }

  /** End the question: what is computed for it is cancelled. */
  drop() {
    this.#controller.abort();
    if (this.#job) request(this.#job, { method: "DELETE" }).catch(() => {});
    this.#job = null;
  }

  async #once(path, progress, onPartial, signal) {
    const reply = await request(path, { signal, headers: { prefer: "respond-async" } });
    const answer = await reply.json();
    if (reply.status === 200) return answer;
    this.#job = answer.links.self;
    try {
      return await this.#outcome(answer, progress, onPartial, signal);
    } finally {
      if (!signal.aborted) this.#job = null;
    }
  }

  async #outcome(job, progress, onPartial, signal) {
    for await (const { name, data } of events(job.links.events, signal)) {
      switch (name) {
        case "progress":
          progress.further(data.done, data.total, data.technique);
          break;
        case "partial":
          onPartial(data);
          break;
        case "done":
          return json(job.links.result, { signal });
        case "failed":
          throw new Problem(data);
        case "cancelled":
          throw new Cancelled("cancelled");
        case "interrupted":
          throw new Away(data.message);
      }
    }
    throw new Away("The connection was lost");
  }
}

/** A quick answer for fewer samples, or null where even that takes long. */
export async function draft(path, signal) {
  const reply = await request(path, { signal });
  const answer = await reply.json();
  if (reply.status === 200) return answer;
  await request(answer.links.self, { method: "DELETE" });
  return null;
}
