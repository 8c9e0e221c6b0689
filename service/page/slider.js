// How the way of a slider maps to a parameter's range.

export const STEPS = 1000;

// A default this near to the lower end of its range means that most of the range is of little interest.
const LOW_DEFAULT = 0.1;

/**
 * Functions `value(position)` and `position(value)` between 0..STEPS and a range. Where the default lies near the lower
 * end, as that of an exponent up to a million, the way is exponential and has the default in its middle.
 */
export function sliderScale({ min, max, default: middle }) {
  const share = (middle - min) / (max - min);
  if (!(share > 0 && share < LOW_DEFAULT)) {
    return {
      value: (position) => rounded(min + ((max - min) * position) / STEPS),
      position: (value) => (STEPS * (value - min)) / (max - min),
    };
  }
  const rate = 2 * Math.log(1 / share - 1);
  return {
    value: (position) => rounded(min + ((max - min) * Math.expm1((rate * position) / STEPS)) / Math.expm1(rate)),
    position: (value) => (STEPS * Math.log1p(((value - min) / (max - min)) * Math.expm1(rate))) / rate,
  };
}

const rounded = (value) => Number(value.toPrecision(3));
