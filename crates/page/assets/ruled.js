"use strict";
// The leading digit of a number that has no other digit, else 0.
function leading(value) {
  const digit = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
  return Math.abs(digit - Math.round(digit)) < 1e-6 ? Math.round(digit) : 0;
}
// Lines of a logarithmic axis stand at round numbers; at powers of ten alone where a decade has less than DECADE px.
const DECADE = 60;
function ruled(spec) {
  if (!spec.log) return (u, splits) => splits;
  return (u, splits, index) => {
    const upright = u.axes[index].side % 2, { min, max } = u.scales[upright ? "y" : "x"];
    const decade = (upright ? u.bbox.height : u.bbox.width) / devicePixelRatio / Math.log10(max / min);
    return splits.map((v) => (leading(v) === 1 || (leading(v) && decade >= DECADE) ? v : null));
  };
}
