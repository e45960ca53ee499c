// The table of key numbers of the state that is shown.

import { count } from "live/cycles";
import { OPEN } from "live/history";
import { degrees, digits, withUnit } from "live/units";

export function showNumbers(history) {
  const body = document.querySelector("#numbers tbody"), picture = history.shown;
  const ofLife = lifeCells(history), rows = [...ofLife, ...(picture ? cells(picture, history.case) : [["no load", ""]])];
  const lines = [];
  for (let k = 0; k < rows.length; k += 2) {
    const line = document.createElement("tr");
    if (k && k === ofLife.length) line.className = "first"; // of the state
    for (const [name, value] of [rows[k], rows[k + 1] ?? ["", ""]]) {
      const label = document.createElement("td"), number = document.createElement("td");
      label.textContent = name;
      number.textContent = value;
      line.append(label, number);
    }
    lines.push(line);
  }
  body.replaceChildren(...lines);
}

function cells(picture, { units, loads, axes }) {
  const unit = (kind, value) => withUnit(Math.abs(value) <= picture.rounding[kind] ? 0 : value, units[kind]);
  const acting = loads.filter(({ name }) => picture.load[name] || axes.some(({ load }) => load === name));
  const reactions = ["P", "Q"].filter((name) => !loads.some((load) => load.name === name));
  const loadCells = [
    ...acting.map((load) => [`${load.name}`, withUnit(picture.load[load.name], load.unit)]),
    ...reactions.map((name) => [`${name} (reaction)`, unit("force", picture.load[name])]),
  ];
  if (loadCells.length % 2) loadCells.push(["", ""]);
  return [
    ...loadCells,
    ["peak pressure", unit("traction", picture.peak_pressure)],
    ["at", degrees(picture.peak_pressure_angle)],
    ["peak shear", unit("traction", picture.peak_shear)],
    ["at", degrees(picture.peak_shear_angle)],
    ["contact", width(picture.contact)],
    ["of it sticks", share(picture.stick, picture.contact)],
    ["pin moves right", unit("displacement", picture.dx)],
    ["pin moves up", unit("displacement", picture.dy)],
    ["pin turns", unit("rotation", picture.rotation)],
    ["dissipated", unit("energy", picture.dissipation)],
    ...(picture.seat ? seatCells(picture.seat, unit) : []),
    ...(picture.hoop ? hoopCells(picture.hoop, unit) : []),
    ["nodes closed", `${picture.status.filter((one) => one !== OPEN).length} of ${picture.status.length}`],
    ["residual", digits(picture.residual, 1)],
  ];
}

// The numbers of a life of wear after the cycle that is shown.
function lifeCells({ life, cycle, case: { units } }) {
  if (!life) return [];
  const found = life.quantities.map(({ name, kind, values }) => [name, withUnit(values[cycle.number], units[kind])]);
  const share = cycle.pin_share === null ? [] : [["of it the pin", `${digits(100 * cycle.pin_share, 3)} %`]];
  const rows = [["cycles", count(cycle.cycle)], found[0], ...share, ...found.slice(1)];
  return rows.length % 2 ? [...rows, ["", ""]] : rows;
}

// The numbers of a bush that slips in its seat.
function seatCells({ rotation, dissipation, peak_slip, contact, stick }, unit) {
  return [
    ["bush turns", unit("rotation", rotation)],
    ["dissipated in its seat", unit("energy", dissipation)],
    ["bush slips up to", unit("displacement", Math.abs(peak_slip))],
    ["of its seat sticks", share(stick, contact)],
  ];
}

// The largest hoop stress, and its parts where something is pressed before any load.
function hoopCells({ degrees: angles, stress, assembly, seat }, unit) {
  const most = Math.max(...stress), place = stress.indexOf(most);
  const cells = [["largest hoop stress", unit("traction", most)], ["at", most === 0 ? degrees(null) : degrees(angles[place])]];
  if (assembly) cells.push(["of the assembly", unit("traction", assembly[place])], ["of the loads", unit("traction", most - assembly[place])]);
  if (seat) cells.push(["largest round the seat", unit("traction", Math.max(...seat))]);
  return cells;
}

function total(intervals) {
  return intervals.reduce((sum, [start, stop]) => sum + stop - start, 0);
}

function width(intervals) {
  return intervals.length ? `${degrees(total(intervals))}${intervals.length > 1 ? ` in ${intervals.length} parts` : ""}` : "none";
}

function share(stick, contact) {
  return contact.length ? `${digits((100 * total(stick)) / total(contact), 3)} %` : "–";
}
