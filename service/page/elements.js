// Elements with text: the one place where the page makes markup, and it only ever sets text and attributes.

const SVG = "http://www.w3.org/2000/svg";

/** The element of this id, which the page has. */
export const byId = (id) => document.getElementById(id);

/** A new element with attributes and children; a child that is no element becomes text. */
export function element(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

function filled(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** A short line in the colour and dashes of a curve. */
export function swatch({ colour, dash, opacity = 1 }) {
  const line = filled(
    document.createElementNS(SVG, "line"),
    { x1: 0, y1: 6, x2: 30, y2: 6, stroke: colour, "stroke-width": 3, "stroke-dasharray": dash.join(" "), opacity },
    [],
  );
  return filled(
    document.createElementNS(SVG, "svg"),
    { class: "swatch", width: 30, height: 12, viewBox: "0 0 30 12", "aria-hidden": "true" },
    [line],
  );
}

/** Say something to screen readers, when they have time. */
export function announce(text) {
  byId("announcer").textContent = text;
}
