// The address is the scene: the query of the page is that of /v1/statistics, and what only the page needs stands under
// names with a dot, which no parameter of a shader can have.

/**
 * A scene with what is looked at. Values are texts as they were typed: the server says what is wrong with them.
 * `techniques` is null for all that are made for the model; `rest` are fields that have no control, passed on as they are.
 */
const DEFAULT = {
  model: "eon",
  parameters: {},
  techniques: null,
  angles: "64",
  azimuth: "",
  method: "mc",
  samples: "200000",
  seed: "0",
  rest: [],
  hidden: [],
  at: null,
  speed: false,
  over: null,
};

const PAGE = { hidden: "view.hide", at: "view.at", speed: "view.speed", over: "view.over" };
const OWN = { model: "model", azimuth: "phi_o_deg", method: "method", samples: "samples", seed: "seed" };

/** The state of an address. */
export function readAddress(query, catalogue) {
  const given = new URLSearchParams(query);
  const state = { ...DEFAULT, parameters: {}, rest: [] };
  for (const [field, name] of Object.entries(OWN)) state[field] = given.get(name) ?? DEFAULT[field];
  state.angles = given.get("theta_o_deg") ?? given.get("angles") ?? DEFAULT.angles;
  // One angle in degrees is written with a comma, to tell it from a count.
  if (given.has("theta_o_deg") && !isList(state.angles)) state.angles += ",";
  state.techniques = given.has("techniques") ? names(given.get("techniques")) : null;
  state.hidden = (given.get(PAGE.hidden) ?? "").split(";").filter(Boolean);
  state.at = Number.isFinite(parseFloat(given.get(PAGE.at))) ? parseFloat(given.get(PAGE.at)) : null;
  state.speed = given.has(PAGE.speed);
  state.over = given.get(PAGE.over);
  const known = new Set([...Object.values(OWN), ...Object.values(PAGE), "theta_o_deg", "angles", "techniques"]);
  for (const [name, value] of given) {
    if (known.has(name)) continue;
    if (catalogue.parameters.has(name)) state.parameters[name] = value;
    else state.rest.push([name, value]);
  }
  return state;
}

/** The address of a state, without the origin. */
export function addressOf(state, catalogue) {
  const query = sceneQuery(state, catalogue);
  if (state.hidden.length) query.set(PAGE.hidden, state.hidden.join(";"));
  if (state.at !== null) query.set(PAGE.at, state.at);
  if (state.speed) query.set(PAGE.speed, "1");
  if (state.over) query.set(PAGE.over, state.over);
  return `/?${text(query)}`;
}

/** The path that asks a server for a kind of answer to a state's scene, with fields replaced or, where null, left out. */
export function questionPath(kind, state, catalogue, replaced = {}) {
  const query = sceneQuery(state, catalogue);
  for (const [name, value] of Object.entries(replaced)) {
    if (value === null) query.delete(name);
    else query.set(name, value);
  }
  return `/v1/${kind}?${text(query)}`;
}

/** The command that prints the same result. */
export function commandLine(state, catalogue) {
  const words = ["samplerscope", "stats"];
  const options = { techniques: "technique" };
  for (const [name, value] of sceneQuery(state, catalogue)) {
    if (catalogue.parameters.has(name)) words.push("--set", `${name}=${value}`);
    else if (["error_bars", "reference"].includes(name))
      words.push(...(value === "false" ? [`--no-${dashed(name)}`] : []));
    else words.push(`--${dashed(options[name] ?? name)}`, value);
  }
  return words.map(quoted).join(" ");
}

function sceneQuery(state, catalogue) {
  const query = new URLSearchParams({ model: state.model });
  for (const { name } of catalogue.parametersOf(state)) query.set(name, trimmed(state.parameters[name]));
  query.set("techniques", catalogue.techniquesOf(state).join(","));
  query.set(isList(state.angles) ? "theta_o_deg" : "angles", trimmed(state.angles));
  if (state.azimuth && catalogue.anisotropic(state.model)) query.set("phi_o_deg", trimmed(state.azimuth));
  for (const name of ["method", "samples", "seed"]) query.set(name, state[name].trim());
  for (const [name, value] of state.rest) query.append(name, value);
  return query;
}

// Commas and slashes may stand in a query as they are, and read better.
const text = (query) => query.toString().replaceAll("%2C", ",").replaceAll("%2F", "/");
const isList = (angles) => /[,.]/.test(angles);
const names = (list) =>
  list
    .split(",")
    .map((name) => name.trim())
    .filter(Boolean);
const trimmed = (list) =>
  list
    .split(",")
    .map((part) => part.trim())
    .filter(Boolean)
    .join(",");
const dashed = (name) => name.replaceAll("_", "-");
const quoted = (word) => (/^[\w.,=/+-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`);
