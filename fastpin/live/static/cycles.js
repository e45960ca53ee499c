// The axis of cycles: logarithmic from the first stored cycle on. The cycle 0 stands at its left end.

const START = 0.08; // place of the first stored cycle after 0, where later ones follow
const HIGH = "⁰¹²³⁴⁵⁶⁷⁸⁹";

export class CycleScale {
  constructor(cycles) {
    this.cycles = cycles;
    this.first = cycles.find((cycle) => cycle > 0) ?? 1;
    this.decades = Math.log10(cycles.at(-1) / this.first);
    this.places = cycles.map((cycle) => this.place(cycle));
  }

  // The place of a cycle on the axis, from 0 to 1.
  place(cycle) {
    if (cycle === 0) return 0;
    return this.decades > 0 ? START + ((1 - START) * Math.log10(cycle / this.first)) / this.decades : 1;
  }

  // The number of the stored cycle that is nearest to a place.
  nearest(place) {
    return this.places.reduce((best, one, k) => (Math.abs(one - place) < Math.abs(this.places[best] - place) ? k : best), 0);
  }

  // The part of the axis that belongs to a stored cycle.
  ends(number) {
    const middle = (k) => 0.5 * (this.places[k] + this.places[k + 1]);
    return [number > 0 ? middle(number - 1) : 0, number < this.places.length - 1 ? middle(number) : 1];
  }

  // The places of the axis that have words: 0 and powers of ten, or the first and the last stored cycle.
  get ticks() {
    const last = this.cycles.at(-1), powers = [];
    for (let k = Math.ceil(Math.log10(this.first)); 10 ** k <= last; k++) powers.push([10 ** k, k < 3 ? count(10 ** k) : `10${power(k)}`]);
    const few = [...new Set([this.first, last])].filter((cycle) => cycle > 0 && this.cycles.includes(cycle)).map((cycle) => [cycle, count(cycle)]);
    const marks = [...(this.cycles[0] === 0 ? [[0, "0"]] : []), ...(powers.length > 1 ? powers : few)];
    return marks.map(([cycle, words]) => ({ place: this.place(cycle), words }));
  }
}

// A number of cycles with commas, as tables have it.
export function count(cycles) {
  return cycles.toLocaleString("en");
}

function power(exponent) {
  return Array.from(String(exponent), (digit) => HIGH[digit]).join("");
}
