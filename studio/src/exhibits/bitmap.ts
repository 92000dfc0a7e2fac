// A picture of grey pixels as an address for an image: a bitmap of 256 greys. It needs no canvas, so the page that is
// written at build time has it, too.

/** What the core answers: rows from the top, four pixels a word. */
export interface Grey {
  width: number;
  height: number;
  grey: Uint32Array;
}

const HEAD = 14 + 40 + 4 * 256;

/** Of answers that are drawn again while one drags. */
const made = new WeakMap<Grey, string>();

/** The width is a multiple of four. */
export function bitmap(picture: Grey): string {
  const old = made.get(picture);
  if (old) return old;
  const text = encoded(picture);
  made.set(picture, text);
  return text;
}

function encoded({ width, height, grey }: Grey): string {
  const pixels = new Uint8Array(grey.buffer, grey.byteOffset, width * height);
  const file = new Uint8Array(HEAD + pixels.length);
  const view = new DataView(file.buffer);
  view.setUint16(0, 0x4d42, true);
  view.setUint32(2, file.length, true);
  view.setUint32(10, HEAD, true);
  view.setUint32(14, 40, true);
  view.setInt32(18, width, true);
  // A negative height says that rows begin at the top.
  view.setInt32(22, -height, true);
  view.setUint16(26, 1, true);
  view.setUint16(28, 8, true);
  view.setUint32(46, 256, true);
  for (let k = 0; k < 256; k++) view.setUint32(54 + 4 * k, 0x010101 * k, true);
  file.set(pixels, HEAD);
  let text = "";
  // A call takes so many arguments at once, and not the whole file.
  for (let i = 0; i < file.length; i += 8192) text += String.fromCharCode(...file.subarray(i, i + 8192));
  return `data:image/bmp;base64,${btoa(text)}`;
}
