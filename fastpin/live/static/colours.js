// Colours of Okabe and Ito: distinct for all kinds of colour vision.

export const STICK = "#0072b2";
export const POSITIVE = "#e69f00";
export const NEGATIVE = "#cc79a7";
export const REFERENCE = "#8d959c";
export const INK = "#1d2730";
export const SOFT = "#5b6670";
export const WARNING = "#d55e00";
export const PRESSURE = "#7d93a5";

export function ofStatus(status) {
  return { 0: STICK, 1: POSITIVE, "-1": NEGATIVE }[status] ?? PRESSURE;
}
