// The controls of a scene, made from the catalogue. They hold texts; what is wrong with a text the server says.

import { byId, element } from "./elements.js";
import { short } from "./numbers.js";
import { STEPS, sliderScale } from "./slider.js";

const ESTIMATOR = [
  { field: "theta_o_deg", name: "angles", label: "View angles", note: "a number of them, or degrees: 0, 45, 89.9" },
  { field: "phi_o_deg", name: "azimuth", label: "View azimuth (degrees)", note: "the model is anisotropic" },
  { field: "estimator.samples", name: "samples", label: "Samples per angle", note: "" },
  { field: "estimator.seed", name: "seed", label: "Seed", note: "equal seeds give equal bits" },
];
const WIDE = matchMedia("(min-width: 900px)");
const METHODS = { mc: "mc: random numbers", qmc: "qmc: scrambled Sobol'", quadrature: "quadrature: no noise" };

/** The form. `onChange(state, settled)` hears every change; `settled` is false while a slider moves. */
export class Controls {
  #catalogue;
  #onChange;
  #state = null;
  #layout = "";
  #sliders = new Map();

  constructor(catalogue, onChange) {
    this.#catalogue = catalogue;
    this.#onChange = onChange;
    byId("scene").addEventListener("submit", (event) => event.preventDefault());
    for (const { name, title } of catalogue.models)
      byId("model").append(element("option", { value: name }, `${name}: ${title}`));
    byId("model").addEventListener("change", () => {
      this.#change(
        { model: byId("model").value, techniques: null, parameters: {}, azimuth: "", hidden: [], over: null },
        true,
      );
    });
    this.#makeEstimator();
    // Where the results come below the controls, on a phone, groups are closed so that they are near.
    for (const group of document.querySelectorAll("details.group")) group.open = WIDE.matches;
  }

  /** Show a state. Controls that stay the same stay where they are, so that the focus does too. */
  show(state) {
    this.#state = state;
    const { model } = state;
    const layout = JSON.stringify([model, this.#catalogue.parametersOf(state)]);
    if (layout !== this.#layout) {
      this.#layout = layout;
      this.#makeParameters();
    }
    if (!this.#catalogue.model(model)) byId("model").append(element("option", { value: model }, model));
    byId("model").value = model;
    byId("model-note").textContent = this.#catalogue.model(model)?.source ?? "";
    for (const name of this.#sliders.keys()) this.#showParameter(name);
    this.#showTechniques();
    for (const { name } of ESTIMATOR) byId(name).value = state[name];
    byId("method").value = state.method;
    byId("azimuth").closest(".field").hidden = !this.#catalogue.anisotropic(model);
  }

  /** Show what is wrong at the fields it is wrong at: {field, value, allowed} each. What has no field stands below. */
  showErrors(fields, detail = "") {
    this.clearErrors();
    const elsewhere = fields
      .filter((one) => !showError(one))
      .map((one) => `${one.field} = ${one.value}: ${one.allowed}`);
    if (!fields.length && detail) elsewhere.push(detail);
    byId("scene-error").textContent = elsewhere.join("; ");
    byId("scene-error").hidden = !elsewhere.length;
  }

  /** Nothing is wrong any more. */
  clearErrors() {
    byId("scene-error").hidden = true;
    for (const error of byId("scene").querySelectorAll("[data-field] > .error")) error.remove();
    for (const input of byId("scene").querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
  }

  #change(changed, settled) {
    this.#onChange(this.#catalogue.complete({ ...this.#state, ...changed }), settled);
  }

  #makeEstimator() {
    const fields = ESTIMATOR.map(({ field, name, label, note }) => {
      const input = element("input", { id: name, type: "text", inputmode: "decimal", autocomplete: "off" });
      input.setAttribute("aria-describedby", `${name}-note`);
      input.addEventListener("change", () => this.#change({ [name]: input.value }, true));
      const words = element("p", { class: "note", id: `${name}-note` }, note);
      return element(
        "div",
        { class: "field", "data-field": field },
        element("label", { for: name }, label),
        input,
        words,
      );
    });
    const select = element("select", { id: "method" });
    for (const [name, label] of Object.entries(METHODS)) select.append(element("option", { value: name }, label));
    select.addEventListener("change", () => this.#change({ method: select.value }, true));
    const method = element("div", { class: "field", "data-field": "estimator.method" });
    method.append(element("label", { for: "method" }, "Estimator"), select);
    byId("estimator").replaceChildren(...fields.slice(0, 2), method, ...fields.slice(2));
  }

  #makeParameters() {
    this.#sliders.clear();
    const parameters = this.#catalogue.parametersOf(this.#state);
    byId("parameters").replaceChildren(...parameters.map((one) => this.#makeParameter(one)));
    byId("parameters").parentElement.hidden = !parameters.length;
  }

  #makeParameter(parameter) {
    const { name, min, max, unit, help } = parameter;
    const scale = sliderScale(parameter);
    const [id, noteId] = [`parameter-${name}`, `parameter-${name}-note`];
    const label = unit ? `${name} (${unit})` : name;
    const text = element("input", {
      id,
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      "aria-describedby": noteId,
    });
    const slider = element("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": `${label}, slider` });
    const set = (value, settled) => this.#change({ parameters: { ...this.#state.parameters, [name]: value } }, settled);
    text.addEventListener("change", () => set(text.value, true));
    slider.addEventListener("input", () => set(String(scale.value(slider.valueAsNumber)), false));
    slider.addEventListener("change", () => set(String(scale.value(slider.valueAsNumber)), true));
    this.#sliders.set(name, { text, slider, scale });
    const note = `${help ? `${help}; ` : ""}${short(min)} to ${short(max)}`;
    return element(
      "div",
      { class: "field parameter", "data-field": `parameters.${name}` },
      element("label", { for: id }, label),
      text,
      slider,
      element("p", { class: "note", id: noteId }, note),
    );
  }

  #showParameter(name) {
    const { text, slider, scale } = this.#sliders.get(name);
    const value = this.#state.parameters[name] ?? "";
    text.value = value;
    const number = Number(value);
    slider.disabled = value.includes(",");
    if (value.trim() && Number.isFinite(number)) slider.value = scale.position(number);
    slider.setAttribute("aria-valuetext", value);
  }

  #showTechniques() {
    const chosen = this.#catalogue.techniquesOf(this.#state);
    const unknown = chosen.filter((name) => !this.#catalogue.techniques.some((one) => one.name === name));
    const box = (one) => this.#technique(one, chosen.includes(one.name));
    const all = this.#catalogue.techniquesOf({ ...this.#state, techniques: null });
    const fitting = all.map((name) => box(this.#catalogue.technique(name)));
    const others = this.#catalogue.techniques.filter((one) => !all.includes(one.name)).map(box);
    fitting.push(...unknown.map((name) => box({ name, title: "not in the catalogue" })));
    const focused = document.activeElement?.id;
    const open =
      byId("techniques").querySelector("details")?.open || others.some((one) => one.querySelector(":checked"));
    const more = element("details", { open }, element("summary", {}, "made for other models"), ...others);
    byId("techniques").replaceChildren(...fitting, ...(others.length ? [more] : []));
    if (focused?.startsWith("technique-")) byId(focused)?.focus();
  }

  #technique({ name, title }, checked) {
    const id = `technique-${name}`;
    const input = element("input", { id, type: "checkbox", value: name });
    input.checked = checked;
    input.addEventListener("change", () => {
      const boxes = [...byId("techniques").querySelectorAll("input:checked")];
      this.#change({ techniques: boxes.map((one) => one.value) }, true);
    });
    return element(
      "div",
      { class: "choice" },
      input,
      element("label", { for: id }, name, " ", element("small", {}, title)),
    );
  }
}

/** Show a wrong field at the control of its path, or of the path that holds it; whether there is one. */
function showError({ field, value, allowed }) {
  for (let path = field; path; path = path.includes(".") ? path.slice(0, path.lastIndexOf(".")) : "") {
    const holder = byId("scene").querySelector(`[data-field="${CSS.escape(path)}"]`);
    if (!holder) continue;
    const id = `${path}-error`;
    const words = value === null || value === "" ? `allowed: ${allowed}` : `${value}: allowed is ${allowed}`;
    holder.append(element("p", { class: "error", id, role: "alert" }, words));
    const group = holder.closest("details.group");
    if (group) group.open = true;
    const input = holder.querySelector("input[type=text], select");
    input?.setAttribute("aria-invalid", "true");
    input?.setAttribute("aria-errormessage", id);
    return true;
  }
  return false;
}
