// The statistics of a scene: a draft at once, then the whole answer as a job whose curves sharpen while it runs.

import { questionPath } from "./address.js";
import { byId } from "./elements.js";
import { duration } from "./numbers.js";
import { Progress } from "./progress.js";
import { Cancelled, Question, draft } from "./question.js";
import { Away, Problem } from "./server.js";

// A draft of so many samples takes tens of milliseconds.
const DRAFT_SAMPLES = 4096;
const DRAFT_SAMPLES_IN_ALL = 1 << 22;
// A slider that stands still for so long asks for the whole answer.
const SETTLE_MS = 350;

/** Asks, and holds what is known: `series` as they plot, `run` of the whole answer. */
export class Statistics {
  series = [];
  run = null;
  #catalogue;
  #onSeries;
  #onProblem;
  #question = new Question();
  #progress;
  #state = null;
  #drafting = false;
  #timer = null;

  constructor(catalogue, { onSeries, onProblem }) {
    this.#catalogue = catalogue;
    this.#onSeries = onSeries;
    this.#onProblem = onProblem;
    const buttons = { onCancel: () => this.#cancel(), onAgain: () => this.ask(this.#state, true) };
    this.#progress = new Progress(byId("statistics-status"), buttons);
  }

  /** Ask for the scene of a state; for all of it once it is settled. */
  ask(state, settled) {
    this.#state = state;
    this.run = null;
    clearTimeout(this.#timer);
    this.#question.drop();
    this.#draft();
    this.#timer = setTimeout(() => this.#whole(), settled ? 0 : SETTLE_MS);
  }

  /** One draft at a time: while a slider moves, the next is of where it stands then. */
  async #draft() {
    if (this.#drafting) return;
    this.#drafting = true;
    try {
      for (let state = null; state !== this.#state;) {
        state = this.#state;
        const answer = state.method === "quadrature" ? null : await draft(this.#draftPath(state));
        if (answer && state === this.#state && !this.run)
          this.#take(answer.series.map((one) => ({ ...one, verdict: null })));
      }
    } catch (error) {
      // The whole answer meets the same problem and says so.
      if (!(error instanceof Problem) && !(error instanceof Away)) throw error;
    } finally {
      this.#drafting = false;
    }
  }

  #draftPath(state) {
    const cells = Math.max(1, this.series.length * (this.series[0]?.theta_o_deg.length ?? 1));
    const most = Math.min(DRAFT_SAMPLES, Math.max(256, Math.floor(DRAFT_SAMPLES_IN_ALL / cells)));
    const samples = Number(state.samples) < most ? state.samples : most;
    return questionPath("statistics", state, this.#catalogue, { samples, reference: "false", tolerance: null });
  }

  async #whole() {
    const state = this.#state;
    this.#progress.begin("asking");
    try {
      const path = questionPath("statistics", state, this.#catalogue);
      const result = await this.#question.ask(path, this.#progress, (series) => this.#partial(series));
      this.run = result.run;
      this.#take(result.series);
      this.#progress.end(summary(result.series, this.#progress.elapsed));
    } catch (error) {
      this.#failed(error);
    }
  }

  #failed(error) {
    if (error.name === "AbortError") return;
    if (error instanceof Cancelled) {
      this.#progress.end("Cancelled. The curves are those of the samples drawn so far.", true);
    } else if (error instanceof Problem) {
      this.#progress.end(
        error.fields.length ? "The scene cannot be computed as it is: see its fields." : error.message,
      );
      this.#onProblem(error);
    } else {
      this.#progress.end(error.message, true);
      throw error;
    }
  }

  #cancel() {
    this.#question.drop();
    this.#failed(new Cancelled());
  }

  /** A series in the middle of its samples takes the place of its draft once every angle has as many. */
  #partial({ number, ...series }) {
    const known = this.series[number];
    if (!known || Math.min(...series.samples) < least(known.samples)) return;
    this.#take(this.series.map((one, index) => (index === number ? series : one)));
  }

  #take(series) {
    this.series = series;
    this.#onSeries();
  }
}

const least = (samples) => (Array.isArray(samples) ? Math.min(...samples) : samples);

function summary(series, ms) {
  const fine = series.filter((one) => one.verdict.status === "ok").length;
  const samples = Math.max(...series.map((one) => one.samples));
  return `Done in ${duration(ms)}: ${samples.toLocaleString("en")} samples per angle; ${fine} of ${series.length} curves are ok.`;
}
