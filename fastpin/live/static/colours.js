// Colours of Okabe and Ito: distinct for all kinds of colour vision.

export const STICK = "#0072b2";
export const POSITIVE = "#e69f00";
export const NEGATIVE = "#cc79a7";
export const REFERENCE = "#8d959c";
export const INK = "#1d2730";
export const SOFT = "#5b6670";
export const WARNING = "#d55e00";
export const PRESSURE = "#7d93a5";

// The fill of a zone. Clockwise slip has stripes, so that the zones differ in grey too.
export function ofStatus(status) {
  if (status === -1) return (stripes ??= striped(NEGATIVE));
  return { 0: STICK, 1: POSITIVE }[status] ?? PRESSURE;
}

let stripes = null;

function striped(colour) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = 6;
  const pen = tile.getContext("2d");
  pen.fillStyle = colour;
  pen.fillRect(0, 0, 6, 6);
  pen.strokeStyle = "rgba(255,255,255,.75)";
  pen.lineWidth = 1.5;
  for (const shift of [-6, 0, 6]) {
    pen.moveTo(shift - 1, 7);
    pen.lineTo(shift + 7, -1);
  }
  pen.stroke();
  return pen.createPattern(tile, "repeat");
}
