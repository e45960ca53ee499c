// Curves round the hole: pressure, shear with its bounds, hoop stress. Stick and slip are shaded.

import { INK, REFERENCE, SOFT, ofStatus } from "live/colours";
import { peak } from "live/drawing";
import { digits, scaled } from "live/units";

const FONT = "11px system-ui, sans-serif";
const GRID = { stroke: "#e6e9ec", width: 1 };
const WHOLE = [-180, 180]; // the whole hole, degrees from the bottom
const STEPS = [45, 30, 15, 10, 5, 2, 1]; // between two ticks of an angle, degrees
const LEAST = 3; // degrees of the narrowest window

export function axis(more = {}) {
  return { stroke: SOFT, font: FONT, grid: GRID, ticks: { ...GRID, size: 4 }, ...more };
}

export function angleAxis(more = {}) {
  return axis({ splits: (_, __, low, high) => ticks(low, high), values: (_, splits) => splits.map((angle) => `${angle}°`.replace("-", "−")), size: 24, ...more });
}

// Ticks of an angle between two ends: at least five of them.
function ticks(low, high) {
  const step = STEPS.find((one) => (high - low) / one >= 5) ?? 1, found = [];
  for (let angle = Math.ceil(low / step) * step; angle <= high; angle += step) found.push(angle);
  return found;
}

export function valueAxis(more = {}) {
  return axis({ size: 48, values: (_, splits) => splits.map(brief), ...more });
}

// A number of an axis: no more digits than it needs.
export function brief(value) {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

// A chart that fills its element, and follows the size of it.
export function chart(element, options, data) {
  const size = () => ({ width: Math.max(element.clientWidth, 80), height: Math.max(element.clientHeight, 80) });
  const made = new uPlot({ ...size(), legend: { show: false }, padding: [8, 16, 0, 0], ...options }, data, element);
  new ResizeObserver(() => made.setSize(size())).observe(element);
  return made;
}

const CURVES = {
  pressure: [["reference", REFERENCE, 2], ["pressure", INK, 2]],
  shear: [["reference", REFERENCE, 2], ["upper", SOFT, 1, [5, 3]], ["lower", SOFT, 1, [5, 3]], ["shear", INK, 2]],
  hoop: [["reference", REFERENCE, 2], ["hoop", INK, 2]],
};

export class RoundCharts {
  constructor(history) {
    this.history = history;
    this.peaks = { pressure: 0, shear: 0, high: 0, low: 0 }; // in SI units; they change seldom, so that axes do not flicker
    this.ranges = {};
    this.window = WHOLE;
    this.charts = {};
    for (const name of Object.keys(CURVES)) this.charts[name] = this.make(name);
  }

  make(name) {
    const series = CURVES[name];
    return chart(document.getElementById(`${name}-chart`), {
      scales: { x: { time: false, range: () => this.window }, y: { range: () => this.ranges[name] ?? [0, 1] } },
      axes: [angleAxis(), valueAxis()],
      cursor: { sync: { key: "round" }, drag: { x: true, y: false, setScale: false }, bind: { dblclick: () => () => this.zoom(WHOLE) }, points: { show: false } },
      series: [{}, ...series.map(([label, stroke, width, dash]) => ({ label, stroke, width, dash, points: { show: false } }))],
      hooks: { drawClear: [(plot) => this.shade(plot, name === "hoop")], setCursor: [(plot) => this.read(plot, name)], setSelect: [(plot) => this.select(plot)] },
    }, [[-180, 180], ...series.map(() => [null, null])]);
  }

  // A part of a chart that is marked with the mouse fills all charts. A double click shows the whole hole again.
  select(plot) {
    const { left, width } = plot.select;
    if (width < 5) return;
    const [low, high] = [left, left + width].map((place) => plot.posToVal(place, "x"));
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    if (high - low >= LEAST) this.zoom([low, high]);
  }

  zoom(window) {
    this.window = window;
    for (const one of Object.values(this.charts)) one.setScale("x", { min: window[0], max: window[1] });
  }

  shade(plot, faint) {
    const picture = this.history.shown;
    if (!picture) return;
    const { left, top, width, height } = plot.bbox;
    const zones = [...picture.stick.map((ends) => [...ends, 0]), ...picture.slip];
    plot.ctx.save();
    plot.ctx.beginPath();
    plot.ctx.rect(left, top, width, height);
    plot.ctx.clip();
    plot.ctx.globalAlpha = faint ? 0.15 : 0.25;
    for (const [start, stop, sign] of zones) {
      plot.ctx.fillStyle = ofStatus(sign);
      for (const turn of [-360, 0, 360]) {
        const from = plot.valToPos(start + turn, "x", true), to = plot.valToPos(stop + turn, "x", true);
        if (to > left && from < left + width) plot.ctx.fillRect(from, top, to - from, height);
      }
    }
    plot.ctx.restore();
  }

  show() {
    const { shown, reference, case: given } = this.history;
    const unit = given.units.traction, mu = given.friction;
    const both = [shown, reference].filter(Boolean);
    const largest = (of) => Math.max(0, ...both.map(of));
    this.peaks.pressure = peak(this.peaks.pressure, largest((one) => one.peak_pressure));
    this.peaks.shear = peak(this.peaks.shear, largest((one) => Math.max(Math.abs(one.peak_shear), mu * one.peak_pressure)));
    const scale = scaled(this.peaks.pressure, unit);
    this.fill("pressure", scale.factor, (one, k) => one.pressure[k], []);
    this.fill("shear", scale.factor, (one, k) => one.shear[k], [mu, -mu]);
    this.fillHoop(both, unit);
    for (const name of ["pressure", "shear"]) this.label(name, scale.unit);
  }

  label(name, unit) {
    document.getElementById(`${name}-unit`).textContent = unit ? `[${unit}]` : "";
  }

  // The curves at the nodes, in the order of the angle. A whole circle ends where it begins.
  fill(name, factor, value, bounds) {
    const { shown, reference } = this.history;
    const same = reference && shown && reference.nodes === shown.nodes;
    const base = shown ?? reference;
    const chart = this.charts[name];
    if (!base) {
      chart.setData([[-180, 180], ...CURVES[name].map(() => [null, null])]);
      return;
    }
    const { order, degrees, whole } = base.nodes;
    const x = order.map((k) => degrees[k]);
    if (whole) x.push(x[0] + 360);
    const along = (of) => {
      const found = order.map((k) => factor * of(k));
      if (whole) found.push(found[0]);
      return found;
    };
    const others = reference && !same ? resampled(reference, base, (k) => factor * value(reference, k), whole) : null;
    const before = !reference ? x.map(() => null) : same ? along((k) => value(reference, k)) : others;
    const limits = bounds.map((mu) => (shown ? along((k) => mu * shown.pressure[k]) : x.map(() => null)));
    const top = factor * this.peaks[name] || 1;
    this.ranges[name] = [name === "shear" ? -top : 0, top];
    chart.setData([x, before, ...limits, shown ? along((k) => value(shown, k)) : x.map(() => null)]);
  }

  fillHoop(both, unit) {
    const { shown, reference } = this.history;
    const known = both.filter((one) => one.hoop);
    const element = document.getElementById("hoop-chart").parentElement;
    element.style.display = known.length ? "" : "none";
    if (!known.length) return;
    const high = Math.max(0, ...known.map((one) => Math.max(...one.hoop.stress))), low = Math.min(0, ...known.map((one) => Math.min(...one.hoop.stress)));
    this.peaks.high = peak(this.peaks.high, high);
    this.peaks.low = peak(this.peaks.low, -low);
    const scale = scaled(Math.max(this.peaks.high, this.peaks.low), unit);
    const most = scale.factor * Math.max(this.peaks.high, this.peaks.low) || 1;
    // The axis shows zero, and a little beyond it.
    this.ranges.hoop = [-Math.max(scale.factor * this.peaks.low, 0.05 * most), Math.max(scale.factor * this.peaks.high, 0.05 * most)];
    const x = [...new Set(known.flatMap((one) => [...one.hoop.degrees]))].sort((a, b) => a - b);
    const along = (one) => (one?.hoop ? interpolated(one.hoop, x, scale.factor) : x.map(() => null));
    this.charts.hoop.setData([x, along(reference), along(shown)]);
    this.label("hoop", scale.unit);
  }

  // The values under the mouse stand behind the unit.
  read(plot, name) {
    const { idx } = plot.cursor;
    const place = document.getElementById(`${name}-unit`);
    const unit = place.textContent.split("  ")[0];
    const value = idx === null || idx === undefined ? null : plot.data.at(-1)[idx];
    place.textContent = value === null || value === undefined ? unit : `${unit}  ${digits(value)} at ${digits(plot.data[0][idx], 3)}°`;
  }
}

// The hoop stress at the angles `x`, which have those of the curve among them; both ascend.
function interpolated({ degrees, stress }, x, factor) {
  let k = 0;
  return x.map((angle) => {
    while (k < degrees.length - 2 && degrees[k + 1] <= angle) k++;
    const part = (angle - degrees[k]) / (degrees[k + 1] - degrees[k]);
    return factor * (stress[k] + part * (stress[k + 1] - stress[k]));
  });
}

// The values of a picture with other nodes, at the nodes of `base`: those of the nearest node.
function resampled(picture, base, value, whole) {
  const { degrees } = picture.nodes;
  const found = base.nodes.order.map((k) => {
    let best = 0;
    degrees.forEach((angle, j) => { if (away(angle, base.nodes.degrees[k]) < away(degrees[best], base.nodes.degrees[k])) best = j; });
    return value(best);
  });
  if (whole) found.push(found[0]);
  return found;
}

function away(one, other) {
  return Math.abs(((one - other + 540) % 360) - 180);
}
