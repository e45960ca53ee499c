// Loads that the page leads by itself: the case's history, a cycle, a turn, and the same load in two ways.

import { newGesture } from "live/lead";

const STEPS = 24; // pictures of a step of the case's history, and of a quarter of a cycle
const PAUSE = 24; // ms between two pictures
const LIFE = 4000; // ms of a whole life of wear

export class Player {
  constructor(history, leader, link, onChange) {
    Object.assign(this, { history, leader, link, onChange });
    this.running = 0;
  }

  get plays() {
    return this.running !== 0;
  }

  stop() {
    this.running = 0;
    this.onChange();
  }

  // Do some work that asks for loads, until it ends or is stopped.
  async run(work) {
    this.stop();
    const mine = (this.running = newGesture());
    this.onChange();
    try {
      await work(() => this.running === mine);
    } finally {
      if (this.running === mine) this.stop();
    }
  }

  // Go straight to a load in so many pictures. Returns whether it was reached.
  async go(to, goes, gesture, steps = STEPS) {
    const from = { ...this.history.latest?.acting };
    for (let k = 1; k <= steps; k++) {
      if (!goes()) return false;
      const part = k / steps;
      const load = Object.fromEntries(Object.entries(to).map(([name, value]) =>
        [name, k === steps ? value : (from[name] ?? 0) + part * (value - (from[name] ?? 0))]));
      const began = performance.now();
      const answer = await this.leader.step(load, gesture);
      if (answer.kind !== "pictures") return false;
      await pause(PAUSE - (performance.now() - began));
    }
    return true;
  }

  playCase() {
    return this.run(async (goes) => {
      await this.link.ask("reset");
      for (const corner of this.history.given.history) {
        if (!(await this.go(corner, goes, newGesture()))) return;
      }
    });
  }

  // Swing the load along x: right, left, and back.
  playCycle() {
    return this.run(async (goes) => {
      const [right, up] = this.history.case.axes, start = this.present();
      if (!start[up.load] && !start[right.load] && !(await this.go({ [up.load]: up.sign * -0.9 * up.size }, goes, newGesture()))) return;
      const middle = this.present()[right.load], gesture = newGesture();
      for (const side of [1, -1, 1]) {
        if (!(await this.go({ [right.load]: middle + side * 0.28 * right.size }, goes, gesture))) return;
      }
      await this.go({ [right.load]: middle }, goes, gesture);
    });
  }

  // Turn the load once round.
  playTurn() {
    return this.run(async (goes) => {
      const [right, up] = this.history.case.axes, load = this.present();
      const at = (axis) => (axis.sign * load[axis.load]) / axis.size;
      const size = Math.hypot(at(right), at(up)) || 0.9, start = Math.hypot(at(right), at(up)) ? Math.atan2(at(up), at(right)) : -0.5 * Math.PI;
      const gesture = newGesture(), count = 8 * STEPS;
      for (let k = 0; k <= count; k++) {
        const angle = start + (2 * Math.PI * k) / count;
        const to = { [right.load]: right.sign * size * right.size * Math.cos(angle), [up.load]: up.sign * size * up.size * Math.sin(angle) };
        if (!(await this.go(to, goes, gesture, 1))) return;
      }
    });
  }

  // The same load in two ways: straight, and by a detour to the right. The first one stays as the reference.
  playTwo() {
    return this.run(async (goes) => {
      const [right, up] = this.history.case.axes;
      const down = { [up.load]: -up.sign * 0.85 * up.size, [right.load]: 0 };
      const target = { ...down, [right.load]: right.sign * 0.1 * right.size };
      await this.link.ask("keep", { on: false });
      await this.link.ask("reset");
      if (!(await this.go(target, goes, newGesture()))) return;
      await this.link.ask("keep", { on: true });
      await pause(900);
      if (!goes()) return;
      await this.link.ask("reset");
      for (const to of [down, { [right.load]: right.sign * 0.3 * right.size }, target]) {
        if (!(await this.go(to, goes, newGesture()))) return;
      }
    });
  }

  // Show the pictures of the history again, one after the other.
  replay(show) {
    return this.run(async (goes) => {
      const { history } = this;
      if (history.isLatest) history.place = 0;
      while (goes() && !history.isLatest) {
        history.place += 1;
        show();
        await pause(2 * PAUSE);
      }
    });
  }

  // Show the cycles of a life of wear, one after the other.
  playLife(slider) {
    return this.run(async (goes) => {
      const { history } = this, last = history.life.cycles.length - 1;
      if (history.cycle.number === last) slider.choose(0);
      while (goes() && history.cycle.number < last) {
        await pause(Math.max(2 * PAUSE, LIFE / last));
        if (goes()) slider.choose(history.cycle.number + 1);
      }
    });
  }

  present() {
    const none = Object.fromEntries(this.history.case.axes.map(({ load }) => [load, 0]));
    return { ...none, ...this.history.latest?.load };
  }
}

function pause(time) {
  return new Promise((done) => setTimeout(done, Math.max(0, time)));
}
