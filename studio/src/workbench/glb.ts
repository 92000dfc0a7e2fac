// Reads the triangles of a GLB that the command wrote: uncompressed, one buffer. Of materials only colour and texture.
import type { DecodedPicture, Vec3 } from "../viewer";
import { fromLinear } from "../viewer/color";
import { isDrawing } from "./document";

/** The triangles of one node of the file. */
export interface Part {
  name: string;
  positions: Float32Array;
  indices: Uint32Array;
  normals?: Float32Array;
  /** Red, green, blue of each vertex, 0 to 1 in sRGB. */
  colors?: Float32Array;
  /** The paint's index of each triangle, and the paints. */
  groups: Uint32Array;
  paints: (string | undefined)[];
  /** The texture coordinates of each vertex, and the picture of each paint. */
  uv?: Float32Array;
  pictures?: (EncodedPicture | undefined)[];
  /** The decoded pictures, once a browser has read them. */
  decoded?: readonly (DecodedPicture | undefined)[];
}

/** A picture of the file, and its wrap modes. */
export interface EncodedPicture {
  bytes: Uint8Array;
  type: string;
  wrap: readonly [number, number];
}

interface Node {
  name?: string;
  mesh?: number;
  children?: number[];
  matrix?: number[];
  translation?: number[];
  rotation?: number[];
  scale?: number[];
  extensions?: { MSFT_lod?: { ids: number[] } };
}

interface Json {
  nodes?: Node[];
  scenes?: { nodes?: number[] }[];
  scene?: number;
  meshes?: { primitives: { attributes: Record<string, number>; indices?: number; material?: number; mode?: number }[] }[];
  materials?: { pbrMetallicRoughness?: { baseColorFactor?: number[]; baseColorTexture?: { index: number; texCoord?: number } } }[];
  textures?: { source?: number; sampler?: number; extensions?: { EXT_texture_webp?: { source: number } } }[];
  samplers?: { wrapS?: number; wrapT?: number }[];
  images?: { bufferView?: number; mimeType?: string }[];
  accessors?: { bufferView?: number; byteOffset?: number; componentType: number; count: number; type: string; normalized?: boolean }[];
  bufferViews?: { byteOffset?: number; byteLength: number; byteStride?: number }[];
}

const WIDTHS: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const TRIANGLES = 4;
const REPEAT = 10497;
/** Column-major, as in the file. */
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** The coordinate system of a shape, from its certificate. */
export interface Frame {
  up: string | null;
  metres_per_unit: number | null;
}

/** The axis of a file that is up: glTF's is y if the report names none. */
export const upOf = (name: string, { up }: Frame): string | null =>
  // A drawing lies on the ground, and is raised from there: so it is in the files that are written.
  isDrawing({ name }) ? null : (up ?? (/\.(glb|gltf)$/i.test(name) ? "y" : null));

/** The parts of the scene in the coordinates of the original shape, one for each node with triangles. */
export function parts(bytes: Uint8Array, frame: Frame): Part[] {
  const file = open(bytes);
  return placedNodes(file.json, frame).flatMap(({ node, above }) => partsOf(file, node, above));
}

/** Decodes the pictures of parts. A picture that the browser cannot decode is left out. */
export function withPictures(parts: readonly Part[]): Promise<Part[]> {
  const seen = new Map<number, Promise<ImageBitmap | undefined>>();
  const read = ({ bytes, type }: EncodedPicture) => {
    // The place in the file identifies a picture; parts that share one decode it once.
    const image = seen.get(bytes.byteOffset) ?? createImageBitmap(new Blob([bytes as BlobPart], { type })).catch(() => undefined);
    seen.set(bytes.byteOffset, image);
    return image;
  };
  const decode = async (picture: EncodedPicture | undefined): Promise<DecodedPicture | undefined> => {
    const image = picture && (await read(picture));
    return image && { image, wrap: picture.wrap };
  };
  return Promise.all(parts.map(async (part) => (part.pictures ? { ...part, decoded: await Promise.all(part.pictures.map(decode)) } : part)));
}

/** The levels of detail of a file by `chordal lod`, finest first: the parts of each level. */
export function levels(bytes: Uint8Array, frame: Frame): Part[][] {
  const file = open(bytes);
  const hosts = placedNodes(file.json, frame).map(({ node, above }) => ({
    above,
    nodes: [node, ...(node.extensions?.MSFT_lod?.ids ?? []).map((id) => file.json.nodes![id]!)],
  }));
  const count = Math.max(...hosts.map(({ nodes }) => nodes.length), 0);
  // A part with fewer levels stays at its coarsest.
  return Array.from({ length: count }, (_, level) =>
    hosts.flatMap(({ above, nodes }) => partsOf(file, nodes[Math.min(level, nodes.length - 1)]!, above)),
  );
}

/** The nodes of the scene with a mesh, and the transform of the nodes above them. */
function placedNodes(json: Json, frame: Frame): { node: Node; above: readonly number[] }[] {
  const placed: { node: Node; above: readonly number[] }[] = [];
  // At the root the command adds one node for the change to y up and one for the scale to metres. Their transforms are skipped.
  let turns = Number(frame.up === "z") + Number(frame.metres_per_unit !== null && frame.metres_per_unit !== 1);
  const visit = (number: number, above: readonly number[]) => {
    const node = json.nodes?.[number];
    if (!node) return;
    const isTurn = turns > 0;
    if (isTurn) turns -= 1;
    if (node.mesh !== undefined) placed.push({ node, above });
    const transform = isTurn ? above : times(above, matrixOf(node));
    node.children?.forEach((child) => visit(child, transform));
  };
  json.scenes?.[json.scene ?? 0]?.nodes?.forEach((node) => visit(node, IDENTITY));
  return placed;
}

interface Glb {
  json: Json;
  buffer: DataView;
}

function open(bytes: Uint8Array): Glb {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  // Byte 12 begins the chunk of JSON, and the binary one follows it:
  //
  //    0                      12            20       20 + length    28 + length
  //    magic, version, size | length, type | JSON … | length, type | bytes …
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) as Json;
  const from = 20 + length + 8;
  return { json, buffer: new DataView(bytes.buffer, bytes.byteOffset + Math.min(from, bytes.length), Math.max(bytes.length - from, 0)) };
}

function partsOf(file: Glb, node: Node, above: readonly number[]): Part[] {
  const { json } = file;
  const { mesh, name = "" } = node;
  if (mesh === undefined) return [];
  const transform = times(above, matrixOf(node));
  const primitives = (json.meshes?.[mesh]?.primitives ?? []).filter((one) => (one.mode ?? TRIANGLES) === TRIANGLES);
  // Primitives may share their vertices, which are then read once.
  const starts = new Map<number, number>();
  const shared: Attributes[] = [];
  let count = 0;
  const runs = primitives.flatMap(({ attributes, indices, material }) => {
    const position = attributes["POSITION"];
    if (position === undefined) return [];
    if (!starts.has(position)) {
      starts.set(position, count);
      shared.push(attributes);
      count += json.accessors![position]!.count;
    }
    const vertices = json.accessors![position]!.count;
    const rows = indices === undefined ? Uint32Array.from({ length: vertices }, (_, i) => i) : read(file, indices);
    return [{ rows, start: starts.get(position)!, material, attributes }];
  });
  const corners = runs.reduce((sum, { rows }) => sum + rows.length, 0);
  if (!corners) return [];
  const [indices, groups] = [new Uint32Array(corners), new Uint32Array(corners / 3)];
  let at = 0;
  // A transform that mirrors turns the front of every triangle to the back, unless two corners are exchanged.
  const isMirrored = determinant(transform) < 0;
  runs.forEach(({ rows, start }, run) => {
    groups.fill(run, at / 3, (at + rows.length) / 3);
    for (const row of rows) indices[at++] = start + row;
  });
  if (isMirrored) for (let i = 0; i < corners; i += 3) [indices[i + 1], indices[i + 2]] = [indices[i + 2]!, indices[i + 1]!];
  const gathered = (of: (attributes: Attributes) => number | undefined, width: number) => joined(file, shared.map(of), width);
  const part: Part = {
    name,
    positions: moved(gathered((from) => from["POSITION"], 3)!, transform),
    indices,
    groups,
    paints: runs.map(({ material }) => paintOf(json, material)),
  };
  const normals = gathered((from) => from["NORMAL"], 3);
  if (normals) part.normals = moved(normals, normalTransform(transform));
  const colors = gathered((from) => from["COLOR_0"], 3);
  if (colors) part.colors = colors.map(fromLinear);
  const pictures = runs.map(({ material }) => pictureOf(file, material));
  const first = pictures.find(Boolean);
  const uv = first && gathered((from) => from[`TEXCOORD_${first.texCoord}`], 2);
  if (uv) Object.assign(part, { uv, pictures: pictures.map((one) => one && { bytes: one.bytes, type: one.type, wrap: one.wrap }) });
  return [part];
}

type Attributes = Record<string, number>;

/** An attribute of all vertices; `undefined` if some lack it. */
function joined(file: Glb, accessors: readonly (number | undefined)[], width: number): Float32Array | undefined {
  const arrays = accessors.map((accessor) => (accessor === undefined ? undefined : read(file, accessor, width)));
  if (arrays.some((array) => !array)) return undefined;
  const values = new Float32Array(arrays.reduce((sum, array) => sum + array!.length, 0));
  let at = 0;
  for (const array of arrays) {
    values.set(array!, at);
    at += array!.length;
  }
  return values;
}

/** The numbers of an accessor, at most `width` per row. Normalized integers become numbers from 0, or -1, to 1. */
function read({ json, buffer }: Glb, accessor: number, width?: number): Float32Array | Uint32Array {
  const { bufferView, byteOffset = 0, componentType, count, type, normalized } = json.accessors![accessor]!;
  const components = WIDTHS[type] ?? 1;
  const kept = width ?? components;
  // Without a width these are indices, of which single precision would round those above 2^24.
  const values = width === undefined ? new Uint32Array(count * kept) : new Float32Array(count * kept);
  // An accessor without bytes is all zeros, as the format defines.
  if (bufferView === undefined) return values;
  const view = json.bufferViews![bufferView]!;
  const size = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 }[componentType] ?? 4;
  const isSigned = componentType === 5120 || componentType === 5122;
  const stride = view.byteStride ?? size * components;
  const first = (view.byteOffset ?? 0) + byteOffset;
  const largest = normalized ? 2 ** (8 * size - Number(isSigned)) - 1 : 1;
  const number =
    componentType === 5126
      ? (at: number) => buffer.getFloat32(at, true)
      : size === 4
        ? (at: number) => buffer.getUint32(at, true) / largest
        : size === 2
          ? (at: number) => (isSigned ? buffer.getInt16(at, true) : buffer.getUint16(at, true)) / largest
          : (at: number) => (isSigned ? buffer.getInt8(at) : buffer.getUint8(at)) / largest;
  for (let i = 0; i < count; i++) for (let k = 0; k < kept; k++) values[i * kept + k] = number(first + i * stride + k * size);
  return values;
}

/** The base colour texture of a material, if browsers can decode it. */
function pictureOf({ json, buffer }: Glb, material: number | undefined): (EncodedPicture & { texCoord: number }) | undefined {
  const reference = material === undefined ? undefined : json.materials?.[material]?.pbrMetallicRoughness?.baseColorTexture;
  const texture = reference && json.textures?.[reference.index];
  const source = texture?.extensions?.EXT_texture_webp?.source ?? texture?.source;
  const { bufferView, mimeType } = (source === undefined ? undefined : json.images?.[source]) ?? {};
  if (!reference || !texture || bufferView === undefined || !mimeType) return undefined;
  // A view, not a copy: its offset in the file identifies the picture.
  const { byteOffset = 0, byteLength } = json.bufferViews![bufferView]!;
  const bytes = new Uint8Array(buffer.buffer, buffer.byteOffset + byteOffset, byteLength);
  const { wrapS = REPEAT, wrapT = REPEAT } = json.samplers?.[texture.sampler ?? -1] ?? {};
  return { bytes, type: mimeType, wrap: [wrapS, wrapT], texCoord: reference.texCoord ?? 0 };
}

/** The base colour of a material, from linear to sRGB. */
function paintOf(json: Json, material: number | undefined): string | undefined {
  const pbr = material === undefined ? undefined : json.materials?.[material]?.pbrMetallicRoughness;
  if (!pbr?.baseColorFactor) return undefined;
  const shown = pbr.baseColorFactor.slice(0, 3).map((share) => Math.round(255 * fromLinear(share)));
  return `rgb(${shown.join(", ")})`;
}

function matrixOf(node: Node): readonly number[] {
  if (node.matrix) return node.matrix;
  const [x, y, z, w] = (node.rotation ?? [0, 0, 0, 1]) as [number, number, number, number];
  const [a, b, c] = (node.scale ?? [1, 1, 1]) as [number, number, number];
  const [tx, ty, tz] = (node.translation ?? [0, 0, 0]) as [number, number, number];
  return [
    a * (1 - 2 * (y * y + z * z)), a * 2 * (x * y + z * w), a * 2 * (x * z - y * w), 0,
    b * 2 * (x * y - z * w), b * (1 - 2 * (x * x + z * z)), b * 2 * (y * z + x * w), 0,
    c * 2 * (x * z + y * w), c * 2 * (y * z - x * w), c * (1 - 2 * (x * x + y * y)), 0,
    tx, ty, tz, 1,
  ]; // prettier-ignore
}

function times(a: readonly number[], b: readonly number[]): readonly number[] {
  if (a === IDENTITY) return b;
  return Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[(i % 4) + 4 * k]! * b[4 * (i >> 2) + k]!, 0));
}

/** The cofactors of the upper left 3 × 3 of a transform, column by column. */
function cofactors(m: readonly number[]): readonly number[] {
  const cofactor = (column: number, row: number) => {
    const [c, d, r, s] = [(column + 1) % 3, (column + 2) % 3, (row + 1) % 3, (row + 2) % 3];
    return m[4 * c + r]! * m[4 * d + s]! - m[4 * c + s]! * m[4 * d + r]!;
  };
  return Array.from({ length: 9 }, (_, i) => cofactor(Math.floor(i / 3), i % 3));
}

function determinant(m: readonly number[]): number {
  const minors = cofactors(m);
  return m[0]! * minors[0]! + m[1]! * minors[1]! + m[2]! * minors[2]!;
}

/** The transform of normals: the inverse transpose, which unequal scales need. Up to its length that is the cofactors by the sign. */
function normalTransform(m: readonly number[]): readonly number[] {
  const [minors, sign] = [cofactors(m), determinant(m) < 0 ? -1 : 1];
  const column = (i: number) => [...minors.slice(3 * i, 3 * i + 3).map((minor) => sign * minor), 0];
  return [...column(0), ...column(1), ...column(2), 0, 0, 0, 1];
}

function moved(rows: Float32Array, m: readonly number[]): Float32Array {
  if (m.every((value, i) => value === IDENTITY[i])) return rows;
  for (let i = 0; i < rows.length; i += 3) {
    const [x, y, z] = [rows[i]!, rows[i + 1]!, rows[i + 2]!];
    for (let k = 0; k < 3; k++) rows[i + k] = m[k]! * x + m[4 + k]! * y + m[8 + k]! * z + m[12 + k]!;
  }
  return rows;
}

/** Turns a point of a file with y up so that z is up; and back. */
export const toZUp = ([x, y, z]: Vec3, up: string | null): Vec3 => (up === "y" ? [x, -z, y] : [x, y, z]);
export const fromZUp = ([x, y, z]: Vec3, up: string | null): Vec3 => (up === "y" ? [x, z, -y] : [x, y, z]);

/** The same for a part. */
export const partToZUp = (part: Part, up: string | null): Part => (up === "y" ? turned(part, (at) => toZUp(at, up)) : part);
export const partFromZUp = (part: Part, up: string | null): Part => (up === "y" ? turned(part, (at) => fromZUp(at, up)) : part);

function turned(part: Part, turn: (at: Vec3) => Vec3): Part {
  const turnedRows = (rows: Float32Array) => {
    const result = new Float32Array(rows.length);
    for (let i = 0; i < rows.length; i += 3) result.set(turn([rows[i]!, rows[i + 1]!, rows[i + 2]!]), i);
    return result;
  };
  return { ...part, positions: turnedRows(part.positions), ...(part.normals && { normals: turnedRows(part.normals) }) };
}

/** The bounding box of all parts. */
export function boxOf(parts: readonly Part[]): readonly [Vec3, Vec3] | undefined {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { positions } of parts) {
    for (let i = 0; i < positions.length; i++) {
      const value = positions[i]!;
      if (value < low[i % 3]!) low[i % 3] = value;
      if (value > high[i % 3]!) high[i % 3] = value;
    }
  }
  return low[0]! <= high[0]! ? [low as unknown as Vec3, high as unknown as Vec3] : undefined;
}

/** The result of reading a file; `undefined` if this page cannot read it. */
export const readOrUndefined = <T>(read: () => Promise<T>): Promise<T | undefined> => Promise.resolve().then(read).catch(() => undefined);
