// The pin in its hole: bodies to scale, gaps enlarged, tractions and zones on the arc, the load as an arrow.

import { INK, PRESSURE, REFERENCE, SOFT, WARNING, ofStatus } from "live/colours";
import { partsOf, valueAt } from "live/curves";
import { digits, withUnit } from "live/units";

const REACH = 0.62; // length of the arrow of a load of usual size, in hole radii
const HIGH = 0.42; // height of the largest pressure, in hole radii
const GAP = 0.05; // width in which a usual clearance is drawn, in hole radii
const ARROWS = 8; // degrees between two arrows of the shear
const SHRINKS = [1, 2, 5, 10, 20, 50, 100, 1000, 1e4, 1e5, 1e6]; // how much smaller the arrow of a large load is drawn
const BORDER = 14; // pixels that its handle keeps from the border
const DEEPEST = 0.4; // largest gap that is drawn enlarged, in hole radii
const LABEL = 0.77; // place of the angles, in hole radii from the centre
const LONG = 0.17; // length of the largest arrow of the shear, in hole radii

export class Drawing {
  constructor(canvas, note) {
    this.canvas = canvas;
    this.note = note;
    this.context = canvas.getContext("2d");
    this.most = 0; // pressure that is drawn at full height
    this.lost = null; // a load that nothing carries
    this.held = false; // whether the load is dragged: the scale of its arrow then stays as it is
    this.shrink = 1; // how much smaller the arrow of the load is drawn than a usual one
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(history) {
    this.history = history;
    this.draw();
  }

  // Pixels per hole radius, and the centre.
  frame() {
    const { case: given } = this.history;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    const outer = Math.max(given.rim ?? 0, given.bush ?? 0) / given.radius;
    const view = Math.max(1.55, outer > 0 && outer < 3.2 ? 1.06 * outer : 0);
    return { x: width / 2, y: height / 2, radius: Math.min(width, height) / 2 / view, width, height };
  }

  // The place of a load on the canvas: the tip of its arrow.
  tip(load, shrink = this.shrink) {
    const { x, y, radius } = this.frame();
    const [right, up] = this.history.case.axes;
    const along = (axis) => (axis.sign * load[axis.load] * REACH * radius) / axis.size / shrink;
    return [x + along(right), y - along(up)];
  }

  // Draw the arrow of a large load smaller, so that its handle stays inside.
  fit(load, { width, height }) {
    if (this.held) return;
    const isInside = ([px, py]) => px > BORDER && px < width - BORDER && py > BORDER && py < height - BORDER;
    this.shrink = SHRINKS.find((shrink) => isInside(this.tip(load, shrink))) ?? SHRINKS.at(-1);
  }

  // The loads at a place of the canvas.
  loadsAt(px, py) {
    const { x, y, radius } = this.frame();
    const [right, up] = this.history.case.axes;
    const value = (axis, pixels) => (axis.sign * pixels * this.shrink * axis.size) / (REACH * radius);
    return { [right.load]: value(right, px - x), [up.load]: value(up, y - py) };
  }

  draw() {
    if (!this.history?.case) return;
    const scale = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.canvas.width !== Math.round(width * scale)) this.canvas.width = Math.round(width * scale);
    if (this.canvas.height !== Math.round(height * scale)) this.canvas.height = Math.round(height * scale);
    const pen = this.context;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = "round";
    const picture = this.history.shown, frame = { ...this.frame(), ...this.enlarged(picture) };
    if (picture) this.fit(picture.load, frame);
    this.remark(frame.times);
    this.bodies(pen, frame);
    this.pin(pen, frame, picture);
    if (picture) {
      this.most = peak(this.most, picture.peak_pressure) || 1;
      const { reference } = this.history;
      if (reference) this.pressure(pen, frame, reference, null, REFERENCE);
      this.pressure(pen, frame, picture, "rgba(125,147,165,.35)", PRESSURE);
      if (picture.seat) this.seat(pen, frame, picture.seat);
      this.zones(pen, frame, picture.zones, frame.edge);
      this.shear(pen, frame, picture);
      this.remote(pen, frame, picture);
    }
    this.angles(pen, frame);
    if (this.history.case.outline) this.plate(pen, frame, picture?.outline);
    this.trail(pen, frame);
    this.loads(pen, frame, picture);
  }

  // How much gaps are enlarged, and the radius of the hole's edge at an angle, in hole radii.
  enlarged(picture) {
    const { case: given, profiles } = this.history;
    const worn = picture?.cycle && partsOf(picture.cycle.worn)[0], deepest = Math.max(0, ...(worn?.both ?? []));
    const usual = Math.max(Math.abs(given.clearance), profiles.widest, deepest, 0.3 * given.yielded);
    const times = Math.max((GAP * given.radius) / usual, 1);
    const part = (gap) => (gap * times) / given.radius;
    const edge = (degrees) => 1 + Math.max(-DEEPEST, Math.min(DEEPEST, part(profiles.gap("hole", degrees) + (worn ? valueAt(worn, "hole", degrees) ?? 0 : 0))));
    return { times, edge, part };
  }

  bodies(pen, frame) {
    const { case: given } = this.history, { x, y, radius, width, height, edge } = frame;
    const circle = (size, colour) => {
      pen.beginPath();
      pen.arc(x, y, size, 0, 2 * Math.PI);
      pen.fillStyle = colour;
      pen.fill();
    };
    pen.fillStyle = given.rim ? "#ffffff" : "#e6e4df";
    pen.fillRect(0, 0, width, height);
    if (given.rim) {
      circle((radius * given.rim) / given.radius, "#e6e4df");
      pen.strokeStyle = "#8d8a83";
      pen.lineWidth = 1.5;
      pen.stroke();
    }
    if (given.bush) {
      circle((radius * given.bush) / given.radius, "#dccaa4");
      pen.strokeStyle = "#a48f5f";
      pen.lineWidth = 1;
      pen.stroke();
    }
    pen.beginPath();
    trace(pen, frame, edge, -180, 180);
    pen.closePath();
    pen.fillStyle = "#ffffff";
    pen.fill();
    pen.strokeStyle = "#8d8a83";
    pen.lineWidth = 1;
    pen.stroke();
  }

  // The whole plate to scale in the corner: edges, supports (thick), loads (dashed), and the governing place.
  plate(pen, { width, height }, governing) {
    const { outline, radius, bush, units } = this.history.case, every = outline.flatMap((edge) => edge.line);
    const [left, right, low, high] = [0, 1].flatMap((k) => [Math.min(...every.map((p) => p[k])), Math.max(...every.map((p) => p[k]))]);
    const scale = Math.min((0.26 * width) / (right - left), (0.3 * height) / (high - low));
    const at = ([px, py]) => [8 + (px - left) * scale, 8 + (high - py) * scale];
    pen.fillStyle = "rgba(255,255,255,.85)";
    pen.fillRect(0, 0, (right - left) * scale + 16, (high - low) * scale + (governing?.edge ? 30 : 16));
    for (const { line, hold, load } of outline) {
      pen.beginPath();
      for (const place of line) pen.lineTo(...at(place));
      pen.strokeStyle = hold ? INK : "#8d8a83";
      pen.lineWidth = hold ? 3 : 1.2;
      pen.setLineDash(load ? [4, 3] : []);
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.beginPath();
    pen.arc(...at([0, 0]), (bush || radius) * scale, 0, 2 * Math.PI);
    pen.lineWidth = 1.2;
    pen.strokeStyle = "#8d8a83";
    pen.stroke();
    if (!governing?.edge) return;
    pen.beginPath();
    pen.arc(...at([governing.x, governing.y]), 3.5, 0, 2 * Math.PI);
    pen.fillStyle = WARNING;
    pen.fill();
    pen.font = "11px sans-serif";
    pen.textAlign = "left";
    pen.fillStyle = INK;
    pen.fillText(`${governing.edge}: ${withUnit(governing.value, units.traction)}`, 8, (high - low) * scale + 24);
  }

  // The pin: the hole less its gap, which is enlarged.
  pin(pen, frame, picture) {
    const { case: given, profiles } = this.history, { x, y, radius, times, edge, part } = frame;
    const most = times > 1 ? DEEPEST : 0.95; // of the radius
    const size = (angle, gap) => edge(angle) - Math.min(part(gap), most);
    const free = (angle) => given.clearance + profiles.gap("hole", angle) + profiles.gap("pin", angle);
    pen.beginPath();
    if (picture) {
      const { nodes } = picture, { degrees } = nodes;
      degrees.forEach((angle, k) => pen.lineTo(...spot(frame, angle, size(angle, picture.gap[k]))));
      if (!nodes.whole) {
        const gapAt = rigidGap(picture, free), [start, stop] = [degrees[0] + 360, degrees.at(-1)];
        trace(pen, frame, (angle) => size(angle, Math.max(gapAt(angle), 0)), stop, start);
      }
    } else {
      trace(pen, frame, (angle) => size(angle, Math.max(free(angle), 0)), -180, 180);
    }
    pen.closePath();
    pen.fillStyle = "#c3ced8";
    pen.fill();
    pen.strokeStyle = "#7a8894";
    pen.lineWidth = 1;
    pen.stroke();
    const angle = picture ? picture.rotation * times : 0;
    const inner = (radius * given.bore) / given.radius;
    pen.strokeStyle = "#aab7c2";
    for (const turn of [0, 0.5 * Math.PI, Math.PI, 1.5 * Math.PI]) {
      const direction = [Math.cos(angle + turn), -Math.sin(angle + turn)];
      pen.beginPath();
      pen.moveTo(x + inner * direction[0], y + inner * direction[1]);
      pen.lineTo(x + 0.78 * radius * direction[0], y + 0.78 * radius * direction[1]);
      pen.stroke();
    }
    if (given.bore > 0) {
      pen.beginPath();
      pen.arc(x, y, inner, 0, 2 * Math.PI);
      pen.fillStyle = "#ffffff";
      pen.fill();
      pen.strokeStyle = "#7a8894";
      pen.stroke();
    }
  }

  // How gaps and the load are drawn.
  remark(times) {
    const gaps = times === 1 ? "gaps to scale" : this.history.case.dimensionless ? "gaps enlarged" : `gaps enlarged ${digits(times, 2)} times`;
    this.note.textContent = this.shrink === 1 ? gaps : `${gaps}; arrow of the load at 1/${this.shrink}`;
  }

  pressure(pen, frame, picture, fill, stroke) {
    for (const { degrees, pressure } of partsOf(picture.curves)) {
      pen.beginPath();
      degrees.forEach((angle, k) => pen.lineTo(...spot(frame, angle, frame.edge(angle) + (HIGH * pressure[k]) / this.most)));
      pen.strokeStyle = stroke;
      pen.lineWidth = 1.5;
      pen.stroke();
      if (fill) {
        trace(pen, frame, frame.edge, degrees.at(-1), degrees[0]);
        pen.fillStyle = fill;
        pen.fill();
      }
    }
  }

  // A bush that slips: its zones in the seat, and four marks that turn with it.
  seat(pen, frame, { zones, rotation }) {
    const { case: given } = this.history, { x, y, radius, times } = frame, outer = given.bush / given.radius;
    pen.strokeStyle = "#a48f5f";
    pen.lineWidth = 1.5;
    for (let quarter = 0; quarter < 4; quarter++) {
      const angle = rotation * times + (quarter * Math.PI) / 2, [right, up] = [Math.cos(angle), Math.sin(angle)];
      pen.beginPath();
      for (const size of [0.5 * (1 + outer), outer]) pen.lineTo(x + size * radius * right, y - size * radius * up);
      pen.stroke();
    }
    this.zones(pen, frame, zones, () => outer);
  }

  // A band along an edge in the colours of stick and slip.
  zones(pen, frame, zones, edge) {
    pen.lineWidth = Math.max(5, 0.028 * frame.radius);
    for (const [start, stop, status] of zones) {
      pen.beginPath();
      trace(pen, frame, edge, start, stop);
      pen.strokeStyle = ofStatus(status);
      pen.stroke();
    }
  }

  // Arrows along the pin: the shear traction on it. A narrow contact has shorter ones.
  shear(pen, { x, y, radius }, picture) {
    const parts = partsOf(picture.curves), largest = this.most * Math.max(this.history.case.friction, 1e-3);
    pen.lineWidth = 2;
    for (const part of parts) {
      const start = part.degrees[0], wide = part.degrees.at(-1) - start;
      const step = wide / Math.max(Math.round(wide / ARROWS), 1);
      for (let place = start + 0.5 * step; place < start + wide; place += step) {
        const shear = valueAt(part, "shear", place) / largest;
        if (Math.abs(shear) < 0.03) continue;
        const angle = onCircle(place), long = LONG * Math.min(step / ARROWS, 1) * Math.max(-1.2, Math.min(1.2, shear));
        const ring = 0.87 * radius;
        const middle = [x + ring * Math.cos(angle), y - ring * Math.sin(angle)];
        const along = [-Math.sin(angle) * long * radius, -Math.cos(angle) * long * radius];
        arrow(pen, middle[0] - along[0] / 2, middle[1] - along[1] / 2, middle[0] + along[0] / 2, middle[1] + along[1] / 2, INK, 7);
      }
    }
  }

  // Arrows at the borders: the remote stresses.
  remote(pen, { x, y, width, height }, picture) {
    const size = this.history.case.loads.find((load) => load.name === "sxx")?.size;
    if (!size) return;
    const long = (value) => (26 * value) / size;
    const { sxx, syy, sxy } = picture.load;
    pen.lineWidth = 2;
    for (const part of [-0.6, 0, 0.6]) {
      for (const side of [-1, 1]) {
        const [left, top] = [x + side * (width / 2 - 34), y + side * (height / 2 - 34)];
        const row = y + part * (height / 2 - 40), line = x + part * (width / 2 - 40);
        if (sxx) arrow(pen, left, row, left + side * long(sxx), row, SOFT, 5, sxx < 0);
        if (syy) arrow(pen, line, top, line, top + side * long(syy), SOFT, 5, syy < 0);
        if (sxy) {
          arrow(pen, left + side * 8, row + long(sxy) / 2, left + side * 8, row - side * long(sxy), SOFT, 5);
          arrow(pen, line, top + side * 8, line - side * long(sxy), top + side * 8, SOFT, 5);
        }
      }
    }
  }

  // The angles of the charts at four places round the hole.
  angles(pen, { x, y, radius }) {
    pen.fillStyle = SOFT;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const [words, right, down] of [["0°", 0, 1], ["90°", 1, 0], ["180°", 0, -1], ["−90°", -1, 0]]) {
      pen.fillText(words, x + LABEL * radius * right, y + LABEL * radius * down);
    }
  }

  // The way of the load so far.
  trail(pen) {
    const { pictures, place, reference } = this.history;
    pen.strokeStyle = "rgba(213,94,0,.45)";
    pen.lineWidth = 1.5;
    pen.beginPath();
    const { x, y } = this.frame();
    if (place < pictures.length && pictures.length < 2000) pen.moveTo(x, y);
    for (let k = 0; k <= place; k++) pen.lineTo(...this.tip(pictures[k].load));
    pen.stroke();
    if (reference) {
      const [px, py] = this.tip(reference.load);
      pen.beginPath();
      pen.arc(px, py, 10, 0, 2 * Math.PI);
      pen.strokeStyle = SOFT;
      pen.lineWidth = 2;
      pen.setLineDash([3, 3]);
      pen.stroke();
      pen.setLineDash([]);
    }
  }

  loads(pen, { x, y, radius }, picture) {
    const load = picture?.load ?? Object.fromEntries(this.history.case.axes.map((axis) => [axis.load, 0]));
    const [px, py] = this.tip(load);
    pen.lineWidth = 4;
    pen.strokeStyle = WARNING;
    if (Math.hypot(px - x, py - y) > 8) arrow(pen, x, y, px, py, WARNING, 11);
    pen.beginPath();
    pen.arc(px, py, 7, 0, 2 * Math.PI);
    pen.fillStyle = "#ffffff";
    pen.fill();
    pen.lineWidth = 3;
    pen.strokeStyle = WARNING;
    pen.stroke();
    const moment = this.history.case.loads.find((one) => one.name === "M");
    if (picture && moment && picture.load.M) {
      const sweep = Math.max(-5.5, Math.min(5.5, (2.5 * picture.load.M) / moment.size));
      const ring = 0.3 * radius;
      pen.beginPath();
      pen.arc(x, y, ring, 0, -sweep, sweep > 0);
      pen.lineWidth = 3;
      pen.stroke();
      const end = [x + ring * Math.cos(sweep), y - ring * Math.sin(sweep)], way = Math.sign(sweep) * 10;
      arrow(pen, ...end, end[0] - way * Math.sin(sweep), end[1] - way * Math.cos(sweep), WARNING, 9);
    }
    if (this.lost) {
      const [lx, ly] = this.tip({ ...load, ...this.lost });
      if (Math.hypot(lx - px, ly - py) < 4) return;
      pen.setLineDash([6, 5]);
      pen.lineWidth = 2.5;
      arrow(pen, x, y, lx, ly, INK, 9);
      pen.setLineDash([]);
    }
  }
}

// A largest value that follows `value` only if it leaves the range from a third to the whole: no flicker.
export function peak(before, value) {
  return value > before || value < before / 3 ? value * 1.15 : before;
}

// Beyond an arc of nodes the pin is drawn as rigid. The answer is its gap at an angle: that of a pin which has the gaps of
// both ends, where `free` is the gap of a concentric pin.
function rigidGap({ nodes: { degrees }, gap }, free) {
  const [start, stop] = [degrees[0], degrees.at(-1)], [first, last] = [start, stop].map(onCircle);
  const [one, other] = [free(start) - gap[0], free(stop) - gap.at(-1)], part = Math.sin(last - first);
  const right = (one * Math.sin(last) - other * Math.sin(first)) / part, up = (other * Math.cos(first) - one * Math.cos(last)) / part;
  return (angle) => free(angle) - right * Math.cos(onCircle(angle)) - up * Math.sin(onCircle(angle));
}

// The place on the canvas at an angle and a distance from the centre in hole radii.
function spot({ x, y, radius }, degrees, size) {
  const angle = onCircle(degrees);
  return [x + radius * size * Math.cos(angle), y - radius * size * Math.sin(angle)];
}

// Go on with a path along a curve: from one angle to another, with the distance from the centre at each.
function trace(pen, frame, size, start, stop) {
  const steps = Math.max(Math.ceil(2 * Math.abs(stop - start)), 2);
  for (let k = 0; k <= steps; k++) {
    const angle = start + ((stop - start) * k) / steps;
    pen.lineTo(...spot(frame, angle, size(angle)));
  }
}

// An angle from the bottom, in degrees, as the angle from the right, in rad.
function onCircle(angle) {
  return ((angle - 90) * Math.PI) / 180;
}

export function arrow(pen, x, y, tx, ty, colour, head, backwards = false) {
  if (backwards) [x, y, tx, ty] = [tx, ty, x, y];
  const long = Math.hypot(tx - x, ty - y);
  if (long < 1) return;
  const [cos, sin] = [(tx - x) / long, (ty - y) / long], size = Math.min(head, long);
  const neck = [tx - size * cos, ty - size * sin];
  pen.strokeStyle = pen.fillStyle = colour;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(...neck);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(tx, ty);
  pen.lineTo(neck[0] - 0.5 * size * sin, neck[1] + 0.5 * size * cos);
  pen.lineTo(neck[0] + 0.5 * size * sin, neck[1] - 0.5 * size * cos);
  pen.closePath();
  pen.fill();
}
