// Files that the page gives: a picture of itself, and its loads when the server is gone.

import { INK, ofStatus } from "live/colours";

export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Drawing, charts, legend and numbers in one picture, as they stand on the page.
export function image(title) {
  const scale = window.devicePixelRatio || 1, all = (place) => Array.from(document.querySelectorAll(place)).filter((one) => one.getBoundingClientRect().width);
  const boxes = all("#left, .chart").map((one) => one.getBoundingClientRect());
  const captions = all("figcaption");
  const left = Math.min(...boxes.map((box) => box.left)) - 10, top = Math.min(...boxes.map((box) => box.top), ...captions.map((one) => one.getBoundingClientRect().top)) - 30;
  const right = Math.max(...boxes.map((box) => box.right)) + 10, bottom = Math.max(...boxes.map((box) => box.bottom)) + 10;
  const whole = document.createElement("canvas");
  whole.width = (right - left) * scale;
  whole.height = (bottom - top) * scale;
  const pen = whole.getContext("2d");
  pen.scale(scale, scale);
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, right - left, bottom - top);
  pen.translate(-left, -top);
  for (const canvas of all("#stage canvas, .chart canvas")) {
    const box = canvas.getBoundingClientRect();
    pen.drawImage(canvas, box.left, box.top, box.width, box.height);
  }
  for (const item of all("#legend li")) {
    const box = item.getBoundingClientRect();
    pen.fillStyle = item.className === "negative" ? ofStatus(-1) : getComputedStyle(item, "::before").backgroundColor;
    pen.fillRect(box.left, box.top + box.height / 2 - 4, 14, 8);
  }
  pen.fillStyle = INK;
  for (const one of all("#legend li, #lesson, #numbers td, figcaption > *, figcaption")) write(pen, one);
  pen.font = "bold 13px system-ui, sans-serif";
  pen.textBaseline = "alphabetic";
  pen.fillText(title, left + 10, top + 18);
  return new Promise((done) => whole.toBlob(done, "image/png"));
}

// Write the own text of an element where its lines stand on the page. A box that is not checked has no text.
function write(pen, element) {
  if (element.querySelector("input:not(:checked)") && element.tagName === "LABEL") return;
  pen.font = getComputedStyle(element).font;
  pen.textBaseline = "middle";
  if (element.tagName === "SELECT") {
    const box = element.getBoundingClientRect();
    pen.fillText(element.selectedOptions[0]?.text ?? "", box.left + 4, box.top + box.height / 2);
    return;
  }
  for (const node of element.childNodes) if (node.nodeType === Node.TEXT_NODE) writeLines(pen, node);
}

// Write the words of a text, each where it stands.
function writeLines(pen, node) {
  const range = document.createRange();
  for (const { index, 0: word } of node.textContent.matchAll(/\S+/g)) {
    range.setStart(node, index);
    range.setEnd(node, index + word.length);
    const box = range.getBoundingClientRect();
    pen.fillText(word, box.left, box.top + box.height / 2);
  }
}

// The loads of the history as CSV, which fastpin reads as a load history: with a thickness in N, as in its case file.
export function loadsText(history) {
  const { loads } = history.given;
  const lines = history.pictures.map((picture) => loads.map(({ name, unit }) => unit.factor * picture.acting[name]).join(","));
  return [loads.map(({ name }) => name).join(","), ...lines, ""].join("\n");
}
