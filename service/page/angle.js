// One view angle: a slider over the angles of the scene, the polar picture there, and a table of the values.

import { STATISTICS, noLimit } from "./curves.js";
import { byId, element, swatch } from "./elements.js";
import { degrees, short, withError } from "./numbers.js";
import { Polar } from "./polar.js";
import { json } from "./server.js";

const HEADS = { variance: "variance", max_weight: "largest weight", mean: "mean weight" };

/** The part of the page about one angle. `onChoose(angle)` hears the slider; `pathOf(angle)` is where its slice is. */
export class OneAngle {
  #polar = new Polar(byId("polar"));
  #pathOf;
  #angles = [];
  #path = null;
  #slice = null;
  #drawn = {};

  constructor({ onChoose, pathOf }) {
    this.#pathOf = pathOf;
    const slider = byId("angle");
    slider.addEventListener("input", () => onChoose(this.#angles[slider.valueAsNumber], false));
    slider.addEventListener("change", () => onChoose(this.#angles[slider.valueAsNumber], true));
  }

  /** Show the curves at `angle`, one of `angles`. The slice comes from the server where the scene or angle changed. */
  async show(curves, angles, angle) {
    this.#angles = angles;
    const index = angles.indexOf(angle);
    const slider = byId("angle");
    slider.max = angles.length - 1;
    slider.value = index;
    const here = degrees(angles[index]);
    slider.setAttribute("aria-valuetext", here);
    byId("angle-value").textContent = here;
    const shown = curves.filter((curve) => curve.shown);
    showTable(shown, index, here);
    const slice = await this.#sliceAt(angles[index]);
    if (slice) await this.#draw(slice, curves, index);
  }

  /** Draw anew, in other colours, at the next `show`. */
  reset() {
    this.#polar.reset();
  }

  /** The slice of an angle; null where another one was asked for meanwhile. */
  async #sliceAt(angle) {
    const path = this.#pathOf(angle);
    if (path !== this.#path) {
      this.#path = path;
      this.#slice = json(path);
      this.#slice.catch(() => (this.#path = null));
    }
    const slice = await this.#slice;
    return path === this.#path && slice.kind === "slices" ? slice : null;
  }

  async #draw(slice, curves, index) {
    const albedos = curves.map((curve) => curve.series.reference?.albedo[index]);
    const looks = JSON.stringify([curves.map((curve) => [curve.shown, curve.colour]), albedos]);
    if (slice === this.#drawn.slice && looks === this.#drawn.looks) return;
    this.#drawn = { slice, looks };
    const shown = slice.series
      .map((one, number) => ({ ...curves[number], ...one, value: scaled(one.value, albedos[number]) }))
      .filter((one) => one.shown);
    await this.#polar.draw(slice.series[0].theta_o_deg, shown);
    const ideal = albedos.every(Boolean) ? "f cos θi / albedo, the density that would have no variance" : "f cos θi";
    byId("polar-note").textContent =
      `In the plane of the view, in 1/sr. Grey: ${ideal}. Lines: the densities of the shown techniques. ` +
      "To the right is the view's side.";
  }
}

const scaled = (values, albedo) => (albedo ? values.map((one) => (one === null ? null : one / albedo)) : values);

function showTable(curves, index, here) {
  const statistics = STATISTICS.filter((name) => curves.some((curve) => curve.series[name]));
  const head = element("tr", {}, element("th", { scope: "col" }, "curve"));
  for (const name of statistics) head.append(element("th", { scope: "col" }, HEADS[name]));
  const rows = curves.map((curve) => {
    const name = element("th", { scope: "row" }, swatch(curve), " ", curve.label);
    return element("tr", {}, name, ...statistics.map((statistic) => cell(curve.series, statistic, index)));
  });
  byId("values").replaceChildren(
    element("caption", {}, `Values at ${here}`),
    element("thead", {}, head),
    element("tbody", {}, ...rows),
  );
}

/** The sampled value, and below it the exact one; a value that has no limit stands in brackets. */
function cell(series, statistic, index) {
  const value = series[statistic]?.[index];
  const error = series[`${statistic}_stderr`]?.[index];
  const text = noLimit(series, statistic)[index] ? `[${short(value)}]` : withError(value, error);
  if (!series.reference) return element("td", {}, text);
  const exact = series.reference[statistic][index];
  const word = statistic === "max_weight" ? "bound" : "exact";
  return element("td", {}, text, element("small", {}, `${word} ${exact === null ? "∞" : short(exact, 5)}`));
}
