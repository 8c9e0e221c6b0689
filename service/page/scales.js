// Axes: which range of values a panel shows, and where a logarithmic one has its ticks; as service/figures/scales.py.

const STEPS = [1, 2, 5];
const MOST_DECADES = 7;
const LEAST_SPAN = 0.02;
// A variance of 1e200, which rare weights carry, would flatten everything else: its reference leaves the panel.
const MOST_BEYOND_SAMPLED = 10;

/** {low, high, ticks} of a logarithmic axis that shows all sampled values, and reference values not far beyond. */
export function logScale(sampled, reference) {
  const most = MOST_BEYOND_SAMPLED * Math.max(...sampled, 0) || Infinity;
  const values = [...sampled, ...reference.filter((value) => value <= most)];
  let low = below(values.length ? Math.min(...values) : 0.1);
  let high = above(values.length ? Math.max(...values) : 10);
  if (low === high) [low, high] = [low / 2, high * 2];
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const each = Math.max(1, Math.ceil((last - first) / MOST_DECADES));
  const marks = high / low < 50 ? STEPS : [1];
  const ticks = [];
  for (let power = first; power <= last; power += each) ticks.push(...marks.map((mark) => decimal(mark, power)));
  return { low, high, ticks: ticks.filter((tick) => low <= tick && tick <= high) };
}

/** {low, high, ticks} of a linear axis that shows all values with some room around them. */
export function linearScale(values) {
  const [least, most] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
  const span = Math.max(most - least, LEAST_SPAN);
  const middle = (least + most) / 2;
  const step = niceStep((1.2 * span) / 5);
  const [first, last] = [Math.floor((middle - 0.6 * span) / step), Math.ceil((middle + 0.6 * span) / step)];
  const ticks = Array.from({ length: last - first + 1 }, (_, index) =>
    Number(((first + index) * step).toPrecision(12)),
  );
  return { low: ticks[0], high: ticks.at(-1), ticks };
}

/** {low, high, ticks} of the view angle in degrees. */
export function angleScale(angles) {
  const [least, most] = [Math.min(...angles), Math.max(...angles)];
  if (most - least > 45) return { low: 0, high: 90, ticks: [0, 15, 30, 45, 60, 75, 90] };
  const room = most > least ? 0.04 * (most - least) : 1;
  const [low, high] = [Math.max(0, least - room), Math.min(90, most + room)];
  const step = niceStep((high - low) / 5);
  const first = Math.ceil(low / step);
  const ticks = Array.from({ length: Math.floor(high / step) - first + 1 }, (_, index) => (first + index) * step);
  return { low, high, ticks };
}

function niceStep(rough) {
  const power = Math.floor(Math.log10(rough));
  return decimal(
    [1, 2, 5, 10].find((mark) => mark * 10 ** power >= rough * 0.999),
    power,
  );
}

const decimal = (mark, power) => Number(`${mark}e${power}`);

function below(value) {
  const power = Math.floor(Math.log10(value));
  const marks = [power - 1, power].flatMap((each) => STEPS.map((mark) => decimal(mark, each)));
  return Math.max(...marks.filter((mark) => mark <= value));
}

function above(value) {
  const power = Math.floor(Math.log10(value));
  const marks = [power, power + 1].flatMap((each) => STEPS.map((mark) => decimal(mark, each)));
  return Math.min(...marks.filter((mark) => mark >= value));
}
