// Sliders and fields: loads, and everything of the problem that can be changed.

import { newGesture } from "live/lead";
import { digits, inBaseUnit, numberText, scaled } from "live/units";

const GROUPS = { loads: "Loads", contact: "Contact", gap: "Initial gap", pin: "Pin", plate: "Plate", bush: "Bush", solver: "Solver" };
const NAMES = {
  P: "P, down", Q: "Q, right", M: "M, moment", ux: "ux, right", uy: "uy, up", rotation: "rotation",
  sxx: "σxx remote", syy: "σyy remote", sxy: "σxy remote", friction_change: "change of μ", friction: "friction μ",
  most_friction: "largest μ", friction_along: "μ along the rim", hole_lobes: "hole", pin_lobes: "pin", clearance: "clearance",
  plane: "plane", pin_load: "force acts", pin_bore: "bore radius", bore_load: "force in bore", plate_body: "plate",
  outer_radius: "outer radius", support: "rim", interference: "press fit", seat_friction: "seat's friction μ", plate_axis: "laminate axis",
};
const LABELS = { material: "material", E: "modulus E", nu: "Poisson ν", amplitude: "amplitude", axis: "widest gap at" };
const WORDS = { centre: "at its centre", body: "as body force", strain: "plane strain", stress: "plane stress" };
const LOAD_ENDS = 1.5; // ends of the sliders of loads, in parts of the usual load

export class Controls {
  constructor(history, leader, before, say) {
    Object.assign(this, { history, leader, before, say });
    this.place = document.getElementById("sliders");
    this.setters = new Map(); // by key: puts a value into its control
    this.kinds = "";
    this.follow = "load";
  }

  // Show a problem. Controls stay where they are if the problem has the same ones: one of them may be in the hand.
  make(isNew = false) {
    const { loads, controls, nodes } = this.history.given;
    const kinds = JSON.stringify([loads.map((load) => [load.name, load.size]), controls.map((one) => [one.name, one.choices])]);
    if (isNew || kinds !== this.kinds) this.build(loads, controls, nodes);
    this.kinds = kinds;
    this.show();
  }

  build(loads, controls, nodes) {
    const active = document.activeElement?.dataset?.key;
    this.setters.clear();
    const groups = new Map(Object.keys(GROUPS).map((name) => [name, []]));
    for (const load of loads) {
      const most = LOAD_ENDS * load.size;
      const control = { name: load.name, key: loadKey(load), unit: load.unit, least: -most, most, value: 0 };
      groups.get("loads").push(this.slider(control, (value, gesture) => this.leader.drag({ [load.name]: value }, gesture)));
    }
    for (const control of controls) {
      const send = (value, gesture) => this.leader.change({ [control.name]: value }, gesture, this.follow);
      groups.get(control.group).push(control.choices ? this.chooser(control, send) : this.slider(control, send));
    }
    groups.get("solver").push(this.solver(nodes), this.rule());
    const parts = [];
    for (const [name, lines] of groups) {
      if (!lines.length) continue;
      const heading = document.createElement("h2");
      heading.textContent = GROUPS[name];
      parts.push(heading, ...lines);
    }
    this.place.replaceChildren(...parts);
    if (active) this.place.querySelector(`[data-key="${active}"]`)?.focus();
  }

  // Put the present loads and the present problem into their controls.
  show() {
    const load = this.history.latest?.acting ?? {}, { loads, controls, nodes } = this.history.given;
    for (const one of loads) this.setters.get(loadKey(one))({ value: load[one.name] ?? 0 });
    for (const control of controls) this.setters.get(control.name)(control);
    this.setters.get("nodes")({ value: `${nodes}` });
  }

  slider(control, send) {
    const line = element("div", "control"), label = element("label");
    const scale = scaled(Math.max(Math.abs(control.least), Math.abs(control.most)), control.unit);
    const { factor, unit } = scale;
    const range = element("input"), field = element("input"), right = element("span");
    range.type = "range";
    Object.assign(range, { min: control.least, max: control.most, step: "any", value: control.value });
    range.dataset.key = `${control.name} slider`;
    Object.assign(field, { type: "text", inputMode: "decimal", className: "number", autocomplete: "off" }); // a number field drops the comma
    field.dataset.key = control.name;
    field.id = `field-${control.name}`;
    label.htmlFor = field.id;
    label.textContent = nameOf(control.name);
    range.setAttribute("aria-label", label.textContent);
    const note = element("span", "unit");
    note.textContent = unit;
    right.append(field, " ", note);
    line.append(label, right, range);
    let gesture = null, present = control.value;
    this.setters.set(control.key ?? control.name, ({ value, least, most }) => {
      present = value;
      if (document.activeElement !== field) field.value = plain(value * factor);
      if (gesture !== null) return; // the slider is in the hand
      if (least !== undefined) Object.assign(range, { min: least, max: most });
      range.value = value;
    });
    const move = (value) => {
      this.before();
      gesture ??= newGesture();
      send(value, gesture);
    };
    range.addEventListener("input", () => { move(Number(range.value)); field.value = plain(range.value * factor); });
    range.addEventListener("change", () => { gesture = null; });
    range.addEventListener("dblclick", () => { if (control.least < 0) { range.value = 0; move(0); gesture = null; } });
    field.addEventListener("change", () => {
      const text = numberText(field.value);
      if (text !== null) move(inBaseUnit(text, scale));
      else {
        if (field.value.trim()) this.say(`${label.textContent}: "${field.value}" is no number; write 1234.5 or 1234,5`);
        field.value = plain(present * factor);
      }
      gesture = null;
    });
    return line;
  }

  chooser(control, send) {
    const line = element("label", "choice");
    const select = element("select");
    select.dataset.key = control.name;
    for (const [value, words] of Object.entries(control.choices)) select.append(new Option(WORDS[words] ?? words, value));
    select.value = control.value;
    select.addEventListener("change", () => { this.before(); send(select.value, newGesture()); });
    this.setters.set(control.name, ({ value }) => {
      if (![...select.options].some((option) => option.value === value)) select.append(new Option(value, value));
      select.value = value;
    });
    line.append(nameOf(control.name), select);
    return line;
  }

  solver(nodes) {
    const { holes, most_nodes: most } = this.history.given, usual = holes ? [32, 64, 96, 128, 192] : [100, 200, 400, 800];
    const choices = Object.fromEntries([...new Set([...usual.filter((one) => one <= most), nodes])].sort((a, b) => a - b).map((n) => [n, `${n}`]));
    return this.chooser({ name: "nodes", value: `${nodes}`, choices }, (value, gesture) =>
      this.leader.send("nodes", { nodes: Number(value), follow: this.follow, gesture }));
  }

  rule() {
    const choices = { load: "straight to the load", history: "whole history again" };
    return this.chooser({ name: "after a change", value: this.follow, choices }, (value) => { this.follow = value; });
  }
}

// The key of a load's setter. The problem has a field "rotation" too.
function loadKey({ name }) {
  return `load ${name}`;
}

function nameOf(name) {
  return NAMES[name] ?? LABELS[name.split("_").at(-1)] ?? name;
}

function element(kind, className = "") {
  const made = document.createElement(kind);
  if (className) made.className = className;
  return made;
}

// A number as a field holds it.
function plain(value) {
  return digits(Number(value), 4).replace("−", "-").replace("e−", "e-");
}
