// Curves: the series of a result as they are drawn, each with a name, a colour and dashes.

import { short } from "./numbers.js";
import { techniqueStyles } from "./theme.js";

export const STATISTICS = ["variance", "max_weight", "mean"];
export const LOG = { variance: true, max_weight: true, mean: false };

// A variance below this is rounding of zero, and is not drawn on a logarithmic axis.
const LEAST_POSITIVE = 1e-12;
const MARKERS = 22;

/**
 * {key, label, technique, series, colour, dash, opacity, shown} of every series. Where a parameter is swept its value is
 * part of the name, and later values are drawn more strongly.
 */
export function curvesOf(series, hidden) {
  const styles = techniqueStyles([...new Set(series.map((one) => one.technique))]);
  const swept = sweptNames(series);
  const count = new Map();
  const place = series.map((one) => {
    const index = count.get(one.technique) ?? 0;
    count.set(one.technique, index + 1);
    return index;
  });
  return series.map((one, index) => {
    const values = swept.map((name) => `${name} ${short(valueOf(one, name))}`);
    const label = [one.technique, ...values].join(", ");
    const last = count.get(one.technique) - 1;
    const opacity = last ? 0.4 + (0.6 * place[index]) / last : 1;
    const { technique } = one;
    return {
      key: label,
      label,
      technique,
      series: one,
      ...styles.get(technique),
      opacity,
      shown: !hidden.includes(label),
    };
  });
}

function sweptNames(series) {
  const names = new Set(series.flatMap((one) => [...Object.keys(one.parameters), "phi_o_deg"]));
  const varies = (name) => {
    const first = new Map();
    return series.some((one) => {
      const value = valueOf(one, name);
      if (!first.has(one.technique)) first.set(one.technique, value);
      return first.get(one.technique) !== value;
    });
  };
  return [...names].filter(varies);
}

const valueOf = (one, name) => (name === "phi_o_deg" ? one.phi_o_deg : one.parameters[name]);

/** Whether a statistic's sampled value at an angle has no limit, by the verdict and the reference. */
export function noLimit(series, statistic) {
  const finding = (name) => series.verdict?.findings.find((one) => one.name === name);
  const infinite = new Set(finding("infinite-variance")?.evidence.theta_o_deg ?? []);
  if (statistic === "variance") return series.theta_o_deg.map((angle) => infinite.has(angle));
  if (statistic !== "max_weight") return series.theta_o_deg.map(() => false);
  const truth = series.reference?.max_weight;
  return series.theta_o_deg.map((angle, index) => (truth ? truth[index] === null : infinite.has(angle)));
}

const drawable = (value, log) => value !== null && value !== undefined && (!log || value > LEAST_POSITIVE);

/**
 * The rows of a curve that a panel draws: `value` with the ends of its error band, `limit` where it converges, `run` for
 * unbroken stretches, `marker` where there is a point: alone, or some of those without limit.
 */
export function sampledRows(curve, statistic) {
  const { series } = curve;
  const values = series[statistic] ?? [];
  const errors = series[`${statistic}_stderr`];
  const endless = noLimit(series, statistic);
  const rows = [];
  let run = 0;
  values.forEach((value, index) => {
    if (!drawable(value, LOG[statistic])) return void (run += 1);
    const limit = !endless[index];
    if (rows.length && rows.at(-1).limit !== limit) run += 1;
    const error = limit ? (errors?.[index] ?? null) : null;
    rows.push({ ...look(curve), theta: series.theta_o_deg[index], value, error, limit, run: `${curve.key} ${run}` });
  });
  const alone = new Map();
  for (const row of rows) alone.set(row.run, (alone.get(row.run) ?? 0) + 1);
  const every = Math.max(1, Math.ceil(rows.length / MARKERS));
  return rows.map((row, index) => ({
    ...row,
    marker: alone.get(row.run) === 1 || (!row.limit && index % every === 0),
  }));
}

/** The rows of a curve's reference. */
export function referenceRows(curve, statistic) {
  const rows = [];
  let run = 0;
  (curve.series.reference?.[statistic] ?? []).forEach((value, index) => {
    if (!drawable(value, LOG[statistic])) return void (run += 1);
    rows.push({ ...look(curve), theta: curve.series.theta_o_deg[index], value, run: `${curve.key} ${run}` });
  });
  return rows;
}

const look = ({ colour, dash, opacity }) => ({ colour, dash, opacity });
