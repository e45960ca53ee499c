// The page: a live contact at a server, or a recording that is replayed.

import { RoundCharts } from "live/charts";
import { Controls } from "live/controls";
import { partsOf, together } from "live/curves";
import { Drawing } from "live/drawing";
import { download, image, loadsText } from "live/files";
import { History } from "live/history";
import { JointView } from "live/joint";
import { Leader } from "live/lead";
import { LifeSlider } from "live/life";
import { Link } from "live/link";
import { LoopChart } from "live/loops";
import { MapChart } from "live/map";
import { showNumbers } from "live/numbers";
import { Player } from "live/play";
import { Pointer } from "live/pointer";
import { fixPrefixes, withUnit } from "live/units";
import { WHOLE } from "live/window";

const SAME = 1e-9; // relative difference of two loads that count as the same
const recorded = document.getElementById("recording");
const at = (id) => document.getElementById(id);

const history = new History();
const drawing = new Drawing(at("drawing"), at("scale-note"));
const charts = new RoundCharts(history);
const loops = new LoopChart(history);
const map = new MapChart(history, charts);
const joint = new JointView(history, look);
charts.onZoom = show;
const times = []; // when pictures were asked for and drawn, ms: for measurements
let waiting = false, link = null, leader = null, player = null, controls = null, life = null;

// Draw at the next frame; several calls before it count once.
function show() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(draw);
}

function draw() {
  waiting = false;
  if (!history.case) return;
  const began = performance.now();
  drawing.show(history);
  charts.show();
  loops.show();
  map.show();
  joint.show();
  showNumbers(history);
  life?.draw();
  showTimeline();
  showLesson();
  at("doubt").textContent = [...history.case.doubts, history.shown?.doubt ?? ""].filter(Boolean).join("; ");
  times.push({ began, drawn: performance.now(), asked: leader?.asked ?? 0, serial: history.shown?.serial ?? 0 });
  if (times.length > 5000) times.splice(0, 1000);
}

function showTimeline() {
  const count = history.pictures.length;
  at("scrub").max = Math.max(count - 1, 0);
  at("scrub").value = Math.max(history.place, 0);
  at("scrub").disabled = at("replay").disabled = count < 2;
  at("step").textContent = count ? `${life ? "state" : "step"} ${history.place + 1} of ${count}` : "no steps";
  at("undo").disabled = !history.undos;
  at("redo").disabled = !history.redos;
  at("keep").setAttribute("aria-pressed", String(Boolean(history.reference)));
  at("keep").textContent = history.reference ? "Forget reference" : "Keep as reference";
}

// The contact remembers its way: say so where the load is that of the reference.
function showLesson() {
  const { shown, reference, given } = history;
  let words = "";
  if (shown && reference && shown !== reference && shown.serial !== reference.serial) {
    const names = given.loads.map((load) => load.name);
    if (names.every((name) => near(shown.acting[name], reference.acting[name], given.loads.find((load) => load.name === name).size))) {
      const { values } = together([shown, reference].map((one) => partsOf(one.curves)), WHOLE), before = values(1, "shear");
      const most = values(0, "shear").reduce((found, value, k) => Math.max(found, Math.abs(value - before[k])), 0);
      const unit = history.case.units.traction, part = most / Math.max(Math.abs(reference.peak_shear), 1e-300);
      words = part > 1e-6
        ? `Same load as the reference, ${life ? "on another profile" : "reached in another way"}: the shear differs by up to ${withUnit(most, unit, 3)}.${life ? "" : " The contact remembers its way."}`
        : "Same load and same tractions as the reference.";
    }
  }
  if (at("lesson").textContent !== words) at("lesson").textContent = words;
}

// Where a load was lost: the loads that differ from the present ones.
function where(load) {
  const before = history.latest?.acting ?? {};
  const moved = history.given.loads.filter(({ name, size }) => !near(load[name] ?? 0, before[name] ?? 0, 1e3 * size));
  const words = moved.map(({ name, unit }) => `${name} = ${withUnit(load[name], unit)}`);
  return words.length ? `, at ${words.join(", ")}` : "";
}

function near(one, other, size) {
  return Math.abs(one - other) <= SAME * size;
}

function say(sentence, kind = "") {
  at("message").hidden = !sentence;
  at("message").className = kind;
  at("sentence").textContent = sentence;
  at("csv").hidden = kind !== "gone" && kind !== "unsaved"; // then the loads are what can be saved
}

function news(answer) {
  if (answer.kind === "welcome") {
    return;
  }
  if (answer.kind === "pictures") {
    const isNew = history.take(answer);
    drawing.lost = null;
    if (isNew) {
      describe();
      at("title").textContent = history.case.title ? `· ${history.case.title}` : "";
      document.title = `fastpin live${history.case.title ? ` · ${history.case.title}` : ""}`;
      listUnits();
      if (history.given.holes) showJoint();
      if (history.life) showLife();
      controls?.make();
    } else controls?.show();
    if (answer.sentence) say(answer.sentence);
    else if (at("message").className !== "gone") say("");
    show();
  } else if (answer.kind === "lost") {
    drawing.lost = history.given.holes ? null : answer.load;
    say(`${answer.sentence}${where(answer.load)}. The contact stays at the last load that was carried.`);
    controls?.show();
    show();
  } else if (answer.kind === "refused") {
    say(answer.sentence);
    if (history.case) controls?.show();
  }
}

// The words on the pin, or on the hole of a joint, that is shown.
function describe() {
  at("hoop-body").textContent = history.case.plate === "bushing" ? "bush round the hole, and of the plate round its seat (dashed)" : "plate round the hole";
  at("profiles").textContent = history.case.profile_words.map(([name, words]) => `${name}: ${words}`).join("; ");
}

// Show another hole of a joint.
function look(hole) {
  history.look(hole);
  charts.forget();
  drawing.most = 0;
  describe();
  show();
}

// Show that the problem is a joint of several pins.
function showJoint() {
  document.body.classList.add("joint");
  if (!recorded) at("help").textContent = "The sliders move the loads. Choose a hole above, or in the map.";
  at("drawing").setAttribute("aria-label", "Pin in the chosen hole");
  document.querySelector("#legend .load").textContent = "force on the plate";
  joint.make();
}

// Show that the recording is a life of wear: a slider of its cycles, and its charts.
function showLife() {
  document.body.classList.add("life");
  charts.addLife();
  life = new LifeSlider(history, player, show);
  at("help").textContent = "Space plays the cycles, arrow keys go from one to the next.";
  at("life-remark").textContent = history.life.remark;
  at("map-words").textContent = "at this state over the cycles";
  at("play-life").addEventListener("click", replay);
}

function status(word) {
  if (at("connection").dataset.word === word) return;
  at("connection").dataset.word = word;
  at("connection").textContent = { connected: "connected", computing: "computing …", again: "connecting again …", lost: "no server" }[word];
  playing();
  if (word === "lost") say("The server has ended. The history stays on this page: its loads can be saved. Start fastpin live again for a new page.", "gone");
  else if (word === "connected" && at("message").className === "gone") say("");
}

// Before the user moves something: playing stops, and the latest state is shown.
function before() {
  player?.stop();
  if (!history.isLatest) {
    history.place = history.pictures.length - 1;
    show();
  }
}

function listen() {
  const click = (id, work) => at(id).addEventListener("click", work);
  const ask = (kind, fields) => () => { before(); link.ask(kind, fields); };
  click("dismiss", () => say(""));
  click("save-image", async () => download("fastpin.png", await image(history.case?.title || "fastpin")));
  click("csv", () => download("loads.csv", new Blob([loadsText(history)], { type: "text/csv" })));
  click("keep", () => {
    if (!recorded) return link.ask("keep", { on: !history.reference });
    history.reference = history.reference ? null : history.shown;
    return show();
  });
  at("scrub").addEventListener("input", () => {
    player.stop();
    history.place = Number(at("scrub").value);
    show();
  });
  click("replay", replay);
  at("units").addEventListener("change", () => {
    listUnits();
    controls?.make(true);
    show();
  });
  if (recorded) return;
  click("undo", ask("undo"));
  click("redo", ask("redo"));
  click("reset", ask("reset"));
  for (const [id, file] of [["save-case", "case.toml"], ["save-recording", "recording.html"]]) click(id, () => save(file));
  for (const [id, name] of [["play-case", "playCase"], ["play-cycle", "playCycle"], ["play-turn", "playTurn"], ["play-two", "playTwo"]]) {
    click(id, () => { before(); player[name](); });
  }
  click("stop", () => { player.stop(); link.stop(); });
}

async function save(file) {
  try {
    const answer = await fetch(`save/${link.session}/${file}`);
    if (answer.ok) download(file, await answer.blob());
    else say((await answer.text()).trim(), history.pictures.length ? "unsaved" : "");
  } catch {
    say("The file can't be saved: the server does not answer.", "gone");
  }
}

function replay() {
  if (player.plays) player.stop();
  else if (life) player.playLife(life);
  else player.replay(show);
}

function keys(event) {
  const letter = event.key.toLowerCase(), control = event.ctrlKey || event.metaKey;
  if (event.target.matches(control ? "input.number" : "input, select")) return; // the browser's own keys
  if (control && letter === "z" && !recorded) at(event.shiftKey ? "redo" : "undo").click();
  else if (control && letter === "y" && !recorded) at("redo").click();
  else if (event.key === " " && !event.target.matches("button")) replay();
  else if (recorded && (event.key === "ArrowLeft" || event.key === "ArrowRight")) {
    const way = event.key === "ArrowRight" ? 1 : -1;
    if (life) life.move(way);
    else history.place = Math.max(0, Math.min(history.pictures.length - 1, history.place + way));
    show();
  } else return;
  event.preventDefault();
}

// The choices of units: prefixes by the size of a value, or one for each kind of unit.
function listUnits() {
  const { prefixes } = history.case, place = at("units"), names = Object.keys(prefixes);
  place.hidden = !names.length;
  if (place.options.length !== names.length + 1) place.replaceChildren(new Option("units by size", ""), ...names.map((name) => new Option(name, name)));
  fixPrefixes(prefixes[place.value] ?? {});
}

function legend() {
  const entries = [["load", "load on the pin"], ["pressure", "pressure (outwards)"], ["shear", "shear on the pin"], ["stick", "sticks"],
    ["positive", "slips counter-clockwise"], ["negative", "slips clockwise"], ["reference", "reference"]];
  for (const [name, words] of entries) {
    const item = document.createElement("li");
    item.className = name;
    item.textContent = words;
    at("legend").append(item);
  }
}

function playing() {
  at("stop").disabled = !player?.plays && at("connection").dataset.word !== "computing";
  at("replay").textContent = at("play-life").textContent = player?.plays ? "❚❚" : "▶";
}

legend();
if (recorded) {
  document.body.classList.add("replaying");
  at("help").textContent = "Space replays, arrow keys go step by step.";
  at("drawing").setAttribute("aria-label", "Pin in its hole");
  player = new Player(history, null, null, playing);
  news({ kind: "pictures", ...JSON.parse(recorded.textContent) });
} else {
  link = new Link(news, status);
  leader = new Leader(link);
  player = new Player(history, leader, link, playing);
  controls = new Controls(history, leader, before, say);
  new Pointer(drawing, history, leader, before);
}
listen();
document.addEventListener("keydown", keys);
window.fastpin = { history, drawing, charts, loops, map, joint, link, leader, player, times };
