// How far a question is: a bar, the time since it began, a button that cancels it, and words at its end.

import { announce, element } from "./elements.js";
import { duration } from "./numbers.js";

const TICK_MS = 100;

/** A line about one question in an element. `onCancel` and `onAgain` are what its buttons do. */
export class Progress {
  #bar = element("progress", { max: 1, "aria-label": "Share that is done" });
  #words = element("span", { class: "words" });
  #elapsed = element("span", { class: "elapsed" });
  #cancel = element("button", { type: "button" }, "Cancel");
  #again = element("button", { type: "button" }, "Ask again");
  #began = 0;
  #timer = null;

  constructor(container, { onCancel, onAgain }) {
    container.replaceChildren(this.#words, this.#bar, this.#elapsed, this.#cancel, this.#again);
    this.#cancel.addEventListener("click", onCancel);
    this.#again.addEventListener("click", onAgain);
    this.#show(false, false);
  }

  /** A question begins. */
  begin(words) {
    this.#began = performance.now();
    this.#words.textContent = words;
    this.#bar.removeAttribute("value");
    this.#show(true, false);
    clearInterval(this.#timer);
    this.#timer = setInterval(() => this.#tick(), TICK_MS);
    this.#tick();
  }

  /** It got further: `done` of `total` samples. */
  further(done, total, name) {
    const share = total ? Math.min(1, done / total) : 0;
    this.#bar.value = share;
    this.#words.textContent = name ? `${name}, ${Math.floor(100 * share)} %` : `waiting, ${Math.floor(100 * share)} %`;
  }

  /** The server is away. */
  away(message) {
    this.#bar.removeAttribute("value");
    const words = `${message}. Trying again …`;
    this.#words.textContent = words;
    announce(words);
  }

  /** It is over; `again` offers to ask once more. Milliseconds since it began. */
  end(words, again = false) {
    clearInterval(this.#timer);
    this.#tick();
    this.#words.textContent = words;
    this.#show(false, again);
    announce(words);
  }

  /** Milliseconds since it began. */
  get elapsed() {
    return performance.now() - this.#began;
  }

  #tick() {
    this.#elapsed.textContent = duration(this.elapsed);
  }

  #show(running, again) {
    this.#bar.hidden = this.#cancel.hidden = this.#elapsed.hidden = !running;
    this.#again.hidden = !again;
  }
}
