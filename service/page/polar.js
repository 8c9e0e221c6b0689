// The polar picture: the BRDF and the densities of the techniques in the plane of the view, at one view angle.

import { hideHover, showHover } from "./hover.js";
import { degrees, short } from "./numbers.js";
import { nearest } from "./panels.js";
import { Plot } from "./plot.js";
import { ink } from "./theme.js";

const RINGS = 3;
const RAYS_DEG = [-90, -60, -30, 0, 30, 60, 90];
const radians = (theta) => (theta * Math.PI) / 180;
const at = (theta, radius) => ({ x: radius * Math.sin(radians(theta)), y: radius * Math.cos(radians(theta)) });

/** The polar picture in an element. */
export class Polar {
  #container;
  #plot;
  #curves = [];

  constructor(container) {
    container.setAttribute("role", "img");
    container.addEventListener("pointermove", (event) => this.#hover(event));
    container.addEventListener("pointerleave", hideHover);
    this.#container = container;
    this.#plot = new Plot(container, spec);
  }

  /**
   * Draw a view angle. `curves` are {label, colour, dash, opacity, theta_i_deg, value, pdf}: f cos and the density over
   * the light's angle, in 1/sr. Equal lobes are drawn once.
   */
  async draw(angle, curves) {
    this.#curves = curves;
    const finite = curves.flatMap((one) => [...one.value, ...one.pdf]).filter((value) => value !== null);
    const outermost = 1.08 * Math.max(...finite, 1e-6);
    const { grid, labels } = gridOf(outermost);
    const view = at(angle, outermost);
    const data = {
      lobes: lobesOf(curves).flatMap((one) => points(one, one.value)),
      densities: curves.flatMap((one) => points(one, one.pdf)),
      grid,
      labels,
      view: [{ x: 0, y: 0 }, view],
      tip: [view],
    };
    await this.#plot.draw(data, { reach: outermost });
    const names = curves.map((one) => one.label).join(", ");
    this.#container.setAttribute(
      "aria-label",
      `Polar picture at view angle ${angle.toFixed(2)} degrees: the BRDF times cosine, and the densities of ${names || "no technique"}.`,
    );
  }

  /** Values at the light's angle under the pointer. */
  #hover(event) {
    const under = this.#plot.under(event);
    const [first] = this.#curves;
    if (!under || !first) return;
    const theta = nearest(first.theta_i_deg, (Math.atan2(under.x, Math.max(under.y, 0)) * 180) / Math.PI);
    const index = first.theta_i_deg.indexOf(theta);
    const lobes = lobesOf(this.#curves).map((one) => ({ name: "BRDF × cosine", value: short(one.value[index]) }));
    const densities = this.#curves.map((one) => ({ curve: one, name: one.label, value: short(one.pdf[index]) }));
    showHover(event, `light angle ${degrees(theta)}, in 1/sr`, [...lobes, ...densities]);
  }

  /** Draw anew, in other colours, at the next `draw`. */
  reset() {
    this.#plot.reset();
  }
}

/** Curves with different lobes: those of one model at one set of its parameters share theirs. */
const lobesOf = (curves) => [...new Map(curves.map((one) => [JSON.stringify(one.value), one])).values()];

function points({ label, colour, dash, opacity, theta_i_deg }, values) {
  return theta_i_deg.map((theta, order) => ({ label, colour, dash, opacity, order, ...at(theta, values[order] ?? 0) }));
}

function gridOf(reach) {
  const step = ringStep(reach);
  const radii = Array.from({ length: Math.floor(reach / step) }, (_, index) => (index + 1) * step);
  const rings = radii.flatMap((radius) =>
    Array.from({ length: 61 }, (_, index) => ({ part: `ring ${radius}`, order: index, ...at(3 * index - 90, radius) })),
  );
  const rays = RAYS_DEG.flatMap((theta) =>
    [0, reach].map((radius, order) => ({ part: `ray ${theta}`, order, ...at(theta, radius) })),
  );
  const labels = radii.map((radius) => ({ ...at(-90, radius), text: String(Number(radius.toPrecision(6))) }));
  return { grid: [...rings, ...rays], labels };
}

function ringStep(reach) {
  const power = 10 ** Math.floor(Math.log10(reach / RINGS));
  return [1, 2, 5, 10].map((mark) => mark * power).find((step) => reach / step <= RINGS + 1);
}

function spec() {
  const { faint, text, line, reference } = ink();
  const x = {
    field: "x",
    type: "quantitative",
    axis: null,
    scale: { domain: [{ expr: "-reach" }, { expr: "reach" }], nice: false, zero: false },
  };
  const y = {
    field: "y",
    type: "quantitative",
    axis: null,
    scale: { domain: [{ expr: "-0.1 * reach" }, { expr: "1.02 * reach" }], nice: false, zero: false },
  };
  const order = { field: "order", type: "quantitative" };
  const path = (name, mark, more) => ({
    data: { name },
    mark: { type: "line", ...mark },
    encoding: { x, y, order, ...more },
  });
  const detail = { field: "label", type: "nominal" };
  const colour = { field: "colour", type: "nominal", scale: null };
  const strokeDash = { field: "dash", type: "nominal", scale: null };
  const opacity = { field: "opacity", type: "quantitative", scale: null };
  return {
    $schema: "https://vega.github.io/schema/vega-lite/v6.json",
    width: "container",
    height: "container",
    autosize: { type: "fit", contains: "padding" },
    view: { stroke: null },
    params: [{ name: "reach", value: 1 }],
    datasets: { lobes: [], densities: [], grid: [], labels: [], view: [], tip: [] },
    layer: [
      path("grid", { color: faint, strokeWidth: 1 }, { detail: { field: "part", type: "nominal" } }),
      path(
        "lobes",
        { filled: true, color: reference, fillOpacity: 0.16, stroke: reference, strokeWidth: 1 },
        { detail },
      ),
      path("view", { color: line, strokeWidth: 1.4 }, {}),
      {
        data: { name: "tip" },
        mark: { type: "text", text: "wo", dx: 12, dy: 2, color: text, fontSize: 12, fontStyle: "italic" },
        encoding: { x, y },
      },
      path("densities", { strokeWidth: 1.8 }, { color: colour, strokeDash, opacity, detail }),
      {
        data: { name: "labels" },
        mark: { type: "text", dy: 10, color: text, fontSize: 10.5 },
        encoding: { x, y, text: { field: "text" } },
      },
    ],
  };
}
