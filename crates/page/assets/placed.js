"use strict";
// Places of the numbers of stems, the largest first: above the dot or beside it, clear of stems and of other numbers. One
// without room has none. `half` is half the width of its words, `px` the pixels of the canvas in one of the page.
function placed(dots, zero, edges, px) {
  const found = [], apart = (a, b, least) => Math.abs(a - b) >= least;
  for (const dot of [...dots].sort((a, b) => Math.abs(b.value) - Math.abs(a.value))) {
    const { half, words } = dot, up = (dot.value < 0 ? 14 : -14) * px, beside = half + 8 * px;
    const ofStem = (x, y) => (d) => {
      const [top, bottom] = [Math.min(d.y, zero) - 12 * px, Math.max(d.y, zero) + 12 * px];
      return apart(d.x, x, half + 6 * px) || y <= top || y >= bottom;
    };
    const ofWords = (x, y) => (w) => apart(w.at[0], x, w.half + half + 4 * px) || apart(w.at[1], y, 14 * px);
    const clear = ([x, y]) =>
      x - half >= edges.left && x + half <= edges.right && y >= 7 * px && dots.every(ofStem(x, y)) && found.every(ofWords(x, y));
    const places = [[0, up], [beside / 2, up], [-beside / 2, up], [beside, 0], [-beside, 0], [0, 2 * up]];
    const at = places.map(([x, y]) => [dot.x + x, dot.y + y]).find(clear);
    if (at) found.push({ words, half, at });
  }
  return found;
}
