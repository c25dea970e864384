"use strict";
// Places of the numbers of stems: above the dot or beside it, the largest first, clear of stems and of other numbers. Where one
// has no room, it and its neighbours stand in a staircase to one side, each with a line down to its dot (`led`). `half` is half
// the width of its words, `px` the pixels of the canvas in one of the page.
function placed(dots, zero, edges, px) {
  const apart = (a, b, least) => Math.abs(a - b) >= least;
  const ofStem = ([x, y], half) => (d) => {
    const [top, bottom] = [Math.min(d.y, zero) - 12 * px, Math.max(d.y, zero) + 12 * px];
    return apart(d.x, x, half + 6 * px) || y <= top || y >= bottom;
  };
  const ofWords = ([x, y], half) => (w) => apart(w.at[0], x, w.half + half + 4 * px) || apart(w.at[1], y, 14 * px);
  // A line stands at its dot, between the dot and its words.
  const ofLine = ([x, y], half) => ({ led }) => !led || apart(led[0][0], x, half + px) ||
    y + 7 * px < Math.min(led[0][1], led[1][1]) || y - 7 * px > Math.max(led[0][1], led[1][1]);
  const line = (dot, [, y]) => [[dot.x, y + Math.sign(dot.y - y) * 5 * px], [dot.x, dot.y]];
  const clear = (at, half, found) => at[0] - half >= edges.left && at[0] + half <= edges.right && at[1] >= 7 * px &&
    [[dots, ofStem], [found, ofWords], [found, ofLine]].every(([all, of]) => all.every(of(at, half)));

  const run = (order, kept, places) => order.reduce((found, dot) => {
    const own = places(dot).map(([x, y, led]) => ({ dot, words: dot.words, half: dot.half, at: [dot.x + x, dot.y + y], led }));
    const lead = (one) => ({ ...one, led: one.led ? line(dot, one.at) : null });
    const free = (one) => clear(one.at, one.half, found) && (!one.led || found.every((w) => ofLine(w.at, w.half)(one)));
    const one = own.map(lead).find(free);
    return one ? [...found, one] : found;
  }, kept);
  const up = (dot) => (dot.value < 0 ? 14 : -14) * px, beside = (dot) => dot.half + 8 * px;
  const near = (dot) => {
    const [y, x] = [up(dot), beside(dot)];
    return [[0, y], [x / 2, y], [-x / 2, y], [x, 0], [-x, 0], [0, 2 * y]];
  };
  const stairs = (side) => (dot) => {
    const rows = Array.from({ length: 40 }, (_, k) => [side * (dot.half + 4 * px), up(dot) * k / 4, true]);
    return [[side * beside(dot), 0], ...rows];
  };

  const bySize = [...dots].sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
  const first = run(bySize, [], near);
  const missing = dots.filter((dot) => first.every((w) => w.dot !== dot));
  const crowded = (dot) => missing.some((other) => !apart(dot.x, other.x, dot.half + other.half));
  const kept = first.filter((w) => !crowded(w.dot));
  const beginning = (side) => dots.filter(crowded).sort((a, b) => side * (b.x - a.x));
  const tries = missing.length ? [-1, 1].map((side) => run(beginning(side), kept, stairs(side))) : [];
  return [first, ...tries].reduce((best, one) => (one.length > best.length ? one : best));
}
