// The three panels of the paper: variance, largest weight and mean weight over the view angle.

import { LOG, STATISTICS, referenceRows, sampledRows } from "./curves.js";
import { element } from "./elements.js";
import { Plot, RANGE_SIGNALS, axis, rangeOf } from "./plot.js";
import { angleScale, linearScale, logScale } from "./scales.js";
import { ink } from "./theme.js";

export const TITLES = { variance: "variance of the weight", max_weight: "largest weight", mean: "mean weight" };

/** The panels in an element. `onHover(event, angle, statistic)` and `onLeave()` follow the pointer, `onChoose(angle)` a click. */
export class Panels {
  #parts;
  #angles = [];

  constructor(container, { onHover, onLeave, onChoose }) {
    this.#parts = STATISTICS.map((statistic) => {
      const holder = element("div", { class: "plot panel", role: "img" });
      const note = element("p", { class: "note" });
      container.append(element("figure", {}, holder, note));
      const plot = new Plot(holder, () => spec(statistic));
      const angleOf = (event) => nearest(this.#angles, plot.under(event)?.x ?? null);
      holder.addEventListener("pointermove", (event) => {
        const angle = angleOf(event);
        this.#mark({ hovered: angle ?? -1 });
        if (angle === null) onLeave();
        else onHover(event, angle, statistic);
      });
      holder.addEventListener("pointerleave", () => {
        this.#mark({ hovered: -1 });
        onLeave();
      });
      holder.addEventListener("click", (event) => {
        const angle = angleOf(event);
        if (angle !== null) onChoose(angle);
      });
      return { statistic, holder, note, plot };
    });
  }

  /** Draw the curves that are shown. */
  async draw(curves, angles, chosen) {
    this.#angles = angles;
    const shown = curves.filter((curve) => curve.shown);
    await Promise.all(this.#parts.map((part) => this.#drawPart(part, shown, chosen)));
  }

  /** Draw anew, in other colours, at the next `draw`. */
  reset() {
    for (const { plot } of this.#parts) plot.reset();
  }

  #mark(signals) {
    for (const { plot } of this.#parts) plot.signal(signals);
  }

  async #drawPart({ statistic, holder, note, plot }, curves, chosen) {
    const rows = curves.flatMap((curve) => sampledRows(curve, statistic));
    const truth = curves.flatMap((curve) => referenceRows(curve, statistic));
    const exact = truth.map((row) => row.value);
    const values = rows.map((row) => row.value);
    const range = LOG[statistic] ? logScale(values, exact) : linearScale([...values, ...exact]);
    const ends = rows.map(({ error, ...row }) =>
      error === null ? row : { ...row, bottom: Math.max(row.value - 2 * error, range.low), top: row.value + 2 * error },
    );
    const signals = { ...rangeOf("x", angleScale(this.#angles)), ...rangeOf("y", range), chosen: chosen ?? -1 };
    await plot.draw({ sampled: ends, truth }, signals);
    holder.setAttribute("aria-label", described(statistic, curves, this.#angles));
    note.textContent = missing(statistic, curves);
  }
}

/** The member of `angles` nearest to one; null where there is none. */
export function nearest(angles, angle) {
  if (angle === null || !angles.length) return null;
  return angles.reduce((best, one) => (Math.abs(one - angle) < Math.abs(best - angle) ? one : best));
}

function described(statistic, curves, angles) {
  const scale = LOG[statistic] ? "logarithmic axis" : "linear axis";
  const names = curves.map((curve) => curve.label).join("; ");
  return `${TITLES[statistic]} over ${angles.length} view angles, ${scale}, curves: ${names || "none"}. The values stand in the table below.`;
}

function missing(statistic, curves) {
  if (!LOG[statistic]) return "";
  const none = curves.filter((curve) => curve.series[statistic] && !sampledRows(curve, statistic).length);
  return none.length
    ? `Zero at every angle, which a logarithmic axis cannot show: ${none.map((one) => one.label).join(", ")}.`
    : "";
}

function spec(statistic) {
  const x = axis("x", "theta", "linear", "view angle θo (degrees)", { grid: false });
  const y = axis("y", "value", LOG[statistic] ? "log" : "linear", TITLES[statistic]);
  const colour = { field: "colour", type: "nominal", scale: null };
  const dash = { field: "dash", type: "nominal", scale: null };
  const detail = { field: "run", type: "nominal" };
  const strength = { field: "opacity", type: "quantitative", scale: null };
  const line = (filter, mark, more) => ({
    data: { name: "sampled" },
    transform: [{ filter }],
    mark: { type: "line", clip: true, ...mark },
    encoding: { x, y, color: colour, strokeDash: dash, detail, ...more },
  });
  const rule = (signal, width) => ({
    data: { values: [{}] },
    mark: { type: "rule", color: ink().line, strokeWidth: width, opacity: { expr: `${signal} < 0 ? 0 : 1` } },
    encoding: { x: { datum: { expr: `max(${signal}, xLow)` }, type: "quantitative" } },
  });
  return {
    $schema: "https://vega.github.io/schema/vega-lite/v6.json",
    width: "container",
    height: 250,
    autosize: { type: "fit", contains: "padding" },
    params: [
      ...RANGE_SIGNALS,
      { name: "xTicks", value: [] },
      { name: "yTicks", value: [] },
      { name: "hovered", value: -1 },
      { name: "chosen", value: -1 },
    ],
    datasets: { sampled: [], truth: [] },
    layer: [
      rule("chosen", 1.4),
      rule("hovered", 0.7),
      {
        data: { name: "sampled" },
        transform: [{ filter: "isValid(datum.bottom)" }],
        mark: { type: "area", opacity: 0.18, clip: true },
        encoding: { x, y: { ...y, field: "bottom" }, y2: { field: "top" }, color: colour, detail },
      },
      line("datum.limit", { strokeWidth: 1.9 }, { opacity: strength }),
      line("!datum.limit", { strokeWidth: 1.2, opacity: 0.5 }, {}),
      {
        data: { name: "sampled" },
        transform: [{ filter: "datum.marker" }],
        mark: { type: "point", size: 22, strokeWidth: 1.1, filled: false, opacity: 0.9, clip: true },
        encoding: { x, y, color: colour },
      },
      {
        data: { name: "truth" },
        mark: { type: "line", strokeWidth: 0.7, opacity: 0.75, clip: true },
        encoding: { x, y, detail, color: statistic === "max_weight" ? colour : { value: ink().reference } },
      },
    ],
  };
}
