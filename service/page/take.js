// What can be taken away: a link, a command, the Vega-Lite spec, and files of the result.

import { addressOf, commandLine, questionPath } from "./address.js";
import { announce, byId, element } from "./elements.js";
import { blob, hasKey } from "./server.js";

/** The menus. `current()` is the state that the page shows. */
export function offer(catalogue, current) {
  const texts = {
    link: async (state) => location.origin + addressOf(state, catalogue),
    curl: async (state) => curl(questionPath("statistics", state, catalogue)),
    cli: async (state) => commandLine(state, catalogue),
    vega: async (state) =>
      (await blob(questionPath("statistics", state, catalogue, { format: "vega" }), anyType)).text(),
  };
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () =>
      act(button, async () => copied(button, await texts[button.dataset.copy](current()))),
    );
  }
  for (const button of document.querySelectorAll("[data-download]")) {
    const format = button.dataset.download;
    button.addEventListener("click", () => act(button, () => download(current(), catalogue, format)));
  }
  closeWhenLeft();
}

const anyType = { headers: { accept: "*/*" } };

function curl(path) {
  const key = hasKey() ? ` -H "X-API-Key: $SAMPLERSCOPE_API_KEY"` : "";
  return `curl${key} '${location.origin}${path}'`;
}

/** Do what a button is for; say so where it fails. */
async function act(button, work) {
  // Not `disabled`: that would take the focus away.
  if (button.ariaBusy === "true") return;
  button.ariaBusy = "true";
  try {
    await work();
  } catch (error) {
    say(button, `This did not work: ${error.message}`);
  } finally {
    button.ariaBusy = "false";
  }
}

function say(button, words) {
  const menu = button.closest("div");
  menu.querySelector(".note")?.remove();
  menu.append(element("p", { class: "note" }, words));
  announce(words);
}

async function copied(button, text) {
  try {
    await navigator.clipboard.writeText(text);
    say(button, `Copied: ${button.textContent}`);
  } catch {
    // Browsers give the clipboard to secure pages only: the text is there to be copied by hand.
    const area = element("textarea", { readonly: true, rows: 4, "aria-label": button.textContent });
    area.value = text;
    const menu = button.closest("div");
    menu.querySelector("textarea")?.remove();
    menu.append(area);
    area.select();
    say(button, "Press Ctrl+C to copy");
  }
}

async function download(state, catalogue, format) {
  const url = URL.createObjectURL(await blob(questionPath("statistics", state, catalogue, { format }), anyType));
  const link = element("a", { href: url, download: `${state.model}.${format}` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
  byId("download").open = false;
  announce(`Downloaded: ${format.toUpperCase()}`);
}

/** A menu closes with Escape, with a click elsewhere, and when the focus leaves it. */
function closeWhenLeft() {
  const menus = document.querySelectorAll("details.menu");
  document.addEventListener("click", (event) => {
    for (const menu of menus) if (!menu.contains(event.target)) menu.open = false;
  });
  for (const menu of menus) {
    menu.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      menu.open = false;
      menu.querySelector("summary").focus();
    });
    menu.addEventListener("focusout", (event) => {
      if (event.relatedTarget && !menu.contains(event.relatedTarget)) menu.open = false;
    });
  }
}
