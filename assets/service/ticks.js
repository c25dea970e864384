// Round numbers along an axis.

const DECIMAL = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
const ANGLES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720];

/** Round numbers from the least to the most, at most seven where the steps reach so far. */
export function ticks(least, most, steps = DECIMAL) {
  const step = steps.find((one) => (most - least) / one <= 6) ?? steps[steps.length - 1];
  const [first, last] = [Math.ceil(least / step), Math.floor(most / step)];
  return Array.from({ length: last - first + 1 }, (_, k) => Number(((first + k) * step).toFixed(1)));
}

/** Round angles, deg. */
export const angles = (least, most) => ticks(least, most, ANGLES);
