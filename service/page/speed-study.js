// Whether speed is measured, for which scene, and across what; the result goes to the section about speed.

import { questionPath } from "./address.js";
import { byId, element } from "./elements.js";
import { duration } from "./numbers.js";
import { Progress } from "./progress.js";
import { Cancelled, Question } from "./question.js";
import { Problem } from "./server.js";
import { Speed } from "./speed.js";

// Error curves reach to so many samples; with 32 replicates some seconds on two cores.
const SAMPLES = 1 << 14;

/** Asks for error against run time while its button is pressed. `onLook(changed)` hears what is to be looked at. */
export class SpeedStudy {
  #catalogue;
  #speed = new Speed();
  #question = new Question();
  #progress;
  #path = null;
  #result = null;
  #hidden = new Set();

  constructor(catalogue, onLook) {
    this.#catalogue = catalogue;
    const buttons = { onCancel: () => this.#cancel(), onAgain: () => this.#measure() };
    this.#progress = new Progress(byId("speed-status"), buttons);
    byId("measure").addEventListener("click", () =>
      onLook({ speed: byId("measure").getAttribute("aria-pressed") !== "true" }),
    );
    byId("over").addEventListener("change", () => onLook({ over: byId("over").value }));
  }

  /** Show and, where it is wanted and not known yet, measure the speed of a state's scene. */
  ask(state) {
    const names = this.#catalogue.readParameters(state);
    byId("over").replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    const over = names.includes(state.over) ? state.over : (names[0] ?? null);
    byId("over").value = over;
    byId("measure").setAttribute("aria-pressed", String(state.speed));
    this.#hidden = new Set(state.hidden);
    const path = state.speed ? this.#pathOf(state, over) : null;
    if (path !== this.#path) {
      this.#path = path;
      this.#result = null;
      this.#speed.clear();
      this.#question.drop();
      if (path) this.#measure();
      else this.#progress.end("");
    } else {
      this.redraw();
    }
  }

  /** Draw what is known. */
  redraw() {
    if (this.#result) this.#speed.show(this.#result, this.#hidden);
  }

  /** Draw anew, in other colours, at the next `redraw`. */
  reset() {
    this.#speed.reset();
  }

  /** Where the study of a state is: of the first value of each parameter, at the angles that a study has by itself. */
  #pathOf(state, over) {
    const parameters = Object.fromEntries(
      Object.entries(state.parameters).map(([name, text]) => [name, text.split(",")[0]]),
    );
    const replaced = {
      angles: null,
      theta_o_deg: null,
      samples: SAMPLES,
      method: null,
      estimators: "mc",
      tolerance: null,
    };
    return questionPath("convergence", { ...state, parameters }, this.#catalogue, {
      ...replaced,
      efficiency_over: over,
    });
  }

  async #measure() {
    this.#progress.begin("asking");
    try {
      this.#result = await this.#question.ask(this.#path, this.#progress);
      this.redraw();
      this.#progress.end(
        `Measured in ${duration(this.#result.run.elapsed_ms)} on ${this.#result.run.threads} threads.`,
      );
    } catch (error) {
      this.#failed(error);
    }
  }

  #failed(error) {
    if (error.name === "AbortError") return;
    if (!(error instanceof Cancelled) && !(error instanceof Problem)) throw error;
    this.#progress.end(error instanceof Cancelled ? "Cancelled." : error.message, true);
  }

  #cancel() {
    this.#question.drop();
    this.#failed(new Cancelled());
  }
}
