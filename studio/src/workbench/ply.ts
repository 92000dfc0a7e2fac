// Writes triangles as a file for the command: binary PLY in single precision, as shown on the page.
import type { Part } from "./glb";

const INDICES_OF_A_FACE = 3;
const BYTES_OF_A_VERTEX = 12;
const BYTES_OF_A_FACE = 13;

export function plyOf(parts: readonly Part[]): Uint8Array {
  const vertices = parts.reduce((sum, { positions }) => sum + positions.length / 3, 0);
  const faces = parts.reduce((sum, { indices }) => sum + indices.length / 3, 0);
  const header = new TextEncoder().encode(
    [
      "ply",
      "format binary_little_endian 1.0",
      `element vertex ${vertices}`,
      ..."xyz".split("").map((axis) => `property float ${axis}`),
      `element face ${faces}`,
      "property list uchar uint vertex_indices",
      "end_header\n",
    ].join("\n"),
  );
  const bytes = new Uint8Array(header.length + vertices * BYTES_OF_A_VERTEX + faces * BYTES_OF_A_FACE);
  bytes.set(header);
  const view = new DataView(bytes.buffer);
  let at = header.length;
  for (const { positions } of parts) {
    for (const value of positions) {
      view.setFloat32(at, value, true);
      at += 4;
    }
  }
  let first = 0;
  for (const { positions, indices } of parts) {
    for (let i = 0; i < indices.length; i += 3) {
      view.setUint8(at, INDICES_OF_A_FACE);
      for (let k = 0; k < 3; k++) view.setUint32(at + 1 + 4 * k, first + indices[i + k]!, true);
      at += BYTES_OF_A_FACE;
    }
    first += positions.length / 3;
  }
  return bytes;
}
