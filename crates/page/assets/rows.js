"use strict";
// Places of the words above the curves, in rows: each right of its line or, where that is not clear, left of it. `at` is the place
// on the abscissa, px; `end` is the last one; `widthOf` measures words. A word of a stretch has no line. Where lines and words leave
// no clear row within FEW, a line may cross a word: a chart that is all rows shows no curve.
const FEW = 4;
function inRows(items, end, widthOf) {
  const found = [];
  const crosses = (f, row, left, width, at, line) =>
    (f.line && f.row >= row && left - 3 < f.at && f.at < left + width + 3) ||
    (line && f.row < row && f.left - 3 < at && at < f.left + f.width + 3);
  const overlaps = (f, row, left, width) => f.row === row && left - 8 < f.left + f.width && f.left < left + width + 8;
  for (const { label, at, line } of told(items)) {
    const width = widthOf(label), inside = (left) => left >= 0 && left + width <= end;
    const [right, left] = [at + (line ? 5 : 2), at - 5 - width];
    const sides = (line ? [right, left] : [right]).filter(inside);
    if (!sides.length) sides.push(Math.max(0, Math.min(right, end - width)));
    const places = [...Array(FEW + items.length).keys()].flatMap((row) => sides.map((side) => [row, side]));
    const apart = ([row, side]) => !found.some((f) => overlaps(f, row, side, width));
    const clear = ([row, side]) => row < FEW && !found.some((f) => crosses(f, row, side, width, at, line));
    const [row, side] = places.find((place) => apart(place) && clear(place)) ?? places.find(apart);
    found.push({ label, at, line, left: side, width, row });
  }
  return found;
}

// Lines of the same words that fall on one place are told once, with their number.
function told(items) {
  const groups = [];
  for (const item of items) {
    const near = groups.find((g) => item.line && g.line && g.label === item.label && Math.abs(g.at - item.at) < 4);
    if (near) near.count++;
    else groups.push({ ...item, count: 1 });
  }
  return groups.map((g) => ({ ...g, label: g.count > 1 ? `${g.label} (${g.count})` : g.label }));
}
