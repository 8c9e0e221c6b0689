// Numbers as people read them.

/** Four significant digits; powers of ten where decimals would be long. */
export function short(value, digits = 4) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3)
    return value
      .toExponential(digits - 1)
      .replace(/\.?0+e/, "e")
      .replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

/** A value with its standard error: both to the two digits that the error knows. */
export function withError(value, error) {
  if (value === null || value === undefined) return "–";
  if (!error || !Number.isFinite(error)) return short(value);
  const size = Math.abs(value);
  const decimals = 1 - Math.floor(Math.log10(error));
  if ((size !== 0 && size < 1e-3) || decimals > 7 || decimals < 0) return `${short(value)} ± ${short(error, 2)}`;
  return `${value.toFixed(decimals)} ± ${error.toFixed(decimals)}`;
}

/** Degrees, to hundredths. */
export const degrees = (value) => `${Number(value.toFixed(2))}°`;

/** Milliseconds in the unit that suits them. */
export function duration(ms) {
  if (ms >= 6e4) return `${Math.floor(ms / 6e4)} min ${Math.round((ms % 6e4) / 1e3)} s`;
  if (ms >= 1e3) return `${(ms / 1e3).toFixed(1)} s`;
  return `${Math.round(ms)} ms`;
}
