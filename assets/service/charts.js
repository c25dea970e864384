// The live charts: what each joint did in the last seconds, and the impulses in force.

import { DEG } from "./dom.js";

const WINDOW = 12; // s that are shown
const VAGUE = 0.1; // an estimate whose standard deviation is a larger share of it is none to show

/** The last seconds of one joint, a column a quantity; what is not known is null. */
export class Trace {
  /** Whether its deformation is a length, an angle, or (null) not measured yet. */
  unit = null;

  constructor() {
    this.clear();
  }

  clear() {
    this.rows = { t: [], planned: [], command: [], motor: [], angle: [], tip: [], low: [], high: [], frequency: [] };
  }

  push(frame) {
    const { t } = this.rows;
    // The service has begun anew: its clock counts from zero.
    if (t.length && frame.time_s < t[t.length - 1]) this.clear();
    // A length is told where the tip's arc is known, and an angle elsewhere.
    if (frame.deformation_rad !== null) this.unit = frame.tip_deformation_m === null ? "mrad" : "mm";
    const { frequency_hz: frequency, frequency_std_hz: std } = frame;
    const known = frequency !== null && std !== null && std < VAGUE * frequency;
    const row = {
      t: frame.time_s,
      planned: frame.planned_rad * DEG,
      command: frame.command_rad * DEG,
      motor: frame.motor_rad === null ? null : frame.motor_rad * DEG,
      angle: frame.deformation_rad === null ? null : frame.deformation_rad * 1e3,
      tip: frame.tip_deformation_m === null ? null : frame.tip_deformation_m * 1e3,
      frequency: known ? frequency : null,
      low: known ? frequency - 2 * std : null,
      high: known ? frequency + 2 * std : null,
    };
    for (const [name, column] of Object.entries(this.rows)) column.push(row[name]);
    const old = this.rows.t.findIndex((time) => time >= frame.time_s - WINDOW);
    if (old > 100) for (const column of Object.values(this.rows)) column.splice(0, old);
  }

  /** The deformation in its unit. */
  deformation() {
    return this.unit === "mm" ? this.rows.tip : this.rows.angle;
  }

  /** Seconds before the last one. */
  ago() {
    const { t } = this.rows;
    return t.map((time) => time - t[t.length - 1]);
  }
}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A chart over the last seconds that follows its box and the colour scheme. */
export class Live {
  constructor(box, series, { least = 0, bands = [], level = () => null, levelName = "" } = {}) {
    Object.assign(this, { box, series, least, bands, level, levelName, data: null });
    new ResizeObserver(() => this.plot && this.plot.setSize(this.size())).observe(box);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    this.build();
  }

  size() {
    return { width: this.box.clientWidth, height: this.box.clientHeight - 22 };
  }

  build() {
    if (this.plot) this.plot.destroy();
    this.box.replaceChildren();
    const axis = { stroke: colour("quiet"), grid: { stroke: colour("grid"), width: 1 }, ticks: { show: false }, font: "12px system-ui, sans-serif" };
    const series = this.series.map(({ name, colour: of, width = 2, alpha = 1 }) => {
      const stroke = of ? colour(of) : "transparent";
      return { label: name, stroke, width: of ? width : 0, alpha, points: { show: false }, spanGaps: true };
    });
    const bands = this.bands.map(([high, low, of]) => ({ series: [high, low], fill: `${colour(of)}40` }));
    this.plot = new uPlot({
      ...this.size(),
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: [-WINDOW, 0] }, y: { range: (_, low, high) => this.range(low, high) } },
      axes: [{ ...axis, size: 28, values: (_, splits) => splits.map((s) => `${s} s`) }, { ...axis, size: 52 }],
      series: [{}, ...series],
      bands,
      hooks: { draw: [(plot) => this.drawLevel(plot)] },
    }, this.data || [[], ...series.map(() => [])], this.box);
    this.box.append(this.legend());
  }

  legend() {
    const legend = document.createElement("div");
    legend.className = "legend";
    for (const { name, colour: of } of this.series.filter((one) => one.colour)) {
      const entry = document.createElement("span");
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = `var(--${of})`;
      entry.append(swatch, name);
      legend.append(entry);
    }
    if (this.levelName) {
      const entry = document.createElement("span");
      const dash = document.createElement("span");
      dash.className = "dash";
      entry.append(dash, this.levelName);
      legend.append(entry);
    }
    return legend;
  }

  /** The values with a margin, and not less than `least` of them, so that noise stays small. */
  range(low, high) {
    if (low === null || high === null) return [-1, 1];
    const level = this.level();
    if (level !== null) [low, high] = [Math.min(low, level), Math.max(high, level)];
    const half = Math.max((high - low) / 2, this.least / 2) * 1.08;
    return [(low + high) / 2 - half, (low + high) / 2 + half];
  }

  drawLevel(plot) {
    const level = this.level();
    if (level === null) return;
    const y = plot.valToPos(level, "y", true);
    const { left, width } = plot.bbox;
    plot.ctx.save();
    plot.ctx.strokeStyle = colour("ink");
    plot.ctx.setLineDash([6, 6]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(left, y);
    plot.ctx.lineTo(left + width, y);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  draw(columns) {
    this.data = columns;
    this.plot.setData(columns);
  }
}

/** The impulses of a train. Each is split over neighbouring ticks, which belong together here. */
export function impulses({ times_s, amplitudes }, period) {
  const found = [];
  times_s.forEach((t, k) => {
    const last = found[found.length - 1];
    if (last && t - last.end < 1.5 * period) {
      last.moment += t * amplitudes[k];
      last.amplitude += amplitudes[k];
      last.end = t;
    } else {
      found.push({ moment: t * amplitudes[k], amplitude: amplitudes[k], end: t });
    }
  });
  return found.map(({ moment, amplitude }) => ({ time: moment / amplitude, amplitude }));
}

/** The impulses as stems in a drawing that scales with its box. */
export function drawTrain(box, train) {
  const [width, height, pad] = [400, 170, 34];
  const make = (kind, attributes, text = "") => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", kind);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.textContent = text;
    return element;
  };
  const last = Math.max(...train.map((one) => one.time), 1e-3);
  const most = Math.max(...train.map((one) => Math.abs(one.amplitude)), 1e-9);
  const floor = train.some((one) => one.amplitude < 0) ? height / 2 : height - pad;
  const x = (t) => pad + (t / last) * (width - 2 * pad);
  const y = (a) => floor - (a / most) * (floor - 20);
  const words = train.map(({ time, amplitude }) => `${amplitude.toFixed(3)} at ${(1e3 * time).toFixed(1)} ms`);
  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Impulses: ${words.join(", ")}` });
  svg.append(make("line", { class: "base", x1: 0, x2: width, y1: floor, y2: floor }));
  train.forEach(({ time: t, amplitude: a }) => {
    svg.append(
      make("line", { x1: x(t), x2: x(t), y1: floor, y2: y(a) }),
      make("circle", { cx: x(t), cy: y(a), r: 4 }),
      make("text", { x: x(t), y: y(a) - 8 }, a.toFixed(2)),
      make("text", { x: x(t), y: height - 12 }, `${(1e3 * t).toFixed(0)} ms`),
    );
  });
  box.replaceChildren(svg);
}
