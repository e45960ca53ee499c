// What the page knows: the problem, the pictures of the history, the reference, and which picture is shown.

import { floats, statuses } from "live/arrays";
import { CycleScale } from "live/cycles";
import { Profiles } from "live/profiles";

export const OPEN = 2, SLIDES = 3; // statuses: open, and closed without friction; 0 sticks, +1 and -1 slip

export class History {
  constructor() {
    this.pictures = [];
    this.grids = new Map();
    this.given = null; // the case of the server: of one pin, or of a joint, which has a case for each hole
    this.hole = 0; // the hole of a joint that is shown
    this.case = null; // that of one pin, or of the hole
    this.profiles = null; // initial gaps and friction of the case
    this.reference = null;
    this.life = null; // of wear: its stored cycles, each with the pictures over one cycle
    this.cycle = null; // the stored cycle that is shown
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
    if (isNew) {
      this.given = answer.case;
      this.takeCase();
    }
    const added = answer.add.map((picture) => this.unpacked(picture));
    this.pictures = this.pictures.slice(answer.drop ?? 0).slice(0, answer.keep ?? 0).concat(added);
    if (answer.reference !== undefined) this.reference = answer.reference && this.unpacked(answer.reference);
    this.undos = answer.undos ?? 0;
    this.redos = answer.redos ?? 0;
    this.place = this.pictures.length - 1;
    if (answer.life) this.takeLife(answer.life);
    return isNew;
  }

  takeCase() {
    const { given, hole } = this;
    this.case = given.holes ? { ...given.holes[hole], title: given.title, prefixes: given.prefixes } : given;
    this.profiles = new Profiles(this.case);
  }

  // Show another hole of a joint.
  look(hole) {
    this.hole = hole;
    this.takeCase();
    this.pictures = this.pictures.map(({ joint }) => this.unpacked(joint));
    this.reference &&= this.unpacked(this.reference.joint);
  }

  // Take a life of wear, and show its end.
  takeLife(life) {
    const { degrees, values } = life.damage;
    const cycles = life.cycles.map((given, number) => {
      const damage = Object.fromEntries(Object.entries(values).map(([owner, texts]) => [owner, texts[number]]));
      const cycle = { ...given, number, worn: unpackedAll(given.worn), damage: unpackedAll({ degrees, ...damage }) };
      cycle.worn.both = cycle.worn.pin.map((depth, k) => depth + cycle.worn.hole[k]);
      cycle.pictures = given.pictures.map((picture) => ({ ...this.unpacked(picture), cycle }));
      return cycle;
    });
    this.life = { ...life, cycles, scale: new CycleScale(cycles.map(({ cycle }) => cycle)) };
    this.choose(cycles.length - 1);
    this.place = this.pictures.length - 1;
  }

  // Show a stored cycle of a life of wear, at the same place of the cycle.
  choose(number) {
    this.cycle = this.life.cycles[number];
    this.pictures = this.cycle.pictures;
  }

  // A picture with its arrays; of a joint that of the hole. "acting" are the loads that the user leads.
  unpacked(given) {
    const picture = given.holes?.[this.hole] ?? given;
    const found = { ...picture, acting: given.load, joint: given.holes && given, nodes: this.grids.get(picture.grid) };
    for (const name of ["pressure", "shear", "gap"]) found[name] = floats(picture[name]);
    found.status = statuses(picture.status);
    if (this.case.friction === 0) {
      // without friction there is neither stick nor slip
      found.status = found.status.map((status) => (status === OPEN ? OPEN : SLIDES));
    }
    found.zones = zonesOf(picture, this.case.friction === 0);
    if (picture.seat) found.seat = { ...picture.seat, zones: zonesOf(picture.seat, picture.seat.frictionless) };
    found.hoop = picture.hoop && unpackedAll(picture.hoop);
    found.curves = unpackedAll(picture.curves);
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

// The zones of a contact: start and stop in degrees, and the status.
export function zonesOf({ stick, slip }, isFrictionless) {
  const found = [...stick.map((ends) => [...ends, 0]), ...slip];
  return found.map(([start, stop, status]) => [start, stop, isFrictionless ? SLIDES : status]);
}

function unpackedAll(arrays) {
  return Object.fromEntries(Object.entries(arrays).map(([name, text]) => [name, floats(text)]));
}

// The nodes of a grid: their angles in degrees from the bottom, and whether they stand all round.
function grid(theta) {
  const degrees = Array.from(theta, (angle) => (180 * angle) / Math.PI + 90);
  const whole = theta.length > 4 && 2 * Math.PI - (theta.at(-1) - theta[0]) < 1.5 * (theta[1] - theta[0]);
  return { degrees, whole };
}
