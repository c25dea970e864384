"use strict";
(() => {
  const charts = JSON.parse(document.getElementById("curves").textContent);
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colour = (name) => getComputedStyle(root).getPropertyValue("--" + name).trim();
  const family = () => getComputedStyle(document.body).fontFamily;
  const DASHES = [[], [8, 4], [2, 3]];
  // The same as styles of a border.
  const BORDERS = ["solid", "dashed", "dotted"];
  // Pixels of the abscissa's name and of its ticks, and what both take of a chart's height with the margin above.
  const NAME = 22, TICKS = 30, BELOW = NAME + TICKS + 8;

  // As many digits as tell neighbours on an axis apart; powers of ten where they are shorter.
  function tidy(value, digits) {
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e6 || size < 1e-4) {
      const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
      return mantissa.replace(/\.?0+$/, "") + "e" + Number(exponent);
    }
    return String(Number(value.toPrecision(digits)));
  }
  const withUnit = (axis) => (axis.unit ? `${axis.name} (${axis.unit})` : axis.name);
  const measured = (axis) => (u, value) =>
    value == null ? "–" : tidy(value, 5) + (axis.unit ? "\u202f" + axis.unit : "");

  // Room for the longest label of an axis.
  function labelRoom(u, values, index, cycle) {
    const axis = u.axes[index];
    const longest = (values || []).reduce((a, b) => (b && b.length > a.length ? b : a), "");
    u.ctx.font = axis.font[0];
    const room = Math.ceil(axis.ticks.size + axis.gap + 6 + u.ctx.measureText(longest).width / devicePixelRatio);
    // It only grows while the chart is laid out, so that it comes to rest.
    return cycle > 1 ? Math.max(axis._size, room) : room;
  }

  // Whether the name of the ordinate fits along it; one that is longer stands above the chart.
  function fits(name, height) {
    const { ctx } = fits;
    ctx.font = `13px ${family()}`;
    return ctx.measureText(name).width <= height - BELOW;
  }
  fits.ctx = document.createElement("canvas").getContext("2d");

  function axis(spec, vertical, label) {
    const font = `12px ${family()}`;
    const made = {
      label, labelFont: `13px ${family()}`, font, labelSize: NAME, labelGap: 2, gap: 4,
      stroke: colour("quiet"), grid: { stroke: colour("grid"), width: 1, filter: ruled(spec) },
      ticks: { stroke: colour("line"), width: 1, size: 5, filter: ruled(spec) },
      values: (u, splits) => splits.map((v) => (v == null || (spec.log && !leading(v)) ? "" : tidy(v, spec.log ? 3 : 6))),
    };
    made.size = vertical ? labelRoom : TICKS;
    if (!vertical) made.space = 72;
    return made;
  }

  const margined = (low, high, share) => share * (high - low || Math.abs(high) || 1);

  // The abscissa: all of it, or the part to show first; as it is where the reader has zoomed.
  function xRange(spec, stems) {
    return (u, low, high) => {
      const all = u.data[0];
      if (low == null) return [spec.from ?? 0, spec.to ?? 1];
      if (low !== all[0] || high !== all[all.length - 1]) return [low, high];
      const margin = stems && !spec.log ? margined(low, high, 0.04) : 0;
      return [spec.from ?? low - margin, spec.to ?? high + margin];
    };
  }

  // The ordinate: what is drawn, the level lines, shaded stretches, zero where stems begin, and a margin.
  function yRange(spec, levels, shades, stems) {
    return (u, low, high) => {
      if (low == null) [low, high] = spec.log ? [1, 10] : [0, 1];
      const edges = shades.filter((s) => s.upright).flatMap((s) => [{ at: s.from }, { at: s.to }]);
      for (const { at } of [...levels, ...edges]) if (!spec.log || at > 0) {
        low = Math.min(low, at);
        high = Math.max(high, at);
      }
      if (stems) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
      if (spec.log) [low, high] = uPlot.rangeLog(low, high, 10, false);
      else {
        const margin = margined(low, high, 0.08);
        [low, high] = [stems && low === 0 ? 0 : low - margin, stems && high === 0 ? 0 : high + margin];
      }
      return [spec.from ?? low, spec.to ?? high];
    };
  }

  // Shaded stretches, below the curves.
  function shade(chart) {
    return (u) => {
      const { ctx, bbox } = u;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      ctx.fillStyle = colour("quiet");
      for (const { from, to, upright } of chart.shades) {
        const spec = upright ? chart.y : chart.x;
        if (spec.log && !(from > 0 && to > 0)) continue;
        const [a, b] = [from, to].map((at) => u.valToPos(at, upright ? "y" : "x", true));
        ctx.globalAlpha = upright ? 0.2 : 0.12;
        if (upright) ctx.fillRect(bbox.left, Math.min(a, b), bbox.width, Math.abs(b - a));
        else ctx.fillRect(a, bbox.top, b - a, bbox.height);
      }
      ctx.restore();
    };
  }

  // Words on places of the abscissa stand above the curves.
  const ROW = 18;
  function rows(u, chart) {
    const { ctx } = fits, end = u.bbox.width / devicePixelRatio;
    const at = (place) => u.valToPos(place, "x"), inside = (place) => !(chart.x.log && !(place > 0)) && at(place) >= 0 && at(place) <= end;
    const lines = [...chart.markers].sort((a, b) => b.at - a.at).filter((one) => inside(one.at));
    const stretches = chart.shades.filter(({ from, to, label, upright }) => label && !upright && (inside(from) || inside(to)));
    const words = [
      ...lines.map((one) => ({ label: one.label, at: at(one.at), line: true })),
      ...stretches.map((one) => ({ label: one.label, at: Math.max(0, at(one.from)), line: false })),
    ];
    ctx.font = `12px ${family()}`;
    return inRows(words, end, (label) => ctx.measureText(label).width);
  }
  // The room above the curves. The first time that it is asked for, there are no scales yet.
  const above = (chart) => (u, side, axes, cycle) =>
    8 + (cycle ? ROW * rows(u, chart).reduce((most, one) => Math.max(most, one.row + 1), 0) : 0);

  // Dashed lines at given places of the abscissa, with their words; chain lines at given levels; edges of what is shaded across.
  function annotate(chart) {
    return (u) => {
      const { ctx, bbox } = u, px = devicePixelRatio, bottom = bbox.top + bbox.height;
      ctx.save();
      ctx.font = `${12 * px}px ${family()}`;
      ctx.textAlign = "left";
      ctx.textBaseline = "middle";
      ctx.lineWidth = 1.25 * px;
      ctx.strokeStyle = ctx.fillStyle = colour("quiet");
      const line = (x0, y0, x1, y1) => { ctx.beginPath(); ctx.moveTo(x0, y0); ctx.lineTo(x1, y1); ctx.stroke(); };
      const across = (at) => {
        if (chart.y.log && !(at > 0)) return;
        const y = u.valToPos(at, "y", true);
        if (y >= bbox.top && y <= bottom) line(bbox.left, y, bbox.left + bbox.width, y);
      };
      ctx.setLineDash([5 * px, 4 * px]);
      for (const { label, at, left, line: ruled, row } of rows(u, chart)) {
        const x = bbox.left + at * px, middle = bbox.top - (row + 0.5) * ROW * px;
        if (ruled) line(x, middle - 6 * px, x, bottom);
        ctx.fillText(label, bbox.left + left * px, middle);
      }
      ctx.setLineDash([9, 3, 2, 3].map((part) => part * px));
      for (const { at } of chart.levels) across(at);
      ctx.setLineDash([]);
      ctx.lineWidth = px;
      for (const { from, to, upright } of chart.shades) if (upright) [from, to].forEach(across);
      ctx.restore();
    };
  }

  // What a level or a stretch of the ordinate is, below the legend of the curves.
  function keys(chart, host) {
    const list = document.createElement("div");
    list.className = "keys";
    const add = (kind, words) => {
      const [one, sign] = [document.createElement("span"), document.createElement("span")];
      sign.className = kind;
      one.append(sign, words);
      list.append(one);
    };
    const unit = chart.y.unit && "\u202f" + chart.y.unit;
    for (const { at, label } of chart.levels) add("level", `${label}: ${tidy(at, 5)}${unit}`);
    for (const { label, upright } of chart.shades) if (upright && label) add("stretch", label);
    if (list.childElementCount) host.append(list);
  }

  // An impulse: a line from zero with a dot, series side by side where they share a time.
  function stems(chart) {
    return (u) => {
      const { ctx, bbox } = u, px = devicePixelRatio, zero = u.valToPos(0, "y", true);
      const shown = chart.series.map((s, k) => [s, k]).filter(([, k]) => u.series[k + 1].show);
      ctx.save();
      ctx.strokeStyle = colour("quiet");
      ctx.lineWidth = px;
      ctx.beginPath();
      ctx.moveTo(bbox.left, zero);
      ctx.lineTo(bbox.left + bbox.width, zero);
      ctx.stroke();
      ctx.font = `${12 * px}px ${family()}`;
      ctx.textAlign = "center";
      const numbered = chart.series.length === 1 && chart.series[0].x.length <= 12, dots = [];
      shown.forEach(([s, k], place) => {
        const shift = (place - (shown.length - 1) / 2) * 8 * px;
        ctx.strokeStyle = ctx.fillStyle = stroke(s);
        ctx.globalAlpha = u.series[k + 1].alpha;
        ctx.lineWidth = 2.5 * px;
        s.x.forEach((at, i) => {
          const x = u.valToPos(at, "x", true) + shift, y = u.valToPos(s.y[i], "y", true);
          if (s.y[i] == null || x < bbox.left || x > bbox.left + bbox.width) return;
          ctx.beginPath();
          ctx.moveTo(x, zero);
          ctx.lineTo(x, y);
          ctx.stroke();
          ctx.beginPath();
          ctx.arc(x, y, 4.5 * px, 0, 2 * Math.PI);
          ctx.fill();
          const words = tidy(s.y[i], 3);
          dots.push({ x, y, words, value: s.y[i], half: ctx.measureText(words).width / 2 });
        });
      });
      ctx.textBaseline = "middle";
      const edges = { left: bbox.left, right: ctx.canvas.width };
      if (numbered) for (const { words, at, led } of placed(dots, zero, edges, px)) {
        ctx.globalAlpha = 1;
        ctx.fillText(words, ...at);
        if (!led) continue;
        ctx.globalAlpha = 0.6;
        ctx.lineWidth = px;
        ctx.beginPath();
        ctx.moveTo(...led[0]);
        ctx.lineTo(...led[1]);
        ctx.stroke();
      }
      ctx.restore();
    };
  }

  const stroke = (s) => colour("c" + s.colour);

  function uplotSeries(chart) {
    const made = [{ label: chart.x.name, value: measured(chart.x) }], bands = [];
    const several = chart.series.filter((s) => !["band", "points"].includes(s.kind)).length > 1;
    for (const s of chart.series) {
      const one = {
        label: s.name, stroke: () => stroke(s), width: 1.75, value: measured(chart.y),
        dash: several ? DASHES[s.dash] : DASHES[0], points: { show: false },
      };
      if (s.kind === "broad") Object.assign(one, { width: 6, stroke: () => stroke(s) + "90" });
      if (s.kind === "points") Object.assign(one, { paths: () => null, points: { show: true, size: s.x.length > 400 ? 3 : 6, width: 0, fill: stroke(s) + "a0" } });
      if (chart.kind === "stems") one.paths = () => null;
      if (!["points", "band"].includes(s.kind) && chart.kind !== "stems") one.class = "line";
      if (s.kind === "band") {
        Object.assign(one, { width: 0, band: true });
        bands.push({ series: [made.length, made.length + 1], fill: stroke(s) + "33" });
        made.push(one, { ...one, class: "lower" });
      } else made.push(one);
    }
    return { made, bands };
  }

  function draw(chart, host) {
    const tables = chart.series.map((s) => (s.kind === "band" ? [s.x, s.y, s.low] : [s.x, s.y]));
    const data = uPlot.join(tables);
    const { made, bands } = uplotSeries(chart);
    const reads = (u) => u.root.classList.toggle("read", u.cursor.idx != null && !root.dataset.paper);
    const hooks = { drawClear: [shade(chart)], draw: [annotate(chart)], setCursor: [reads] };
    if (chart.kind === "stems") hooks.draw.unshift(stems(chart));
    const width = root.dataset.paper ? 680 : host.clientWidth;
    const height = Math.round(Math.max(230, Math.min(360, width * 0.45)));
    const upright = withUnit(chart.y), beside = fits(upright, height);
    host.replaceChildren();
    if (!beside) {
      const words = document.createElement("p");
      words.className = "upright";
      words.textContent = upright;
      host.append(words);
    }
    const plot = new uPlot({
      width, height, padding: [above(chart), null, null, null],
      scales: {
        x: { time: false, distr: chart.x.log ? 3 : 1, range: xRange(chart.x, chart.kind === "stems") },
        y: { distr: chart.y.log ? 3 : 1, range: yRange(chart.y, chart.levels, chart.shades, chart.kind === "stems") },
      },
      axes: [axis(chart.x, false, withUnit(chart.x)), axis(chart.y, true, beside ? upright : null)],
      series: made, bands, hooks,
      cursor: { focus: { prox: 24 }, sync: shared(chart), drag: { setScale: true, x: true, y: false } },
      focus: { alpha: 0.35 },
      legend: { markers: markers(made) },
    }, data, host);
    keys(chart, host);
    return plot;
  }

  // Charts of one abscissa share the cursor; each keeps its own zoom.
  function shared(chart) {
    const pub = (type) => type === "mousemove" || type === "mouseleave";
    const key = chart.kind + " " + withUnit(chart.x);
    return { key, scales: ["x", null], setSeries: false, filters: { pub } };
  }

  // The legend shows a line as it is drawn, dashes too; what has no line shows its colour, a band its wash.
  function markers(made) {
    const line = (i) => made[i].class === "line";
    return {
      width: (u, i) => (line(i) ? made[i].width : 0),
      dash: (u, i) => BORDERS[DASHES.indexOf(made[i].dash)],
      stroke: (u, i) => made[i].stroke(),
      fill: (u, i) => (line(i) ? "transparent" : made[i].stroke() + (made[i].band ? "55" : "")),
    };
  }

  let plots = [];
  function drawAll() {
    plots.forEach((plot) => plot.destroy());
    plots = charts.map((chart, k) => draw(chart, document.getElementById("plot-" + k)));
  }
  drawAll();
  dark.addEventListener("change", drawAll);
  let width = root.clientWidth;
  addEventListener("resize", () => {
    if (root.clientWidth === width) return;
    width = root.clientWidth;
    drawAll();
  });
  addEventListener("beforeprint", () => { root.dataset.paper = "1"; drawAll(); });
  addEventListener("afterprint", () => { delete root.dataset.paper; drawAll(); });
})();
