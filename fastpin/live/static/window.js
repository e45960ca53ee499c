// The part of the hole that charts show: the whole of it, a narrow contact, or a part that was marked with the mouse.

export const WHOLE = [-180, 180]; // the whole hole, degrees from the bottom
const NARROW = 90; // degrees of a contact below which charts show it larger
const ROOM = 1.5; // width of such a window, in widths of the contact
const LEAST = 0.5; // degrees of the narrowest window
const SMALL = 0.4; // a contact that fills less than this part of a window gets another one

// The window of narrow contacts. It stays where it is as long as they fit, so that axes do not flicker.
export class Follower {
  constructor() {
    this.window = WHOLE;
  }

  follow(intervals) {
    const found = around(intervals);
    if (!found || found[1] - found[0] > NARROW) this.window = WHOLE;
    else if (this.window === WHOLE || !fits(found, this.window)) {
      const middle = 0.5 * (found[0] + found[1]), half = 0.5 * Math.max(ROOM * (found[1] - found[0]), LEAST);
      this.window = [middle - half, middle + half];
    }
    return this.window;
  }
}

function fits([low, high], window) {
  const wide = window[1] - window[0];
  const turn = 360 * Math.round((0.5 * (window[0] + window[1]) - 0.5 * (low + high)) / 360);
  const inside = low + turn >= window[0] + 0.02 * wide && high + turn <= window[1] - 0.02 * wide;
  return inside && high - low > SMALL * (wide > LEAST ? wide : 0);
}

// The narrowest interval round intervals of degrees; null if there is none. Its middle is at most half a turn from 0.
export function around(intervals) {
  const sorted = intervals.map(([start, stop]) => {
    const turn = 360 * Math.floor((start + 180) / 360);
    return [start - turn, stop - turn];
  }).sort((one, other) => one[0] - other[0]);
  if (!sorted.length) return null;
  let widest = -1, found = null, reach = -Infinity;
  for (const [, stop] of sorted) reach = Math.max(reach, stop - 360); // what goes across the top reaches in from below
  let before = reach;
  for (const [start, stop] of sorted) {
    if (start - before > widest) [widest, found] = [start - before, start];
    before = Math.max(before, stop);
  }
  widest = Math.max(widest, 0);
  const low = found, high = found + 360 - widest, turn = 360 * Math.round(0.5 * (low + high) / 360);
  return [low - turn, high - turn];
}
