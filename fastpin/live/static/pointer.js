// The load follows the mouse, a finger, or the arrow keys.

import { newGesture } from "live/lead";

const NEAR = 12; // pixels within which the load of the reference is met
const STEP = 0.02; // of an arrow key, in parts of a usual load
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Pointer {
  constructor(drawing, history, leader, before) {
    Object.assign(this, { drawing, history, leader, before });
    this.gesture = null;
    this.held = null; // the gesture of the arrow keys that are down
    this.asked = null; // the load of the latest arrow key
    const { canvas } = drawing;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => this.up(event));
    document.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("keyup", (event) => { if (KEYS[event.key]) this.held = null; });
    window.addEventListener("blur", () => { this.held = null; });
  }

  down(event) {
    if (event.button !== 0 || !this.history.given?.axes.length) return;
    this.before();
    this.gesture = newGesture();
    const tip = this.drawing.tip(this.present());
    // The tip stays at the same distance from the mouse, so a click moves nothing.
    const near = Math.hypot(event.offsetX - tip[0], event.offsetY - tip[1]) < 30;
    this.offset = near ? [event.offsetX - tip[0], event.offsetY - tip[1]] : [0, 0];
    this.drawing.held = true;
    this.drawing.canvas.setPointerCapture(event.pointerId);
    this.drawing.canvas.classList.add("dragging");
    if (!near) this.move(event);
  }

  move(event) {
    if (this.gesture === null) return;
    const [x, y] = [event.offsetX - this.offset[0], event.offsetY - this.offset[1]];
    this.leader.drag(this.snapped(x, y), this.gesture);
  }

  up() {
    this.gesture = null;
    this.drawing.held = false;
    this.drawing.draw();
    this.drawing.canvas.classList.remove("dragging");
  }

  // The loads at a place. Near the reference they are exactly those of the reference.
  snapped(x, y) {
    const { reference } = this.history;
    if (reference) {
      const [px, py] = this.drawing.tip(reference.load);
      if (Math.hypot(px - x, py - y) < NEAR) {
        return Object.fromEntries(this.history.case.axes.map(({ load }) => [load, reference.load[load]]));
      }
    }
    return this.drawing.loadsAt(x, y);
  }

  present() {
    const none = Object.fromEntries(this.history.case.axes.map(({ load }) => [load, 0]));
    return { ...none, ...this.history.latest?.load };
  }

  // Whether a part of the drawing is in the window. If not, the arrow keys scroll the page.
  isSeen() {
    const box = this.drawing.canvas.getBoundingClientRect();
    return box.bottom > 0 && box.top < window.innerHeight;
  }

  key(event) {
    const way = KEYS[event.key];
    if (!way || event.ctrlKey || event.metaKey || !this.history.given?.axes.length) return;
    if (event.target.matches("input, select") || !this.isSeen()) return; // the browser's own keys
    event.preventDefault();
    this.before();
    this.held ??= newGesture();
    const step = STEP * (event.shiftKey ? 5 : event.altKey ? 0.1 : 1), load = this.leader.busy && this.asked ? this.asked : this.present();
    const moved = this.history.case.axes.map((axis, k) => [axis.load, load[axis.load] + axis.sign * way[k] * step * axis.size]);
    this.asked = Object.fromEntries(moved); // a key that comes before the answer goes on from here
    this.leader.drag(this.asked, this.held);
  }
}
