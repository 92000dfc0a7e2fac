// A grey picture as a data URL of a bitmap with 256 greys. It needs no canvas, so it also works in Node when pages are built.

/** A picture in the core's form: rows from the top, four pixels a word. */
export interface Grey {
  width: number;
  height: number;
  grey: Uint32Array;
}

const HEAD = 14 + 40 + 4 * 256;

/** Caches the URLs, because an answer is rendered again on every change of the page. */
const urls = new WeakMap<Grey, string>();

/** The width must be a multiple of four. */
export function bitmap(picture: Grey): string {
  const old = urls.get(picture);
  if (old) return old;
  const text = encoded(picture);
  urls.set(picture, text);
  return text;
}

function encoded({ width, height, grey }: Grey): string {
  // The first pixel of a word is its lowest byte, which is also the first in memory.
  const pixels = new Uint8Array(grey.buffer, grey.byteOffset, width * height);
  const file = new Uint8Array(HEAD + pixels.length);
  const view = new DataView(file.buffer);
  // 14 bytes on the file, 40 on the picture (one plane of eight bits), then the palette.
  view.setUint16(0, 0x4d42, true);
  view.setUint32(2, file.length, true);
  view.setUint32(10, HEAD, true);
  view.setUint32(14, 40, true);
  view.setInt32(18, width, true);
  // A negative height means that rows start at the top.
  view.setInt32(22, -height, true);
  view.setUint16(26, 1, true);
  view.setUint16(28, 8, true);
  view.setUint32(46, 256, true);
  for (let k = 0; k < 256; k++) view.setUint32(54 + 4 * k, 0x010101 * k, true);
  file.set(pixels, HEAD);
  let text = "";
  // In pieces, because a call takes a limited number of arguments.
  for (let i = 0; i < file.length; i += 8192) text += String.fromCharCode(...file.subarray(i, i + 8192));
  return `data:image/bmp;base64,${btoa(text)}`;
}
