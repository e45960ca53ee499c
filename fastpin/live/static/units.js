// Numbers with units and SI prefixes, as the tables of fastpin print them. A unit has a name, and a factor that takes
// values of the server to it: with a thickness, forces are in N here and in N/m there. A unit that the case chooses has no
// prefix.

const PREFIXES = { 9: "G", 6: "M", 3: "k", 0: "", "-3": "m", "-6": "µ", "-9": "n", "-12": "p" };
const WITHOUT = new Set(["", "F", "F R", "F/R", "R", "F beta*", "F beta*/R", "R^2/beta*", "F^2 beta*", "F R beta*", "1/beta*", "deg"]);
const POWERS = { "m^2": [2, -2], "m^3": [3, -5] }; // the power of a unit, and the lowest decade of values in it

let prefixes = {}; // the exponents of the units that have a prefix of their own, by their names

// Give some units a prefix of their own: an exponent for each name.
export function fixPrefixes(exponents) {
  prefixes = exponents;
}

// A factor and a unit in which values up to `largest` read well.
export function scaled(largest, { name, factor, is_chosen: isChosen }) {
  if (isChosen || WITHOUT.has(name)) return withExponent(name, factor, 0);
  if (name in prefixes) return withExponent(name, factor, prefixes[name]);
  if (!(largest > 0) || !isFinite(largest)) return withExponent(name, factor, 0);
  const [power, lowest] = POWERS[name] ?? [1, 0];
  return withExponent(name, factor, Math.min(9, Math.max(-12, 3 * Math.floor((Math.log10(factor * largest * (1 + 1e-12)) - lowest) / (3 * power)))), power);
}

function withExponent(name, factor, exponent, power = 1) {
  return { factor: factor * 10 ** (-exponent * power), exponent, whole: factor, unit: PREFIXES[exponent] + shown(name) };
}

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

// A text as JavaScript reads a number: with a decimal point, and without blanks around it. A single comma is a decimal
// comma, in every language. The answer is null if the text is no number: "1,000.5" has two kinds of separators.
export function numberText(text) {
  const plain = text.trim().replace("−", "-").replace(",", text.includes(".") ? "," : ".");
  return NUMBER.test(plain) ? plain : null;
}

// The value that such a text means. 1 MPa is 1e6 Pa to the last digit, and 5 kN are 5000 N over the thickness.
export function inBaseUnit(text, { exponent, whole }) {
  return (/e/i.test(text) ? Number(text) * 10 ** exponent : Number(`${text}e${exponent}`)) / whole;
}

function shown(unit) {
  return unit.replace("beta*", "β*").replace("^2", "²").replace("^3", "³");
}

// A number with so many significant digits and without an exponent where that reads well.
export function digits(value, count = 4) {
  if (value === null || !isFinite(value)) return "–";
  if (value === 0) return "0";
  value = Number(value.toPrecision(count));
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(count - 1).replace("-", "−");
  return value.toFixed(Math.max(0, count - 1 - Math.floor(Math.log10(size)))).replace("-", "−");
}

export function withUnit(value, unit, count = 4) {
  if (value === null || !isFinite(value)) return "–";
  const scale = scaled(Math.abs(value), unit);
  return `${digits(value * scale.factor, count)} ${scale.unit}`.trim();
}

export function degrees(value, count = 1) {
  return value === null ? "–" : `${(Number(value.toFixed(count)) || 0).toFixed(count).replace("-", "−")}°`;
}
