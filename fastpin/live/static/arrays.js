// Arrays of the protocol: base64 of little-endian numbers.

function raw(text) {
  const letters = atob(text);
  const found = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) found[k] = letters.charCodeAt(k);
  return found;
}

export function floats(text) {
  return new Float32Array(raw(text).buffer);
}

export function statuses(text) {
  return new Int8Array(raw(text).buffer);
}
