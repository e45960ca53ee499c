// A joint of several pins: the map of all holes, the shares of the pins as bars and over a load, and the chooser of a hole.

import { floats } from "live/arrays";
import { axis, brief, chart, valueAxis } from "live/charts";
import { INK, SOFT, ofStatus } from "live/colours";
import { arrow } from "live/drawing";
import { zonesOf } from "live/history";
import { digits, scaled, withUnit } from "live/units";

const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#1d2730"]; // of the pins
const RING = 1.45; // outer radius of the ring with the hoop stress, in hole radii
const HIGH = 440; // pixels of the map, at most
const TITLE = 20; // pixels above each plate
const ROW = 22; // pixels of a bar
const STEP = "step";

export class JointView {
  constructor(history, look) {
    Object.assign(this, { history, look });
    this.chooser = document.getElementById("hole");
    this.load = document.getElementById("share-load");
    this.map = document.getElementById("joint-map");
    this.bars = document.getElementById("share-bars");
    this.places = []; // of the holes on the map: number, x, y and radius, pixels
    this.limits = { x: [0, 1], y: [0, 100] };
    this.lines = [];
    this.isChosen = false; // whether the user has chosen the load
    this.chooser.addEventListener("change", () => look(Number(this.chooser.value)));
    this.load.addEventListener("change", () => { this.isChosen = true; this.showLines(); });
    this.map.addEventListener("click", (event) => this.click(event));
    this.chart = null;
  }

  // Begin with a joint.
  make() {
    const { holes, loads } = this.history.given;
    this.chooser.replaceChildren(...holes.map(({ pin, plate }, k) => new Option(`${pin} in ${plate}`, k)));
    this.load.replaceChildren(...[STEP, ...loads.map(({ name }) => name)].map((name) => new Option(name, name)));
    if (this.chart) return;
    this.chart = chart(document.getElementById("shares-chart"), {
      scales: { x: { time: false, range: () => this.limits.x }, y: { range: () => this.limits.y } },
      axes: [axis({ size: 24, space: 55, values: (_, splits) => splits.map((value) => (this.load.value === STEP && value % 1 ? "" : brief(value))) }), valueAxis({ size: 40 })],
      cursor: { show: false },
      series: [{}, { show: false }],
      hooks: { draw: [(plot) => this.draw(plot)] },
    }, [[0, 1], [null, null]]);
    new ResizeObserver(() => this.show()).observe(this.map.parentElement);
  }

  // Names of the pins in a whole plate, in the order of the joint.
  pins(whole) {
    return [...new Set(this.history.given.holes.filter((hole) => hole.whole === whole).map(({ pin }) => pin))];
  }

  colour(pin) {
    const names = [...new Set(this.history.given.holes.map((hole) => hole.pin))];
    return COLOURS[names.indexOf(pin) % COLOURS.length];
  }

  show() {
    if (!this.history.given?.holes) return;
    this.chooser.value = this.history.hole;
    this.showMap();
    this.showBars();
    this.showLines();
  }

  // Where plates and holes are drawn, and the pixels of a metre. Of a plate with slices one is drawn.
  layout(width) {
    const { given, hole } = this.history, chosen = given.holes[hole];
    const plates = given.plates.map(({ name, outline, holes: free }) => {
      const slice = chosen.whole === name ? chosen.plate : given.holes.find(({ whole }) => whole === name).plate;
      const holes = given.holes.map((one, number) => ({ ...one, number })).filter(({ plate }) => plate === slice);
      const points = outline ?? holes.flatMap(({ at: [x, y], edge }) => [[x - 4 * edge, y - 3 * edge], [x + 4 * edge, y + 3 * edge]]);
      return { name: slice, outline, free, holes, low: Math.min(...points.map(([, y]) => y)), high: Math.max(...points.map(([, y]) => y)), points };
    });
    const xs = plates.flatMap(({ points }) => points.map(([x]) => x)), [left, right] = [Math.min(...xs), Math.max(...xs)];
    const tall = plates.reduce((sum, { low, high }) => sum + high - low, 0);
    const scale = Math.min((width - 24) / (right - left), (HIGH - TITLE * plates.length) / tall);
    let top = 0;
    for (const plate of plates) {
      plate.top = top + TITLE;
      top = plate.top + (plate.high - plate.low) * scale + 6;
    }
    return { plates, scale, height: top + 4, x0: (width - (right - left) * scale) / 2 - left * scale };
  }

  showMap() {
    const width = this.map.parentElement.clientWidth, { plates, scale, height, x0 } = this.layout(width);
    const pen = fitted(this.map, width, height), { shown, given } = this.history;
    const stresses = shown?.joint.holes.map(({ hoop }) => hoop && floats(hoop.stress)) ?? [];
    const most = stresses.reduce((found, one) => (one ?? []).reduce((a, b) => Math.max(a, Math.abs(b)), found), 0);
    const longest = shown ? Math.max(...shown.joint.forces.map(([x, y]) => Math.hypot(x, y))) : 0;
    this.places = [];
    for (const plate of plates) {
      const at = ([x, y]) => [x0 + x * scale, plate.top + (plate.high - y) * scale];
      pen.fillStyle = INK;
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "left";
      pen.fillText(plate.name, 8, plate.top - 7);
      if (plate.outline) {
        pen.beginPath();
        for (const point of plate.outline) pen.lineTo(...at(point));
        pen.closePath();
        pen.fillStyle = "#eceae6";
        pen.fill();
        pen.strokeStyle = "#8d8a83";
        pen.lineWidth = 1;
        pen.stroke();
      }
      for (const [x, y, radius] of plate.free) disk(pen, at([x, y]), radius * scale, "#ffffff", "#8d8a83");
      for (const hole of plate.holes) this.drawHole(pen, at(hole.at), hole, scale, shown, most, longest);
    }
    document.getElementById("joint-words").textContent = shown ? words(shown.joint, given, most, longest) : "no load";
  }

  // One hole: the ring of the hoop stress, the pin, stick and slip, and the force of the pin on the plate.
  drawHole(pen, [x, y], { number, pin, edge }, scale, shown, most, longest) {
    const radius = Math.max(edge * scale, 5), ring = Math.max(RING * radius, radius + 4);
    this.places.push({ number, x, y, radius: Math.max(ring, 10) });
    disk(pen, [x, y], radius, "#c3ced8", "#7a8894");
    if (shown) {
      const { hoop, seat, ...picture } = shown.joint.holes[number], { friction } = this.history.given.holes[number];
      if (hoop) {
        const degrees = floats(hoop.degrees), stress = floats(hoop.stress);
        for (let k = 1; k < degrees.length; k++) {
          pen.beginPath();
          pen.arc(x, y, ring, turned(degrees[k - 1]), turned(degrees[k]) - 0.01, true);
          pen.arc(x, y, radius, turned(degrees[k]) - 0.01, turned(degrees[k - 1]));
          pen.fillStyle = shade((0.5 * (stress[k - 1] + stress[k])) / (most || 1));
          pen.fill();
        }
      }
      pen.lineWidth = Math.max(3, 0.14 * radius);
      for (const [start, stop, status] of zonesOf(picture, friction === 0)) {
        pen.beginPath();
        pen.arc(x, y, radius - 0.5 * pen.lineWidth, turned(start), turned(stop), true);
        pen.strokeStyle = ofStatus(status);
        pen.stroke();
      }
      const [right, up] = shown.joint.forces[number].map((one) => (0.75 * radius * one) / (longest || 1));
      pen.lineWidth = 1.5;
      if (Math.hypot(right, up) > 3) arrow(pen, x, y, x + right, y - up, INK, 6);
    }
    if (number === this.history.hole) {
      pen.beginPath();
      pen.arc(x, y, ring + 3, 0, 2 * Math.PI);
      pen.strokeStyle = INK;
      pen.lineWidth = 2;
      pen.stroke();
    }
    pen.fillStyle = INK;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(pin, x, y - ring - 6);
  }

  // A click on the map shows the nearest hole.
  click({ offsetX, offsetY }) {
    const far = ({ x, y, radius }) => Math.hypot(x - offsetX, y - offsetY) / radius;
    const near = this.places.reduce((best, one) => (far(one) < far(best) ? one : best), this.places[0]);
    if (near && far(near) < 1.5) this.look(near.number);
  }

  // The share and the force of every pin on the plate of the chosen hole.
  showBars() {
    const { given, hole, shown } = this.history, { whole } = given.holes[hole], pins = this.pins(whole);
    document.getElementById("share-plate").textContent = whole;
    const box = this.bars.parentElement;
    box.style.height = `${Math.max(140, ROW * pins.length + 12)}px`;
    const width = box.clientWidth, pen = fitted(this.bars, width, box.clientHeight), room = 66, zero = 0.12;
    const force = pins.map((pin) => given.holes.reduce(([x, y], one, k) => (one.pin === pin && one.whole === whole && shown ? [x + shown.joint.forces[k][0], y + shown.joint.forces[k][1]] : [x, y]), [0, 0]));
    const sizes = force.map(([x, y]) => Math.hypot(x, y)), most = Math.max(...sizes);
    const shares = pins.map((pin) => shown?.joint.shares[whole][pin] ?? null), largest = Math.max(...shares.map((one) => Math.abs(one ?? 0)), 1e-9);
    const isBalanced = shares.every((one) => one === null);
    const long = (width - room - 118) * (isBalanced || shares.every((one) => one >= 0) ? 1 : 1 - zero);
    pen.textBaseline = "middle";
    pins.forEach((pin, k) => {
      const y = 6 + (k + 0.5) * ROW, part = isBalanced ? sizes[k] / (most || 1) : shares[k] / largest, from = room + (width - room - 118 - long);
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "right";
      pen.fillStyle = INK;
      pen.fillText(pin, room - 8, y, room - 10);
      pen.fillStyle = this.colour(pin);
      pen.fillRect(Math.min(from, from + part * long), y - 7, Math.abs(part) * long, 14);
      pen.fillStyle = SOFT;
      pen.textAlign = "left";
      const share = shares[k] === null ? "" : `${digits(Math.abs(shares[k]) < 1e-9 ? 0 : 100 * shares[k], 3)} %, `;
      pen.fillText(`${share}${withUnit(sizes[k] > 1e-9 * most ? sizes[k] : 0, given.units.force, 3)}`, from + Math.max(part, 0) * long + 6, y);
    });
  }

  // The shares over the steps, or over the load that is chosen: until then the one that has moved most.
  showLines() {
    const { given, hole, pictures, place, shown } = this.history, { whole } = given.holes[hole];
    const list = pictures.slice(0, place + 1);
    if (!this.isChosen) this.load.value = this.moving(list);
    const name = this.load.value, control = given.loads.find((load) => load.name === name);
    const values = list.map(({ acting }, k) => (control ? acting[name] : k + 1));
    const most = values.reduce((found, value) => Math.max(found, Math.abs(value)), 0);
    const { factor, unit } = control ? scaled(most, control.unit) : { factor: 1, unit: "" };
    const x = values.map((value) => factor * value);
    this.lines = this.pins(whole).map((pin) => ({ pin, x, y: list.map(({ joint }) => joint.shares[whole][pin] === null ? null : 100 * joint.shares[whole][pin]) }));
    const known = this.lines.flatMap(({ y }) => y.filter((one) => one !== null)), extreme = (of, all, start) => all.reduce((a, b) => of(a, b), start);
    const [low, high] = [extreme(Math.min, known, 0), extreme(Math.max, known, 10)], [first, last] = [extreme(Math.min, x, control ? 0 : 1), extreme(Math.max, x, control ? 0 : 2)];
    const room = 0.05 * (last - first) || 1;
    this.limits = { x: [first - room, last + room], y: [low && 1.1 * low, 1.1 * high] };
    document.getElementById("share-unit").textContent = unit ? `[${unit}]` : "";
    this.chart.setData([this.limits.x, [null, null]]);
  }

  // The name of the load that has moved most, in parts of its size; the steps if none has moved.
  moving(list) {
    const moved = this.history.given.loads.map(({ name, size }) => {
      const values = list.map(({ acting }) => acting[name]);
      return values.reduce((sum, value, k) => sum + Math.abs(value - (k ? values[k - 1] : 0)), 0) / size;
    });
    const most = Math.max(...moved);
    return most > 0 && list.length > 1 ? this.history.given.loads[moved.indexOf(most)].name : STEP;
  }

  draw(plot) {
    const pen = plot.ctx, { left, top, width, height } = plot.bbox, ratio = window.devicePixelRatio || 1;
    pen.save();
    pen.beginPath();
    pen.rect(left, top, width, height);
    pen.clip();
    pen.lineWidth = 1.8 * ratio;
    for (const { pin, x, y } of this.lines) {
      const at = (k) => [plot.valToPos(x[k], "x", true), plot.valToPos(y[k], "y", true)];
      pen.strokeStyle = pen.fillStyle = this.colour(pin);
      pen.beginPath();
      y.forEach((value, k) => {
        if (value === null) return;
        if (k && y[k - 1] !== null) pen.lineTo(...at(k));
        else pen.moveTo(...at(k));
      });
      pen.stroke();
      if (y.at(-1) == null) continue;
      pen.beginPath();
      pen.arc(...at(y.length - 1), 3.5 * ratio, 0, 2 * Math.PI);
      pen.fill();
    }
    pen.restore();
  }
}

// What belongs to the whole joint: the scale of the map, displacements, reactions, friction between plates, and the residual.
function words({ load, moved, faying, dissipation, residual }, { units, loads }, most, longest) {
  const found = [`ring: hoop stress, blue ${withUnit(-most, units.traction, 3)} to red ${withUnit(most, units.traction, 3)}`, `longest arrow ${withUnit(longest, units.force, 3)}`];
  for (const [plate, [x, y]] of Object.entries(moved)) found.push(`${plate} moves ${withUnit(x, units.displacement, 3)}${Math.abs(y) > 1e-9 * Math.abs(x) ? `, ${withUnit(y, units.displacement, 3)}` : ""}`);
  for (const [name, value] of Object.entries(load)) if (!loads.some((one) => one.name === name)) found.push(`${name} ${withUnit(value, units.force, 3)}`);
  for (const [surface, x, y] of faying) found.push(`friction ${surface} ${withUnit(Math.hypot(x, y), units.force, 3)}`);
  return [...found, `dissipated ${withUnit(dissipation, units.energy, 3)}`, `residual ${digits(residual, 1)}`].join("; ");
}

// A canvas of this size in pixels of the page, empty.
function fitted(canvas, width, height) {
  const scale = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
  canvas.style.height = `${height}px`;
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  return pen;
}

function disk(pen, [x, y], radius, fill, stroke) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = stroke;
  pen.lineWidth = 1;
  pen.stroke();
}

// An angle from the bottom, counter-clockwise, in degrees, as the canvas counts it: clockwise from the right, in rad.
function turned(degrees) {
  return ((90 - degrees) * Math.PI) / 180;
}

// A colour from blue by white to red for -1 to 1.
function shade(part) {
  const [red, green, blue] = part < 0 ? [33, 102, 172] : [178, 24, 43], size = Math.min(Math.abs(part), 1);
  const mixed = [red, green, blue].map((one) => Math.round(255 + (one - 255) * size));
  return `rgb(${mixed.join()})`;
}
