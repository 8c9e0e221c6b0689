// Which is fastest: who is most efficient at each angle and parameter value, and the error against run time.

import { byId, element, swatch } from "./elements.js";
import { hideHover, showHover } from "./hover.js";
import { degrees, duration, short } from "./numbers.js";
import { Plot, RANGE_SIGNALS, axis, rangeOf } from "./plot.js";
import { logScale } from "./scales.js";
import { ink, techniqueStyles } from "./theme.js";

// Leads beyond this come from a variance that is zero up to rounding.
const MOST_LEAD = 1e4;

/** The section about speed. */
export class Speed {
  #plots = [];

  /** Show a result of kind `convergence`; techniques of `hidden` compete nowhere. */
  async show(result, hidden) {
    byId("speed").hidden = false;
    const styles = techniqueStyles(result.efficiency.techniques);
    showWinners(result.efficiency, styles, hidden);
    await this.#showErrors(result, styles, hidden);
  }

  /** Nothing is known. */
  clear() {
    byId("speed").hidden = true;
    this.reset();
  }

  /** Draw anew, in other colours, at the next `show`. */
  reset() {
    for (const { plot } of this.#plots) plot.reset();
    this.#plots = [];
    byId("errors").replaceChildren();
  }

  async #showErrors(result, styles, hidden) {
    const angles = result.series[0].theta_o_deg;
    if (this.#plots.length !== angles.length) this.reset();
    if (!this.#plots.length) this.#plots = angles.map((angle) => makePanel(angle));
    const series = result.series.filter((one) => !hidden.has(one.technique));
    const rows = angles.map((_, index) => series.flatMap((one) => errorRows(one, index, styles.get(one.technique))));
    const [times, errors] = ["time", "error"].map((name) => rows.flat().map((row) => row[name]));
    const target = result.target_error;
    const signals = {
      ...rangeOf("x", logScale(times, [])),
      ...rangeOf("y", logScale([...errors, target], [])),
      target,
    };
    await Promise.all(
      this.#plots.map(({ plot, holder, words }, index) => {
        words.textContent = ranked(
          result.ranking.find((one) => one.theta_o_deg === angles[index]),
          hidden,
        );
        const names = series.map((one) => one.technique).join(", ");
        holder.setAttribute(
          "aria-label",
          `Relative error against run time at ${degrees(angles[index])}, logarithmic axes, curves: ${names}.`,
        );
        return plot.draw({ errors: rows[index] }, signals);
      }),
    );
  }
}

function makePanel(angle) {
  const holder = element("div", { class: "plot panel", role: "img" });
  const words = element("p", { class: "note" });
  byId("errors").append(
    element("figure", {}, element("figcaption", {}, `view angle ${degrees(angle)}`), holder, words),
  );
  const plot = new Plot(holder, errorSpec, (event, row) => {
    if (!row) return hideHover();
    const lines = [
      { name: "run time", value: duration(row.time) },
      { name: "relative error", value: short(row.error, 3) },
      { name: "samples", value: row.samples.toLocaleString("en") },
    ];
    return showHover(event, row.technique, lines);
  });
  return { plot, holder, words };
}

function errorRows(one, index, style) {
  return one.samples
    .map((samples, row) => ({
      technique: one.technique,
      ...style,
      samples,
      time: one.time_ms[row],
      error: one.relative_rmse[row][index],
    }))
    .filter((row) => row.error > 0 && row.time > 0);
}

/** Who reaches the target first, in words. */
function ranked(ranking, hidden) {
  const order = ranking?.order.filter((name) => !hidden.has(name)) ?? [];
  const never = ranking?.unranked.filter((name) => !hidden.has(name)) ?? [];
  const tied = ranking?.tied.find((pair) => pair.includes(order[0]) && pair.includes(order[1]));
  const first = tied ? `${order[0]} and ${order[1]} are not distinguishable` : `${order[0]} reaches the target first`;
  const words = order.length ? [first + (order.length > 1 ? `; order: ${order.join(", ")}` : "")] : [];
  if (never.length) words.push(`no time to the target can be given for ${never.join(", ")}`);
  return words.join("; ") + ".";
}

function showWinners({ parameters, techniques, theta_o_deg, efficiency }, styles, hidden) {
  const names = Object.keys(parameters[0]).filter((name) =>
    parameters.some((row) => row[name] !== parameters[0][name]),
  );
  const head = element("tr", {}, ...names.map((name) => element("th", { scope: "col" }, name)));
  for (const angle of theta_o_deg) head.append(element("th", { scope: "col" }, degrees(angle)));
  const rows = parameters.map((values, row) => {
    const heads = names.map((name) => element("th", { scope: "row" }, short(values[name])));
    const cells = theta_o_deg.map((angle, column) => {
      const found = techniques.map((name, index) => ({
        name,
        value: efficiency[row][index][column] ?? 0,
        style: styles.get(name),
      }));
      const title = [...names.map((name) => `${name} ${short(values[name])}`), degrees(angle)].join(", ");
      return winnerCell(
        title,
        found.filter((one) => !hidden.has(one.name)).sort((a, b) => b.value - a.value),
      );
    });
    return element("tr", {}, ...heads, ...cells);
  });
  byId("winners").replaceChildren(element("thead", {}, head), element("tbody", {}, ...rows));
}

function winnerCell(title, ordered) {
  const [first, second] = ordered;
  if (!first?.value) return element("td", {}, "–");
  const lead = second?.value ? first.value / second.value : Infinity;
  const ahead = lead > MOST_LEAD ? "alone" : `${short(lead, 2)}×`;
  const cell = element("td", {}, swatch(first.style), element("b", {}, first.name), element("span", {}, ahead));
  const strength = Math.min(1, 0.25 + Math.log10(Math.min(lead, 10)));
  cell.style.setProperty(
    "background-color",
    `color-mix(in srgb, ${first.style.colour} ${Math.round(28 * strength)}%, transparent)`,
  );
  const lines = ordered.map(({ name, value, style }) => ({
    curve: style,
    name,
    value: value ? `${short(value, 3)} /s` : "no finite variance",
  }));
  cell.addEventListener("pointermove", (event) => showHover(event, title, lines));
  cell.addEventListener("pointerleave", hideHover);
  return cell;
}

function errorSpec() {
  const x = axis("x", "time", "log", "run time (ms)", { grid: false });
  const y = axis("y", "error", "log", "relative error");
  const color = { field: "colour", type: "nominal", scale: null };
  const strokeDash = { field: "dash", type: "nominal", scale: null };
  const detail = { field: "technique", type: "nominal" };
  return {
    $schema: "https://vega.github.io/schema/vega-lite/v6.json",
    width: "container",
    height: 220,
    autosize: { type: "fit", contains: "padding" },
    params: [
      ...RANGE_SIGNALS,
      { name: "xTicks", value: [] },
      { name: "yTicks", value: [] },
      { name: "target", value: 1 },
    ],
    datasets: { errors: [] },
    layer: [
      {
        data: { values: [{}] },
        mark: { type: "rule", color: ink().line, strokeDash: [4, 3], strokeWidth: 1 },
        encoding: { y: { datum: { expr: "target" }, type: "quantitative" } },
      },
      {
        data: { name: "errors" },
        mark: { type: "line", strokeWidth: 1.7, clip: true },
        encoding: { x, y, color, strokeDash, detail },
      },
      {
        data: { name: "errors" },
        mark: { type: "point", filled: true, size: 26, clip: true },
        encoding: { x, y, color },
      },
    ],
  };
}
