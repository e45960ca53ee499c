// Curves round the hole: pressure, shear with its bounds, hoop stress. Stick and slip are shaded.

import { INK, REFERENCE, SOFT, ofStatus } from "live/colours";
import { partsOf, together } from "live/curves";
import { peak } from "live/drawing";
import { digits, scaled } from "live/units";
import { Follower, WHOLE } from "live/window";

const FONT = "11px system-ui, sans-serif";
const GRID = { stroke: "#e6e9ec", width: 1 };
const STEPS = [45, 30, 15, 10, 5, 2, 1, 0.5, 0.2, 0.1]; // between two ticks of an angle, degrees
const LEAST = 0.5; // degrees of the narrowest window

export function axis(more = {}) {
  return { stroke: SOFT, font: FONT, grid: GRID, ticks: { ...GRID, size: 4 }, ...more };
}

export function angleAxis(more = {}) {
  return axis({ splits: (_, __, low, high) => ticks(low, high), values: (_, splits) => splits.map(angleText), size: 24, ...more });
}

// Ticks of an angle between two ends: at least five of them.
export function ticks(low, high) {
  return multiples(low, high, STEPS.find((one) => (high - low) / one >= 5) ?? STEPS.at(-1));
}

// The multiples of a step between two ends.
export function multiples(low, high, step) {
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
  return found;
}

// An angle at most half a turn from the bottom.
function angleText(angle) {
  const turned = angle > 180 ? angle - 360 : angle < -180 ? angle + 360 : angle;
  return `${brief(turned)}°`;
}

export function valueAxis(more = {}) {
  return axis({ size: 48, values: (_, splits) => splits.map(brief), ...more });
}

// A number of an axis: no more digits than it needs.
export function brief(value) {
  const short = Number(value.toPrecision(6)), small = short !== 0 && Math.abs(short) < 1e-3;
  return (small ? short.toExponential() : String(short)).replaceAll("-", "−");
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
  hoop: [["reference", REFERENCE, 2], ["seat", SOFT, 2, [6, 4]], ["hoop", INK, 2]],
};
const DASHES = [[6, 4], [2, 3]]; // of the curves of bodies beside a line without

export class RoundCharts {
  constructor(history) {
    this.history = history;
    this.forget();
    this.ranges = {};
    this.follower = new Follower();
    this.choice = "contact"; // or "whole", or the ends of the part that was marked
    this.button = document.getElementById("zoom");
    this.button.addEventListener("click", () => this.zoom(this.isWhole ? "contact" : "whole"));
    this.charts = {};
    for (const name of Object.keys(CURVES)) this.charts[name] = this.make(name, CURVES[name]);
    this.ofLife = []; // charts of a life of wear: their names, units, curves, and the names of these
  }

  // Forget the ends of the axes.
  forget() {
    this.peaks = { pressure: 0, shear: 0, high: 0, low: 0 }; // in SI units; they change seldom, so that axes do not flicker
  }

  // Add the charts of a life of wear: the worn depths, downwards as a scar, and the damage.
  addLife() {
    const { cycles, damage } = this.history.life, owners = Object.keys(damage.values);
    const worn = ["pin", "hole"].filter((body) => cycles.some((cycle) => cycle.worn[body].some((depth) => depth > 0)));
    const bodies = worn.length > 1 ? [...worn, "both"] : worn;
    this.ofLife = [{ name: "worn", kind: "displacement", of: (cycle) => cycle.worn, names: bodies.length ? bodies : ["both"] }];
    if (owners.length) this.ofLife.push({ name: "damage", kind: "ratio", of: (cycle) => cycle.damage, names: owners });
    document.getElementById("worn-bodies").textContent = worn.length > 1 ? "of both bodies; dashed: pin, dotted: hole" : worn.length ? `of the ${worn[0]}` : "";
    document.getElementById("damage").hidden = !owners.length;
    document.getElementById("damage-words").textContent = damage.words.join("; ") + (owners.length > 1 ? `; dashed: ${owners[0]}` : "");
    for (const { name, names } of this.ofLife) {
      const series = names.map((label, k) => [label, INK, k < names.length - 1 ? 1.5 : 2, k < names.length - 1 ? DASHES[k] : undefined]);
      this.peaks[name] = 0;
      this.charts[name] = this.make(name, [["reference", REFERENCE, 2], ...series], name === "worn" ? -1 : 1);
    }
  }

  make(name, series, upwards = 1) {
    return chart(document.getElementById(`${name}-chart`), {
      scales: { x: { time: false, range: () => this.window }, y: { dir: upwards, range: () => this.ranges[name] ?? [0, 1] } },
      axes: [angleAxis(), valueAxis()],
      cursor: { sync: { key: "round" }, drag: { x: true, y: false, setScale: false }, bind: { dblclick: () => () => this.zoom("whole") }, points: { show: false } },
      series: [{}, ...series.map(([label, stroke, width, dash]) => ({ label, stroke, width, dash, pxAlign: 0, points: { show: false } }))],
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

  // Show the contact if it is narrow, the whole hole, or a part between two angles.
  zoom(choice) {
    this.choice = choice;
    this.onZoom();
  }

  get window() {
    return this.windowOf(this.follower);
  }

  // The window of a chart whose own contacts are followed.
  windowOf(follower) {
    return this.choice === "contact" ? follower.window : this.choice === "whole" ? WHOLE : this.choice;
  }

  get isWhole() {
    return this.window === WHOLE;
  }

  showButton() {
    this.button.textContent = this.isWhole ? "Zoom to contact" : "Whole hole";
    this.button.hidden = this.isWhole && this.follower.window === WHOLE;
  }

  shade(plot, faint) {
    const picture = this.history.shown;
    if (!picture) return;
    const { left, top, width, height } = plot.bbox;
    plot.ctx.save();
    plot.ctx.beginPath();
    plot.ctx.rect(left, top, width, height);
    plot.ctx.clip();
    plot.ctx.globalAlpha = faint ? 0.15 : 0.25;
    for (const [start, stop, sign] of picture.zones) {
      plot.ctx.fillStyle = ofStatus(sign);
      for (const turn of [-360, 0, 360]) {
        const from = plot.valToPos(start + turn, "x", true), to = plot.valToPos(stop + turn, "x", true);
        if (to > left && from < left + width) plot.ctx.fillRect(from, top, to - from, height);
      }
    }
    plot.ctx.restore();
  }

  show() {
    const { shown, reference, profiles, case: given } = this.history;
    const unit = given.units.traction;
    const both = [shown, reference].filter(Boolean);
    const largest = (of) => Math.max(0, ...both.map(of));
    this.peaks.pressure = peak(this.peaks.pressure, largest((one) => one.peak_pressure));
    this.peaks.shear = peak(this.peaks.shear, largest((one) => Math.max(Math.abs(one.peak_shear), profiles.mostShear(one))));
    this.follower.follow(both.flatMap((one) => one.contact));
    this.showButton();
    const scale = scaled(this.peaks.pressure, unit);
    this.fill(scale.factor);
    this.fillHoop(both, unit);
    for (const name of ["pressure", "shear"]) this.label(name, scale.unit);
    for (const one of this.ofLife) this.fillLife(one, given.units);
  }

  // The curves of the cycle that is shown. The last one stands beside that of the reference.
  fillLife({ name, kind, of, names }, units) {
    const cycles = [this.history.shown, this.history.reference].map((one) => one?.cycle), last = names.at(-1);
    const largest = Math.max(0, ...cycles.filter(Boolean).flatMap((cycle) => names.map((body) => Math.max(...of(cycle)[body]))));
    this.peaks[name] = peak(this.peaks[name], largest);
    const { factor, unit } = scaled(this.peaks[name], units[kind]);
    const { x, values } = together(cycles.map((cycle) => (cycle ? partsOf(of(cycle)) : [])), this.window);
    const scaledValues = (number, body) => values(number, body).map((value) => (value === null ? null : factor * value));
    this.ranges[name] = [0, factor * this.peaks[name] || 1];
    this.put(name, x, [scaledValues(1, last), ...names.map((body) => scaledValues(0, body))]);
    this.label(name, unit);
  }

  label(name, unit) {
    document.getElementById(`${name}-unit`).textContent = unit ? `[${unit}]` : "";
  }

  // The curves of pressure and shear. They end at the edges of the contact.
  fill(factor) {
    const { shown, reference, profiles } = this.history;
    const { x, values } = together([shown, reference].map((one) => (one ? partsOf(one.curves) : [])), this.window);
    const along = (number, name) => values(number, name).map((value) => (value === null ? null : factor * value));
    const pressure = along(0, "pressure"), bound = (sign) => pressure.map((value, k) => (value === null ? null : sign * profiles.friction(x[k], shown.load) * value));
    for (const name of ["pressure", "shear"]) {
      const top = factor * this.peaks[name] || 1, bounds = name === "shear" ? [bound(1), bound(-1)] : [];
      this.ranges[name] = [name === "shear" ? -top : 0, top];
      this.put(name, x, [along(1, name), ...bounds, along(0, name)]);
    }
  }

  put(name, x, values) {
    const ends = x.length > 1 ? [x, ...values] : [WHOLE, ...values.map(() => [null, null])];
    this.charts[name].setData(ends);
  }

  fillHoop(both, unit) {
    const { shown, reference } = this.history;
    const known = both.filter((one) => one.hoop);
    const element = document.getElementById("hoop-chart").parentElement;
    element.style.display = known.length ? "" : "none";
    if (!known.length) return;
    const ends = known.flatMap(({ hoop }) => [hoop.stress, hoop.seat ?? []]), high = Math.max(0, ...ends.map((one) => Math.max(...one)));
    const low = Math.min(0, ...ends.map((one) => Math.min(...one)));
    this.peaks.high = peak(this.peaks.high, high);
    this.peaks.low = peak(this.peaks.low, -low);
    const scale = scaled(Math.max(this.peaks.high, this.peaks.low), unit);
    const most = scale.factor * Math.max(this.peaks.high, this.peaks.low) || 1;
    // The axis shows zero, and a little beyond it.
    this.ranges.hoop = [-Math.max(scale.factor * this.peaks.low, 0.05 * most), Math.max(scale.factor * this.peaks.high, 0.05 * most)];
    const { x, values } = together([shown, reference].map((one) => (one?.hoop ? partsOf(one.hoop) : [])), this.window);
    const along = (number, name) => values(number, name).map((value) => (value === null ? null : scale.factor * value));
    this.put("hoop", x, [along(1, "stress"), shown?.hoop?.seat ? along(0, "seat") : x.map(() => null), along(0, "stress")]);
    this.label("hoop", scale.unit);
  }

  // The value under the mouse stands behind the unit.
  read(plot, name) {
    const { left } = plot.cursor, place = document.getElementById(`${name}-unit`);
    const unit = place.textContent.split("  ")[0], values = plot.data.at(-1), x = plot.data[0];
    const angle = left >= 0 ? plot.posToVal(left, "x") : NaN, next = x.findIndex((one) => one >= angle);
    const ends = [values[next - 1] ?? null, values[next] ?? null], share = (angle - x[next - 1]) / (x[next] - x[next - 1] || 1);
    const value = ends.includes(null) ? null : ends[0] + share * (ends[1] - ends[0]);
    place.textContent = value === null ? unit : `${unit}  ${digits(value)} at ${angleText(Number(angle.toPrecision(3)))}`;
  }
}
