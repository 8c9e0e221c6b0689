// The list of curves: each with a button that shows or hides it, and its verdict in words with the evidence.

import { byId, element, swatch } from "./elements.js";
import { degrees, short } from "./numbers.js";

// Findings that say something of the numbers of this run; the others say something of the technique.
const OF_THE_RUN = new Set(["heavy-tail", "imprecise"]);
const LISTED = 6;

/** Show the curves. `onToggle(key)` hears which one is to be shown or hidden. */
export function showCurves(curves, onToggle) {
  const list = byId("curves");
  const focused = document.activeElement?.dataset?.curve;
  const open = new Set([...list.querySelectorAll("details[open]")].map((one) => one.dataset.of));
  list.replaceChildren(...curves.map((curve) => row(curve, onToggle, open)));
  if (focused) [...list.querySelectorAll("button")].find((one) => one.dataset.curve === focused)?.focus();
}

function row(curve, onToggle, open) {
  const button = element(
    "button",
    {
      type: "button",
      class: "toggle",
      "aria-pressed": String(curve.shown),
      "data-curve": curve.key,
      title: "show or hide",
    },
    swatch(curve),
    element("span", {}, curve.label),
  );
  button.addEventListener("click", () => onToggle(curve.key));
  return element("li", {}, button, ...verdict(curve, open));
}

function verdict({ series, key }, open) {
  if (!series.verdict) return [element("span", { class: "badge waiting" }, "… measuring")];
  const { status, findings } = series.verdict;
  if (status === "ok") {
    const checked = series.reference
      ? "agrees with the float64 reference at every angle"
      : "nothing found; there is no reference to compare with";
    return [element("span", { class: "badge good" }, "✓ ok"), element("p", {}, checked)];
  }
  const kind = findings.every((one) => OF_THE_RUN.has(one.name)) ? "fair" : "bad";
  const badge = element("span", { class: `badge ${kind}` }, `${kind === "fair" ? "△" : "✕"} ${status}`);
  return [badge, ...findings.map((one) => finding(one, `${key} ${one.name}`, open, findings.length > 1))];
}

function finding({ name, message, evidence }, id, open, named) {
  const facts = Object.entries(evidence).map(([key, value]) => [
    element("dt", {}, key),
    element("dd", {}, fact(key, value)),
  ]);
  const words = named ? `${name}: ${message}` : message;
  const summary = element("summary", { title: "show the evidence" }, words);
  return element("details", { "data-of": id, open: open.has(id) }, summary, element("dl", {}, ...facts.flat()));
}

/** A piece of evidence in words: numbers one by one where they are few, else their count and range. */
function fact(name, value) {
  if (!Array.isArray(value)) return typeof value === "number" ? short(value) : text(value);
  const write = name.endsWith("_deg") ? degrees : short;
  const numbers = value.filter((one) => typeof one === "number");
  if (numbers.length < value.length && value.some((one) => one !== null && typeof one === "object")) {
    return value.length > 1 ? `${text(value[0])} and ${value.length - 1} more` : text(value[0]);
  }
  if (!numbers.length) return "none";
  if (numbers.length <= LISTED) return numbers.map((one) => write(one)).join(", ");
  const spread = [Math.min(...numbers), Math.max(...numbers)].map((one) => write(one));
  return `${numbers.length} values, ${spread[0] === spread[1] ? `all ${spread[0]}` : spread.join(" to ")}`;
}

const text = (value) => (typeof value === "string" ? value : JSON.stringify(value));
