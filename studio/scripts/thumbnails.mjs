// Small pictures of the examples: `import url from "….png?thumbnail"` is the address of the same picture at half its size.
// A PNG is decoded, averaged and encoded here, so that building the page needs no program for pictures.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { deflateSync, inflateSync } from "node:zlib";

const SUFFIX = "?thumbnail";
const SIGNATURE = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
/** The bytes of a pixel by the colour type of the PNG: RGB, RGBA. */
const CHANNELS = { 2: 3, 6: 4 };
const FACTOR = 2;

export function thumbnails() {
  return {
    name: "thumbnails",
    enforce: "pre",
    load(id) {
      if (!id.endsWith(SUFFIX)) return null;
      const path = id.slice(0, -SUFFIX.length);
      // Tests of the source need no picture, and have no bundle to put one into.
      if (this.meta.watchMode || process.env.VITEST) return 'export default "";';
      const source = halved(readFileSync(path));
      const reference = this.emitFile({ type: "asset", name: basename(path), source });
      return `export default import.meta.ROLLUP_FILE_URL_${reference};`;
    },
  };
}

/** The picture at half its size. */
export function halved(png) {
  const { width, height, channels, pixels } = decode(png);
  const [w, h] = [Math.floor(width / FACTOR), Math.floor(height / FACTOR)];
  const small = Buffer.alloc(w * h * channels);
  for (let y = 0; y < h; y += 1)
    for (let x = 0; x < w; x += 1)
      for (let c = 0; c < channels; c += 1) {
        let sum = 0;
        for (let dy = 0; dy < FACTOR; dy += 1)
          for (let dx = 0; dx < FACTOR; dx += 1) sum += pixels[((y * FACTOR + dy) * width + x * FACTOR + dx) * channels + c];
        small[(y * w + x) * channels + c] = Math.round(sum / FACTOR ** 2);
      }
  return encode({ width: w, height: h, channels, pixels: small });
}

function decode(png) {
  const data = [];
  let header;
  for (let at = SIGNATURE.length; at < png.length; ) {
    const length = png.readUInt32BE(at);
    const kind = png.toString("latin1", at + 4, at + 8);
    const body = png.subarray(at + 8, at + 8 + length);
    if (kind === "IHDR") header = body;
    if (kind === "IDAT") data.push(body);
    at += 12 + length;
  }
  const [width, height, depth, type, , , interlace] = [header.readUInt32BE(0), header.readUInt32BE(4), ...header.subarray(8)];
  const channels = CHANNELS[type];
  if (!channels || depth !== 8 || interlace) throw new Error("pictures of examples are PNG of 8 bits, RGB or RGBA");
  const raw = inflateSync(Buffer.concat(data));
  const stride = width * channels;
  const pixels = Buffer.alloc(stride * height);
  for (let y = 0; y < height; y += 1) {
    const filter = raw[y * (stride + 1)];
    for (let k = 0; k < stride; k += 1) {
      const left = k < channels ? 0 : pixels[y * stride + k - channels];
      const up = y ? pixels[(y - 1) * stride + k] : 0;
      const corner = y && k >= channels ? pixels[(y - 1) * stride + k - channels] : 0;
      const guess = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
      pixels[y * stride + k] = raw[y * (stride + 1) + 1 + k] + guess;
    }
  }
  return { width, height, channels, pixels };
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

function encode({ width, height, channels, pixels }) {
  const stride = width * channels;
  const raw = Buffer.alloc((stride + 1) * height);
  for (let y = 0; y < height; y += 1) {
    // The difference to the row above, which compresses shaded pictures well.
    raw[y * (stride + 1)] = 2;
    for (let k = 0; k < stride; k += 1) raw[y * (stride + 1) + 1 + k] = pixels[y * stride + k] - (y ? pixels[(y - 1) * stride + k] : 0);
  }
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, channels === 3 ? 2 : 6, 0, 0, 0], 8);
  return Buffer.concat([SIGNATURE, chunk("IHDR", header), chunk("IDAT", deflateSync(raw, { level: 9 })), chunk("IEND", Buffer.alloc(0))]);
}

function chunk(kind, body) {
  const named = Buffer.concat([Buffer.from(kind, "latin1"), body]);
  const frame = Buffer.alloc(8);
  frame.writeUInt32BE(body.length, 0);
  frame.writeUInt32BE(crc(named), 4);
  return Buffer.concat([frame.subarray(0, 4), named, frame.subarray(4)]);
}

function crc(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) {
    value ^= byte;
    for (let k = 0; k < 8; k += 1) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  }
  return (value ^ 0xffffffff) >>> 0;
}
