// The catalogue: models and techniques as their shader files declare them.

import { json } from "./server.js";

/** Models, techniques and their parameters. */
export class Catalogue {
  static async load() {
    return new Catalogue(await json("/v1/catalogue"));
  }

  constructor({ models, techniques }) {
    this.models = models;
    this.techniques = techniques;
    this.#model = new Map(models.map((one) => [one.name, one]));
    this.#technique = new Map(techniques.map((one) => [one.name, one]));
    /** Every declared parameter by name, to know one in an address. */
    this.parameters = new Map([...techniques, ...models].flatMap((one) => Object.entries(one.parameters)));
  }

  #model;
  #technique;

  /** The model of this name, or undefined: an address may hold anything. */
  model(name) {
    return this.#model.get(name);
  }

  /** The technique of this name, or undefined. */
  technique(name) {
    return this.#technique.get(name);
  }

  /** Whether the azimuth of the view matters. */
  anisotropic(name) {
    return this.model(name)?.anisotropic ?? false;
  }

  /** Names of the techniques of a state: those chosen, or all that are made for its model. */
  techniquesOf({ techniques, model }) {
    if (techniques !== null) return techniques;
    const fitting = this.techniques.filter((one) => one.models === "any" || one.models.includes(model));
    const rank = (one) => (one.models === "any" ? 0 : 1);
    return fitting.sort((a, b) => rank(a) - rank(b)).map((one) => one.name);
  }

  /**
   * Parameters of a state's model and techniques, {name, min, max, default, unit, help}. A technique that runs on a model
   * without a parameter it reads takes the declaration of a model it was made for.
   */
  parametersOf(state) {
    const found = { ...this.model(state.model)?.parameters };
    for (const name of this.techniquesOf(state)) {
      const technique = this.#technique.get(name);
      if (!technique) continue;
      Object.assign(found, { ...technique.parameters, ...found });
      for (const used of technique.uses) {
        found[used] ??= this.model(technique.models.find((one) => used in this.model(one).parameters)).parameters[used];
      }
    }
    return Object.entries(found).map(([name, declared]) => ({ name, ...declared }));
  }

  /** Names of the parameters that the density of a state's techniques depends on, which an efficiency may vary with. */
  readParameters(state) {
    const techniques = this.techniquesOf(state)
      .map((name) => this.#technique.get(name))
      .filter(Boolean);
    const read = new Set(techniques.flatMap((one) => [...one.uses, ...Object.keys(one.parameters)]));
    const all = this.parametersOf(state).map(({ name }) => name);
    return [...all.filter((name) => read.has(name)), ...all.filter((name) => !read.has(name))];
  }

  /** A state whose every parameter has a value. */
  complete(state) {
    const parameters = { ...state.parameters };
    for (const { name, default: value } of this.parametersOf(state)) parameters[name] ??= String(value);
    return { ...state, parameters };
  }
}
