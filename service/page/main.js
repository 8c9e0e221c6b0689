// The page: one state, which is the address; controls change it, the server answers it, the parts below show the answer.

import { addressOf, questionPath, readAddress } from "./address.js";
import { OneAngle } from "./angle.js";
import { Catalogue } from "./catalogue.js";
import { Controls } from "./controls.js";
import { curvesOf } from "./curves.js";
import { announce, byId, element } from "./elements.js";
import { hideHover, showHover } from "./hover.js";
import { degrees, withError } from "./numbers.js";
import { Panels, TITLES, nearest } from "./panels.js";
import { loadLibrary } from "./plot.js";
import { Away, Problem, keepKey, untilBack } from "./server.js";
import { SpeedStudy } from "./speed-study.js";
import { Statistics } from "./statistics.js";
import { offer } from "./take.js";
import { onThemeChange } from "./theme.js";
import { showCurves } from "./verdicts.js";

class Page {
  #catalogue;
  #controls;
  #panels;
  #angle;
  #statistics;
  #speed;
  #state;
  #curves = [];
  #drawing = false;
  #stale = false;

  constructor(catalogue) {
    this.#catalogue = catalogue;
    this.#controls = new Controls(catalogue, (state, settled) => this.#change(state, settled));
    this.#panels = new Panels(byId("panels"), {
      onHover: (event, angle, statistic) => this.#hover(event, angle, statistic),
      onLeave: hideHover,
      onChoose: (angle) => this.#look({ at: angle }),
    });
    this.#angle = new OneAngle({
      onChoose: (angle, settled) => this.#look({ at: angle }, settled),
      pathOf: (angle) => questionPath("slices", this.#state, catalogue, SLICE(angle)),
    });
    this.#statistics = new Statistics(catalogue, {
      onSeries: () => this.#redraw(),
      onProblem: (problem) => this.#refused(problem),
    });
    this.#speed = new SpeedStudy(catalogue, (changed) => this.#look(changed));
    offer(catalogue, () => this.#state);
    addEventListener("popstate", () => this.restore());
    onThemeChange(() => this.#recolour());
  }

  /** Take the state from the address, and ask. */
  restore() {
    this.#state = this.#catalogue.complete(readAddress(location.search, this.#catalogue));
    this.#controls.show(this.#state);
    document.title = titleOf(this.#state);
    this.#ask(true);
  }

  /** The scene changed; what has been settled goes into the address. */
  #change(state, settled) {
    this.#state = state;
    this.#controls.show(state);
    if (settled) this.#remember();
    this.#ask(settled);
  }

  /** What is looked at changed, not the scene. */
  #look(changed, settled = true) {
    this.#state = { ...this.#state, ...changed };
    if (settled) this.#remember();
    this.#redraw();
    this.#speed.ask(this.#state);
  }

  #remember() {
    const address = addressOf(this.#state, this.#catalogue);
    if (address !== location.pathname + location.search) history.pushState(null, "", address);
    document.title = titleOf(this.#state);
  }

  #ask(settled) {
    this.#controls.clearErrors();
    this.#statistics.ask(this.#state, settled);
    if (settled) this.#speed.ask(this.#state);
  }

  #refused(problem) {
    this.#controls.showErrors(problem.fields, problem.message);
    byId("panels").hidden = !this.#statistics.series.length;
  }

  /** Draw what is known, once for all that arrives within one drawing. */
  async #redraw() {
    this.#stale = true;
    if (this.#drawing) return;
    this.#drawing = true;
    try {
      while (this.#stale) {
        this.#stale = false;
        await this.#draw();
      }
    } finally {
      this.#drawing = false;
    }
  }

  async #draw() {
    const { series, run } = this.#statistics;
    if (!series.length) return;
    byId("panels").hidden = false;
    this.#curves = curvesOf(series, this.#state.hidden);
    const angles = series[0].theta_o_deg;
    const at = nearest(angles, this.#state.at);
    showCurves(this.#curves, (key) => this.#toggle(key));
    await this.#panels.draw(this.#curves, angles, at);
    this.#noteDrawn();
    if (run) byId("device").textContent = `${run.device}, driver ${run.driver}, ${run.threads} threads`;
    // The slice is a question of its own: curves do not wait for it.
    this.#angle.show(this.#curves, angles, at ?? angles[0]).catch((error) => {
      if (!(error instanceof Problem)) byId("polar-note").textContent = error.message;
    });
  }

  /** For whoever measures the page: when the first curves stood, and how often they were drawn. */
  #noteDrawn() {
    const { dataset } = document.body;
    if (!dataset.plotted) performance.mark("plotted");
    dataset.plotted = String(Number(dataset.plotted ?? 0) + 1);
  }

  #toggle(key) {
    const { hidden } = this.#state;
    this.#look({ hidden: hidden.includes(key) ? hidden.filter((one) => one !== key) : [...hidden, key] });
  }

  #hover(event, angle, statistic) {
    const lines = this.#curves
      .filter((curve) => curve.shown && curve.series[statistic])
      .map((curve) => {
        const index = curve.series.theta_o_deg.indexOf(angle);
        return {
          curve,
          name: curve.label,
          number: curve.series[statistic][index],
          error: curve.series[`${statistic}_stderr`]?.[index],
        };
      })
      .sort((a, b) => b.number - a.number);
    showHover(
      event,
      `${TITLES[statistic]} at ${degrees(angle)}`,
      lines.map((line) => ({ ...line, value: withError(line.number, line.error) })),
    );
  }

  #recolour() {
    for (const part of [this.#panels, this.#angle, this.#speed]) part.reset();
    this.#redraw();
    this.#speed.redraw();
  }
}

const titleOf = ({ model }) => `${model} – samplerscope`;

/** What a slice asks for in place of a scene's angles; it draws nothing. */
const SLICE = (angle) => ({ theta_o_deg: angle, angles: null, method: null, samples: null, seed: null });

/** A server with a key answers nothing without it. */
function askForKey(words) {
  const input = element("input", { id: "key", type: "text", autocomplete: "off", spellcheck: "false" });
  const field = element(
    "div",
    { class: "field" },
    element("label", { for: "key" }, "Key of this server"),
    input,
    element("p", { class: "error", role: "alert" }, words),
    element("p", { class: "note" }, "The key is kept in this tab only."),
  );
  input.addEventListener("change", () => {
    keepKey(input.value);
    field.remove();
    start();
  });
  byId("scene").prepend(field);
  input.focus();
}

async function start() {
  loadLibrary();
  let catalogue;
  try {
    catalogue = await loadCatalogue();
  } catch (error) {
    if (error.status !== 401) throw error;
    return askForKey(error.message);
  }
  new Page(catalogue).restore();
}

/** The catalogue, when the server is there. */
async function loadCatalogue() {
  for (;;) {
    try {
      return await Catalogue.load();
    } catch (error) {
      if (!(error instanceof Away)) throw error;
      announce(error.message);
      await untilBack(error.afterS, new AbortController().signal);
    }
  }
}

start();
