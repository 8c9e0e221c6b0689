// What stands beside the pointer: a title and lines of name and value.

import { byId, element, swatch } from "./elements.js";

const GAP = 14;

/** Show lines of {curve, name, value} at a pointer; a `curve` adds its line. */
export function showHover(event, title, lines) {
  const box = byId("hover");
  const rows = lines.map(({ curve, name, value }) =>
    element("div", {}, curve ? swatch(curve) : null, element("span", {}, name), element("b", {}, value)),
  );
  box.replaceChildren(element("strong", {}, title), ...rows);
  box.hidden = false;
  const { width, height } = box.getBoundingClientRect();
  const left = event.clientX + GAP + width > innerWidth ? event.clientX - GAP - width : event.clientX + GAP;
  const top = Math.min(event.clientY + GAP, innerHeight - height - GAP);
  box.style.setProperty("left", `${Math.max(4, left)}px`);
  box.style.setProperty("top", `${Math.max(4, top)}px`);
}

/** Take it away. */
export function hideHover() {
  byId("hover").hidden = true;
}
