// The map of stick and slip: a column for each step, a row for each place round the hole.

import { angleAxis, axis, chart } from "live/charts";
import { NEGATIVE, POSITIVE, PRESSURE, REFERENCE, STICK } from "live/colours";
import { OPEN, SLIDES, STEPS_OF_MAP } from "live/history";

export class MapChart {
  constructor(history) {
    this.history = history;
    this.image = document.createElement("canvas");
    this.colours = new Map([[0, STICK], [1, POSITIVE], [-1, NEGATIVE], [OPEN, "#ffffff"], [SLIDES, PRESSURE]].map(([status, colour]) => [status, packed(colour)]));
    this.steps = [0, 1];
    this.chart = chart(document.getElementById("map-chart"), {
      scales: { x: { time: false, range: () => this.steps }, y: { range: [-180, 180] } },
      axes: [axis({ size: 24, space: 50, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500], values: (_, splits) => splits.map(String) }), angleAxis({ size: 44, splits: () => [-180, -90, 0, 90, 180] })],
      cursor: { show: false },
      series: [{}, { show: false }],
      hooks: { drawClear: [(plot) => this.draw(plot)] },
    }, [[0, 1], [null, null]]);
  }

  show() {
    const { pictures, place } = this.history;
    const first = Math.max(0, place + 1 - STEPS_OF_MAP), count = Math.max(place + 1 - first, 0);
    this.count = count;
    this.steps = [first, first + Math.max(count, 10)];
    if (count) {
      const rows = pictures[first].column.length;
      this.image.width = count;
      this.image.height = rows;
      const pen = this.image.getContext("2d"), pixels = pen.createImageData(count, rows);
      const cells = new Uint32Array(pixels.data.buffer);
      for (let k = 0; k < count; k++) {
        const { column } = pictures[first + k];
        for (let row = 0; row < rows; row++) cells[row * count + k] = this.colours.get(column[row]);
      }
      pen.putImageData(pixels, 0, 0);
    }
    this.chart.setData([[...this.steps], [null, null]]);
  }

  draw(plot) {
    if (!this.count) return;
    const { left, top, width, height } = plot.bbox;
    const wide = (width * this.count) / (this.steps[1] - this.steps[0]);
    plot.ctx.imageSmoothingEnabled = false;
    plot.ctx.drawImage(this.image, left, top, wide, height);
    plot.ctx.strokeStyle = REFERENCE;
    plot.ctx.lineWidth = 1;
    plot.ctx.strokeRect(left, top, width, height);
  }
}

// A colour as a pixel: opaque, little-endian.
function packed(colour) {
  const value = parseInt(colour.slice(1), 16);
  return ((255 << 24) | ((value & 255) << 16) | (value & 0xff00) | (value >> 16)) >>> 0;
}
