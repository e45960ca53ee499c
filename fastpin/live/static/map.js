// The map of stick and slip: a column for each step, over the angles of its zones.

import { angleAxis, axis, chart, multiples } from "live/charts";
import { REFERENCE, ofStatus } from "live/colours";
import { Follower } from "live/window";

const STEPS = 400; // most columns

export class MapChart {
  constructor(history, charts) {
    Object.assign(this, { history, charts });
    this.follower = new Follower();
    this.columns = [];
    this.steps = [0, 1];
    this.chart = chart(document.getElementById("map-chart"), {
      scales: { x: { time: false, range: () => this.steps }, y: { range: () => charts.windowOf(this.follower) } },
      axes: [axis({ size: 24, space: 50, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500], splits: (_, __, ...range) => this.ticks(...range), values: (_, splits) => this.words(splits) }), angleAxis({ size: 48 })],
      cursor: { show: false },
      series: [{}, { show: false }],
      hooks: { drawClear: [(plot) => this.draw(plot)] },
    }, [[0, 1], [null, null]]);
  }

  // The places of the axis that have words: steps, or cycles of a life.
  ticks(low, high, step) {
    return this.history.life ? this.history.life.scale.ticks.map(({ place }) => place) : multiples(low, high, step);
  }

  words(splits) {
    return this.history.life ? this.history.life.scale.ticks.map(({ words }) => words) : splits.map(String);
  }

  // A column for each of the last steps, or for each cycle of a life until now.
  show() {
    const { pictures, place, life, cycle } = this.history, first = Math.max(0, place + 1 - STEPS);
    if (life) {
      this.columns = life.cycles.slice(0, cycle.number + 1).map((one, k) => ({ picture: one.pictures[place], ends: life.scale.ends(k) }));
      this.steps = [0, 1];
    } else {
      this.columns = pictures.slice(first, place + 1).map((picture, k) => ({ picture, ends: [first + k, first + k + 1] }));
      this.steps = [first, first + Math.max(this.columns.length, 10)];
    }
    this.follower.follow(this.columns.flatMap(({ picture }) => picture.contact));
    this.chart.setData([[...this.steps], [null, null]]);
  }

  draw(plot) {
    const { left, top, width, height } = plot.bbox, [first, last] = this.steps, pen = plot.ctx;
    const edge = (end) => left + Math.round((width * (end - first)) / (last - first));
    const areas = new Map(); // one for each colour: a path of many boxes is drawn at once
    for (const { picture, ends } of this.columns) {
      const [from, to] = ends.map(edge);
      for (const [start, stop, status] of picture.zones) {
        const colour = ofStatus(status);
        if (!areas.has(colour)) areas.set(colour, new Path2D());
        for (const turn of [-360, 0, 360]) {
          const high = plot.valToPos(stop + turn, "y", true), low = plot.valToPos(start + turn, "y", true);
          if (low > top && high < top + height) areas.get(colour).rect(from, high, to - from, low - high);
        }
      }
    }
    pen.save();
    pen.beginPath();
    pen.rect(left, top, width, height);
    pen.clip();
    for (const [colour, area] of areas) {
      pen.fillStyle = colour;
      pen.fill(area);
    }
    pen.restore();
    pen.strokeStyle = REFERENCE;
    pen.lineWidth = 1;
    pen.strokeRect(left, top, width, height);
  }
}
