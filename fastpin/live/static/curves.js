// Curves over the angle, in degrees: their parts, and several of them on the angles of all.

// The parts of the curves of a picture: arrays of the same length; the angles ascend. NaN stands between two parts.
export function partsOf(curves) {
  const names = Object.keys(curves), found = [];
  let start = 0;
  for (let k = 0; k <= curves.degrees.length; k++) {
    if (k < curves.degrees.length && !Number.isNaN(curves.degrees[k])) continue;
    if (k > start) found.push(Object.fromEntries(names.map((name) => [name, curves[name].subarray(start, k)])));
    start = k + 1;
  }
  return found;
}

// The value at an angle of a part of a curve, on the straight line between two points; null beyond its ends.
export function valueAt(part, name, angle) {
  const { degrees } = part;
  if (!(angle >= degrees[0] && angle <= degrees.at(-1))) return null;
  let low = 0, high = degrees.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (degrees[middle] <= angle) low = middle;
    else high = middle;
  }
  const share = (angle - degrees[low]) / (degrees[high] - degrees[low] || 1);
  return part[name][low] + share * (part[name][high] - part[name][low]);
}

// Curves of several pictures for a chart: the angles of all of them in a window, and a function that gives the values
// of one curve at these angles. Beyond a part, values are null, and every gap between two parts has an angle.
export function together(all, [low, high]) {
  const turned = all.map((parts) => inWindow(parts, low, high)), angles = new Set();
  for (const parts of turned) {
    parts.forEach(({ degrees, turn }, k) => {
      degrees.forEach((angle) => angles.add(angle + turn));
      const next = parts[k + 1];
      if (next) angles.add(0.5 * (degrees.at(-1) + turn + next.degrees[0] + next.turn));
    });
  }
  const x = Float64Array.from(angles).sort();
  const values = (number, name) => {
    const found = new Array(x.length).fill(null), parts = turned[number] ?? [];
    let k = 0;
    for (const part of parts) {
      const { degrees, turn } = part, last = degrees.length - 1, value = part[name];
      while (k < x.length && x[k] < degrees[0] + turn) k++;
      for (let j = 0; k < x.length && x[k] <= degrees[last] + turn; k++) {
        const angle = x[k] - turn;
        while (j < last - 1 && degrees[j + 1] <= angle) j++;
        const share = (angle - degrees[j]) / (degrees[j + 1] - degrees[j] || 1);
        found[k] = value[j] + share * (value[j + 1] - value[j]);
      }
    }
    return found;
  };
  return { x: Array.from(x), values };
}

// The parts that lie in a window, which may go beyond the top of the hole: each with its turn, in ascending order.
function inWindow(parts, low, high) {
  return [-360, 0, 360].flatMap((turn) => parts.map((part) => ({ ...part, turn })))
    .filter(({ degrees, turn }) => degrees[0] + turn < high && degrees.at(-1) + turn > low);
}
