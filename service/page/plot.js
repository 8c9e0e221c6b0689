// One plot: a Vega-Lite view in an element, whose data and signals change while it stands.

import { element } from "./elements.js";
import { config } from "./theme.js";

// So many pixels beside the axes still count as on them: their ends can be reached.
const BESIDE = 8;

let library = null;

/** Begin to load the plotting library, which is larger than all else. */
export function loadLibrary() {
  library ??= import("./vega-embed.js");
  return library;
}

/** Fixed decimals where they are short, powers of ten elsewhere. */
const POWER_LABEL = "datum.value >= 1e5 || datum.value < 1e-3 ? format(datum.value, '~e') : format(datum.value, '~g')";

/** Signals that hold the range and the ticks of both axes. */
export const RANGE_SIGNALS = ["xLow", "xHigh", "yLow", "yHigh"].map((name, index) => ({
  name,
  value: 1 + (index % 2),
}));

/** An encoding on an axis whose range and ticks are the signals of `side`, x or y. */
export function axis(side, field, type, title, more = {}) {
  return {
    field,
    type: "quantitative",
    title,
    scale: {
      type,
      nice: false,
      domain: [{ expr: `${side}Low` }, { expr: `${side}High` }],
      ...(type === "log" ? {} : { zero: false }),
    },
    axis: {
      values: { expr: `${side}Ticks` },
      grid: true,
      ...(type === "log" ? { labelExpr: POWER_LABEL } : {}),
      ...more,
    },
  };
}

/** The value of signals for a range {low, high, ticks}. */
export const rangeOf = (side, { low, high, ticks }) => ({
  [`${side}Low`]: low,
  [`${side}High`]: high,
  [`${side}Ticks`]: ticks,
});

/** A view of a spec, made when it is first drawn and again when the colours change. */
export class Plot {
  #container;
  #spec;
  #onHover;
  #view = null;
  #making = null;

  /** `spec()` is the Vega-Lite spec; `onHover(event, datum)` hears what mark the pointer is on, null on none. */
  constructor(container, spec, onHover = null) {
    // Vega says what it is to screen readers on its own element; ours has the words that help.
    this.#container = element("div", { class: "vega" });
    container.append(this.#container);
    this.#spec = spec;
    this.#onHover = onHover;
  }

  /** Draw rows by name of data set, with values of signals. */
  async draw(data, signals) {
    this.#making ??= this.#make();
    const view = await this.#making;
    for (const [name, value] of Object.entries(signals)) view.signal(name, value);
    for (const [name, rows] of Object.entries(data)) view.data(name, rows);
    // Labels may have another width now: the axes are laid out anew.
    await view.resize().runAsync();
  }

  /** Change signals alone; nothing where the view is not there yet. */
  signal(values) {
    if (!this.#view) return;
    for (const [name, value] of Object.entries(values)) this.#view.signal(name, value);
    this.#view.runAsync();
  }

  /** The values {x, y} on the axes under a pointer; null beside the axes. */
  under(event) {
    const view = this.#view;
    const svg = this.#container.querySelector("svg");
    if (!view || !svg) return null;
    const { left, top } = svg.getBoundingClientRect();
    const x = event.clientX - left - view.padding().left - view.origin()[0];
    const y = event.clientY - top - view.padding().top - view.origin()[1];
    if (x < -BESIDE || x > view.width() + BESIDE) return null;
    return { x: view.scale("x").invert(x), y: view.scale("y").invert(y) };
  }

  /** Forget the view: it is made anew, in the colours of the day, when it is next drawn. */
  reset() {
    this.#view?.finalize();
    this.#view = this.#making = null;
  }

  async #make() {
    const { vegaEmbed } = await loadLibrary();
    // `ast`: expressions are interpreted, so that no eval is needed. Vega's own tooltip and styles are markup; ours are not.
    const options = {
      ast: true,
      actions: false,
      renderer: "svg",
      defaultStyle: false,
      tooltip: false,
      mode: "vega-lite",
    };
    const { view } = await vegaEmbed(this.#container, { ...this.#spec(), config: config() }, options);
    this.#view = view;
    if (this.#onHover) {
      view.addEventListener("pointermove", (event, item) =>
        this.#onHover(event, item?.mark.marktype === "symbol" ? item.datum : null),
      );
      view.addEventListener("pointerout", (event) => this.#onHover(event, null));
    }
    return view;
  }
}
