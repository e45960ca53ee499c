// Files that the page gives: a picture of itself, and its loads when the server is gone.

export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Drawing and charts in one picture, as they stand on the page.
export function image(title) {
  const scale = window.devicePixelRatio || 1, parts = [];
  for (const canvas of document.querySelectorAll("#stage canvas, .chart canvas")) {
    const box = canvas.getBoundingClientRect();
    if (box.width) parts.push({ canvas, box });
  }
  const captions = Array.from(document.querySelectorAll("figcaption"), (caption) => ({ box: caption.getBoundingClientRect(), text: words(caption) }));
  const left = Math.min(...parts.map(({ box }) => box.left)) - 10, top = Math.min(...parts.map(({ box }) => box.top), ...captions.map(({ box }) => box.top)) - 30;
  const right = Math.max(...parts.map(({ box }) => box.right)) + 10, bottom = Math.max(...parts.map(({ box }) => box.bottom)) + 10;
  const whole = document.createElement("canvas");
  whole.width = (right - left) * scale;
  whole.height = (bottom - top) * scale;
  const pen = whole.getContext("2d");
  pen.scale(scale, scale);
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, right - left, bottom - top);
  for (const { canvas, box } of parts) pen.drawImage(canvas, box.left - left, box.top - top, box.width, box.height);
  pen.fillStyle = "#1d2730";
  pen.font = "12px system-ui, sans-serif";
  for (const { box, text } of captions) if (box.width) pen.fillText(text, box.left - left, box.top - top + 12);
  pen.font = "bold 13px system-ui, sans-serif";
  pen.fillText(title, 10, 18);
  return new Promise((done) => whole.toBlob(done, "image/png"));
}

function words(caption) {
  return Array.from(caption.childNodes, (node) => (node.tagName === "SELECT" ? node.selectedOptions[0]?.text ?? "" : node.textContent)).join("").trim();
}

// The loads of the history as CSV, which fastpin reads as a load history.
export function loadsText(history) {
  const names = history.case.loads.map((load) => load.name);
  const lines = history.pictures.map((picture) => names.map((name) => picture.load[name]).join(","));
  return [names.join(","), ...lines, ""].join("\n");
}
