// What the page knows: the problem, the pictures of the history, the reference, and which picture is shown.

import { floats, statuses } from "live/arrays";

export const STEPS_OF_MAP = 400;
const ROWS = 180;
export const OPEN = 2, SLIDES = 3; // statuses: open, and closed without friction; 0 sticks, +1 and -1 slip

export class History {
  constructor() {
    this.pictures = [];
    this.grids = new Map();
    this.case = null;
    this.reference = null;
    this.undos = 0;
    this.redos = 0;
    this.place = -1;
  }

  // Take the news of the server. Returns whether the problem is another one.
  take(answer) {
    for (const [name, text] of Object.entries(answer.grids ?? {})) {
      if (!this.grids.has(name)) this.grids.set(name, grid(floats(text)));
    }
    const isNew = answer.case !== undefined;
    if (isNew) this.case = answer.case;
    const added = answer.add.map((picture) => this.unpacked(picture));
    this.pictures = this.pictures.slice(answer.drop ?? 0).slice(0, answer.keep ?? 0).concat(added);
    if (answer.reference !== undefined) this.reference = answer.reference && this.unpacked(answer.reference);
    this.undos = answer.undos ?? 0;
    this.redos = answer.redos ?? 0;
    this.place = this.pictures.length - 1;
    return isNew;
  }

  unpacked(picture) {
    const found = { ...picture, nodes: this.grids.get(picture.grid) };
    for (const name of ["pressure", "shear", "gap"]) found[name] = floats(picture[name]);
    found.status = statuses(picture.status);
    if (this.case.friction === 0) {
      // without friction there is neither stick nor slip
      found.status = found.status.map((status) => (status === OPEN ? OPEN : SLIDES));
      found.slip = picture.slip.map(([start, stop]) => [start, stop, SLIDES]);
    }
    found.hoop = picture.hoop && { degrees: floats(picture.hoop.degrees), stress: floats(picture.hoop.stress) };
    found.column = column(found);
    return found;
  }

  get shown() {
    return this.pictures[this.place] ?? null;
  }

  get latest() {
    return this.pictures.at(-1) ?? null;
  }

  get isLatest() {
    return this.place === this.pictures.length - 1;
  }
}

// The nodes of a grid: angles in rad and in degrees from the bottom, and for each row of the map its nearest node.
function grid(theta) {
  const degrees = Array.from(theta, (angle) => fromBottom(angle));
  const order = Array.from(degrees.keys()).sort((a, b) => degrees[a] - degrees[b]);
  const spacing = (360 / theta.length) * 1.5;
  const rows = new Int32Array(ROWS);
  for (let row = 0; row < ROWS; row++) {
    const angle = 179 - (360 / ROWS) * row;
    let best = -1, least = Math.max(spacing, 360 / ROWS);
    for (let k = 0; k < degrees.length; k++) {
      const away = Math.abs(((angle - degrees[k] + 540) % 360) - 180);
      if (away < least) { least = away; best = k; }
    }
    rows[row] = best;
  }
  const whole = theta.length > 4 && 2 * Math.PI - (theta.at(-1) - theta[0]) < 1.5 * (theta[1] - theta[0]);
  return { theta, degrees, order, rows, whole, name: `${theta.length}` };
}

export function fromBottom(angle) {
  const turned = (((angle * 180) / Math.PI + 90 + 180) % 360 + 360) % 360 - 180;
  return Math.abs(turned - 180) < 1e-4 ? -180 : turned;
}

// The statuses of a picture in the rows of the map, top first.
function column(picture) {
  const found = new Int8Array(ROWS);
  for (let row = 0; row < ROWS; row++) {
    const node = picture.nodes.rows[row];
    found[row] = node < 0 ? OPEN : picture.status[node];
  }
  return found;
}
