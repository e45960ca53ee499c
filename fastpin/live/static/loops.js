// Hysteresis loops: a load against the displacement on which it does work, over the steps of the history.

import { axis, brief, chart, valueAxis } from "live/charts";
import { INK, REFERENCE, WARNING } from "live/colours";
import { scaled } from "live/units";

const KINDS = { P: "force", Q: "force", M: "moment" };
const MOVES = { P: "displacement", Q: "displacement", M: "rotation" };
const PLAIN = { name: "", factor: 1 };
const LEAST = 1e-4; // least width of the axis, in parts of a usual displacement: below is rounding

export class LoopChart {
  constructor(history) {
    this.history = history;
    this.select = document.getElementById("loop-load");
    this.unit = document.getElementById("loop-unit");
    this.limits = { x: [-1, 1], y: [-1, 1] };
    const line = (plot, number) => this.line(plot, number);
    const values = (_, splits) => splits.map(brief);
    this.chart = chart(document.getElementById("loop-chart"), {
      mode: 2,
      scales: { x: { time: false, range: () => this.limits.x }, y: { range: () => this.limits.y } },
      axes: [axis({ size: 24, space: 55, values }), valueAxis({ size: 44 })],
      cursor: { show: false },
      series: [null, { paths: line, stroke: INK }, { paths: line, stroke: WARNING }, { paths: line, stroke: REFERENCE }],
    }, [null, [[], []], [[], []], [[], []]]);
    this.bent = document.getElementById("loop-bent");
    this.isChosen = false; // whether the user has chosen the load
    this.select.addEventListener("change", () => { this.isChosen = true; });
    for (const choice of [this.select, this.bent]) choice.addEventListener("change", () => this.show());
  }

  line(plot, number) {
    const [x, y] = plot.data[number], pen = plot.ctx, ratio = window.devicePixelRatio || 1;
    pen.save();
    pen.beginPath();
    pen.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
    pen.clip();
    pen.beginPath();
    for (let k = 0; k < x.length; k++) pen.lineTo(plot.valToPos(x[k], "x", true), plot.valToPos(y[k], "y", true));
    pen.lineWidth = 1.5 * ratio;
    pen.strokeStyle = [null, INK, WARNING, REFERENCE][number];
    if (x.length === 1) {
      pen.beginPath();
      pen.arc(plot.valToPos(x[0], "x", true), plot.valToPos(y[0], "y", true), 4 * ratio, 0, 2 * Math.PI);
      pen.fillStyle = pen.strokeStyle;
      pen.fill();
    } else pen.stroke();
    pen.restore();
    return null;
  }

  // List the loads. Until the user chooses one, the chart shows the load that moves.
  names(picture) {
    const names = Object.keys(picture.loops), chosen = this.select.value;
    const listed = Array.from(this.select.options, (option) => option.value);
    if (names.join() !== listed.join()) this.select.replaceChildren(...names.map((name) => new Option(name, name)));
    const isKept = this.isChosen && names.includes(chosen);
    this.select.value = isKept ? chosen : this.moving(names, chosen);
  }

  // The load that moved most in the latest gesture, in parts of the size of its kind. The present one stays if it moved half
  // as far: a load that turns round the pin does not change the chart.
  moving(names, present) {
    const { pictures, place } = this.history, { gesture, rounding } = pictures[place], before = {}, moved = {};
    let first = place;
    while (first > 0 && pictures[first - 1].gesture === gesture) first -= 1;
    for (let k = Math.max(first - 1, 0); k <= place; k++) {
      for (const name of names) {
        const value = pictures[k].loops[name]?.[0] ?? 0, size = rounding[KINDS[name] ?? "traction"] || 1;
        moved[name] = (moved[name] ?? 0) + Math.abs(value - (before[name] ?? (first ? value : 0))) / size;
        before[name] = value;
      }
    }
    const most = names.reduce((best, name) => (moved[name] > moved[best] ? name : best), names[0]);
    return moved[present] >= 0.5 * moved[most] && (moved[most] > 0 || present) ? present : most;
  }

  // The least width of the axis of displacements or rotations, in SI units.
  least(name, { yielded, radius, dimensionless }) {
    if (!KINDS[name]) return 0;
    return LEAST * (name === "M" && !dimensionless ? yielded / radius : yielded);
  }

  show() {
    const { pictures, place, shown, reference, case: given } = this.history;
    if (!shown) {
      this.chart.setData([null, [[], []], [[], []], [[], []]]);
      this.unit.textContent = "";
      return;
    }
    this.names(shown);
    const name = this.select.value;
    const points = pictures.slice(0, place + 1).map((picture) => picture.loops[name]).filter(Boolean);
    const load = points.map((pair) => pair[0]), slope = this.bent.checked ? slopeOf(points) : 0;
    const bent = (pair) => pair[1] - slope * pair[0]; // subtracting a multiple of the load leaves the area
    const way = points.map(bent);
    const most = (values) => values.reduce((found, value) => Math.max(found, Math.abs(value)), 0);
    const unit = { load: given.units[KINDS[name] ?? "traction"], way: KINDS[name] ? (name === "M" ? given.units.rotation : given.units.displacement) : PLAIN };
    const least = this.least(name, given);
    const x = scaled(Math.max(most(way), least), unit.way), y = scaled(most(load), unit.load);
    const scale = (values, by) => values.map((value) => value * by.factor);
    const data = [scale(way, x), scale(load, y)], before = reference?.loops[name];
    const mark = before ? [[bent(before) * x.factor], [before[0] * y.factor]] : [[], []];
    this.limits = { x: around([...data[0], ...mark[0]], least * x.factor), y: around([...data[1], ...mark[1]]) };
    this.chart.setData([null, data, [data[0].slice(-1), data[1].slice(-1)], mark]);
    const other = KINDS[name] ? `${MOVES[name]} [${x.unit}]` : "its displacement";
    this.unit.textContent = `[${y.unit}] over ${other}`;
  }
}

// The slope of the straight line through loads and displacements that fits best.
function slopeOf(points) {
  const mean = (k) => points.reduce((sum, pair) => sum + pair[k], 0) / points.length;
  const [load, way] = [mean(0), mean(1)];
  const both = points.reduce((sum, pair) => sum + (pair[0] - load) * (pair[1] - way), 0);
  return both / points.reduce((sum, pair) => sum + (pair[0] - load) ** 2, 0) || 0;
}

// The ends of an axis: around the values and 0, and not narrower than `least`.
function around(values, least = 0) {
  const low = values.reduce((a, b) => Math.min(a, b), 0), high = values.reduce((a, b) => Math.max(a, b), 0);
  const room = 0.07 * Math.max(high - low, least) || 1;
  return [low - room, high + room];
}
