// A life of wear: the slider that moves through the stored cycles, and a chart of its numbers over the cycles.

import { axis, brief, chart, multiples, valueAxis } from "live/charts";
import { INK, WARNING } from "live/colours";
import { count } from "live/cycles";
import { scaled } from "live/units";

const WIDE = 100; // ratio of the values beyond which their axis is logarithmic
const WAYS = { ArrowLeft: -1, ArrowDown: -1, PageDown: -10, ArrowRight: 1, ArrowUp: 1, PageUp: 10, Home: -Infinity, End: Infinity };

export class LifeSlider {
  constructor(history, player, show) {
    Object.assign(this, { history, player, show });
    this.range = document.getElementById("cycles");
    this.words = document.getElementById("cycle");
    this.range.addEventListener("input", () => { player.stop(); this.choose(history.life.scale.nearest(Number(this.range.value))); });
    this.range.addEventListener("keydown", (event) => {
      if (!(event.key in WAYS)) return;
      event.preventDefault();
      this.move(WAYS[event.key]);
    });
    this.range.disabled = history.life.cycles.length < 2;
    this.marks(history.life.scale);
    this.numbers = new LifeChart(history);
  }

  // Small lines at the stored cycles, and the words of the axis.
  marks({ places, ticks }) {
    const mark = (place, words) => {
      const made = document.createElement("span");
      made.style.left = `calc(8px + ${place} * (100% - 16px))`; // a thumb of 16 pixels stays inside the slider
      made.textContent = words;
      return made;
    };
    document.getElementById("decades").replaceChildren(...places.map((place) => mark(place, "")), ...ticks.map(({ place, words }) => mark(place, words)));
  }

  choose(number) {
    this.history.choose(number);
    this.show();
  }

  // Go on by so many stored cycles.
  move(way) {
    this.player.stop();
    const last = this.history.life.cycles.length - 1;
    this.choose(Math.max(0, Math.min(last, this.history.cycle.number + way)));
  }

  draw() {
    const { life, cycle } = this.history, words = `${count(cycle.cycle)} ${cycle.cycle === 1 ? "cycle" : "cycles"}`;
    this.range.value = life.scale.places[cycle.number];
    this.range.setAttribute("aria-valuetext", words);
    const part = life.stored > life.cycles.length ? `; ${life.cycles.length} of ${count(life.stored)} stored cycles are here` : "";
    this.words.textContent = `after ${words}`;
    this.words.title = `stored cycle ${cycle.number + 1} of ${life.cycles.length}${part}`;
    this.numbers.show();
  }
}

class LifeChart {
  constructor(history) {
    this.history = history;
    this.select = document.getElementById("over-quantity");
    this.select.replaceChildren(...history.life.quantities.map(({ name }, k) => new Option(name, k)));
    this.select.addEventListener("change", () => this.show());
    this.limits = [0, 1];
    this.isWide = false; // whether the axis of the values is logarithmic
    const { ticks } = history.life.scale, points = { show: true, size: 4, fill: INK };
    this.chart = chart(document.getElementById("over-chart"), {
      scales: { x: { time: false, range: () => [-0.02, 1.02] }, y: { range: () => this.limits } },
      axes: [
        axis({ size: 24, splits: () => ticks.map(({ place }) => place), values: () => ticks.map(({ words }) => words) }),
        valueAxis({
          splits: (_, __, low, high, step) => (this.isWide ? powers(low, high) : multiples(low, high, step)),
          values: (_, splits) => splits.map((value) => brief(this.isWide ? 10 ** value : value)),
        }),
      ],
      cursor: { show: false },
      series: [{}, { stroke: INK, width: 1.5, points }, { stroke: WARNING, points: { show: true, size: 9, fill: WARNING } }],
    }, [history.life.scale.places, ...[0, 1].map(() => history.life.cycles.map(() => null))]);
  }

  show() {
    const { life, cycle, case: given } = this.history, { kind, values } = life.quantities[this.select.value];
    const positive = values.filter((value) => value > 0), most = Math.max(...positive, 0);
    this.isWide = positive.length > 1 && most > WIDE * Math.min(...positive);
    const { factor, unit } = scaled(most, given.units[kind]);
    const shown = values.map((value) => (this.isWide ? (value > 0 ? Math.log10(factor * value) : null) : factor * value));
    const ends = shown.filter((value) => value !== null), low = this.isWide ? Math.min(...ends) : 0, high = Math.max(...ends);
    const room = 0.07 * (high - low) || 1;
    this.limits = [this.isWide ? low - room : 0, high + room];
    this.chart.setData([life.scale.places, shown, shown.map((value, k) => (k === cycle.number ? value : null))]);
    document.getElementById("over-unit").textContent = unit ? `[${unit}]` : "";
  }
}

// The exponents of powers of ten between two exponents; not more than five or so.
function powers(low, high) {
  return multiples(low, high, Math.max(1, Math.ceil((high - low) / 5)));
}
