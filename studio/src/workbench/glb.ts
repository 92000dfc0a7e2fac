// Reads the triangles of a GLB that the command has written: no compression, one buffer. Materials become plain colours.
import type { Vec3 } from "../viewer";

/** What one node of the file shows. */
export interface Part {
  name: string;
  positions: Float32Array;
  indices: Uint32Array;
  normals?: Float32Array;
  /** For each triangle the index of its paint, and the paints. */
  groups: Uint32Array;
  paints: (string | undefined)[];
}

interface Json {
  nodes?: { name?: string; mesh?: number; children?: number[]; matrix?: number[]; translation?: number[]; rotation?: number[]; scale?: number[] }[];
  scenes?: { nodes?: number[] }[];
  scene?: number;
  meshes?: { primitives: { attributes: Record<string, number>; indices?: number; material?: number; mode?: number }[] }[];
  materials?: { pbrMetallicRoughness?: { baseColorFactor?: number[]; baseColorTexture?: unknown } }[];
  accessors?: { bufferView?: number; byteOffset?: number; componentType: number; count: number; type: string; normalized?: boolean }[];
  bufferViews?: { byteOffset?: number; byteLength: number; byteStride?: number }[];
}

const WIDTHS: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const TRIANGLES = 4;
/** Column by column, as the file has them. */
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** The parts of the scene, one for each node with triangles. */
export function parts(bytes: Uint8Array): Part[] {
  const { json, buffer } = open(bytes);
  const found: Part[] = [];
  const visit = (node: number, above: readonly number[]) => {
    const at = json.nodes?.[node];
    if (!at) return;
    const placed = times(above, matrixOf(at));
    if (at.mesh !== undefined) found.push(...partOf(json, buffer, at.mesh, at.name ?? "", placed));
    at.children?.forEach((child) => visit(child, placed));
  };
  json.scenes?.[json.scene ?? 0]?.nodes?.forEach((node) => visit(node, IDENTITY));
  return found;
}

/** The levels of detail of a file that `chordal lod` has written, finest first: the parts of each. */
export function levels(bytes: Uint8Array): Part[][] {
  const { json, buffer } = open(bytes);
  const all: Part[][] = [];
  json.nodes?.forEach((node) => {
    if (node.mesh === undefined) return;
    const level = Number(/ level (\d+)$/.exec(node.name ?? "")?.[1] ?? 0);
    (all[level] ??= []).push(...partOf(json, buffer, node.mesh, node.name ?? "", matrixOf(node)));
  });
  return all.filter(Boolean);
}

function open(bytes: Uint8Array): { json: Json; buffer: DataView } {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) as Json;
  const from = 20 + length + 8;
  return { json, buffer: new DataView(bytes.buffer, bytes.byteOffset + Math.min(from, bytes.length), Math.max(bytes.length - from, 0)) };
}

function partOf(json: Json, buffer: DataView, mesh: number, name: string, placed: readonly number[]): Part[] {
  const primitives = (json.meshes?.[mesh]?.primitives ?? []).filter((one) => (one.mode ?? TRIANGLES) === TRIANGLES);
  const starts = new Map<number, number>();
  const [positions, normals, indices, groups]: [number[], number[], number[], number[]] = [[], [], [], []];
  const paints: (string | undefined)[] = [];
  for (const one of primitives) {
    const position = one.attributes["POSITION"];
    if (position === undefined) continue;
    // Primitives may share their vertices.
    let start = starts.get(position);
    if (start === undefined) {
      start = positions.length / 3;
      starts.set(position, start);
      push(positions, read(json, buffer, position));
      const normal = one.attributes["NORMAL"];
      if (normal !== undefined) push(normals, read(json, buffer, normal));
    }
    const rows = one.indices === undefined ? undefined : read(json, buffer, one.indices);
    const count = rows?.length ?? positions.length / 3 - start;
    for (let i = 0; i < count; i++) indices.push(start + (rows?.[i] ?? i));
    for (let i = 0; i < Math.floor(count / 3); i++) groups.push(paints.length);
    paints.push(paintOf(json, one.material));
  }
  if (!indices.length) return [];
  const part: Part = {
    name,
    positions: moved(Float32Array.from(positions), placed, 1),
    indices: Uint32Array.from(indices),
    groups: Uint32Array.from(groups),
    paints,
  };
  if (normals.length === positions.length) part.normals = moved(Float32Array.from(normals), placed, 0);
  return [part];
}

function push(to: number[], from: ArrayLike<number>): void {
  for (let i = 0; i < from.length; i++) to.push(from[i]!);
}

function read(json: Json, buffer: DataView, accessor: number): ArrayLike<number> {
  const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors![accessor]!;
  const width = WIDTHS[type] ?? 1;
  if (bufferView === undefined) return new Float32Array(count * width);
  const view = json.bufferViews![bufferView]!;
  const size = { 5121: 1, 5123: 2, 5125: 4, 5126: 4 }[componentType] ?? 4;
  const stride = view.byteStride ?? size * width;
  const out = new Float64Array(count * width);
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < width; k++) {
      const at = (view.byteOffset ?? 0) + byteOffset + i * stride + k * size;
      out[i * width + k] =
        componentType === 5126
          ? buffer.getFloat32(at, true)
          : size === 4
            ? buffer.getUint32(at, true)
            : size === 2
              ? buffer.getUint16(at, true)
              : buffer.getUint8(at);
    }
  }
  return out;
}

/** The material's colour, from linear light to what a screen has. */
function paintOf(json: Json, material: number | undefined): string | undefined {
  const pbr = material === undefined ? undefined : json.materials?.[material]?.pbrMetallicRoughness;
  if (!pbr?.baseColorFactor || pbr.baseColorTexture) return undefined;
  const shown = pbr.baseColorFactor.slice(0, 3).map((c) => Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055)));
  return `rgb(${shown.join(", ")})`;
}

function matrixOf(node: NonNullable<Json["nodes"]>[number]): readonly number[] {
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

function moved(rows: Float32Array, m: readonly number[], w: 0 | 1): Float32Array {
  if (m.every((value, i) => value === IDENTITY[i])) return rows;
  for (let i = 0; i < rows.length; i += 3) {
    const [x, y, z] = [rows[i]!, rows[i + 1]!, rows[i + 2]!];
    for (let k = 0; k < 3; k++) rows[i + k] = m[k]! * x + m[4 + k]! * y + m[8 + k]! * z + w * m[12 + k]!;
  }
  return rows;
}

/** With z up, where the file has y up. */
export function standing(part: Part, up: string | null): Part {
  if (up !== "y" && up !== "+y") return part;
  const turn = (rows: Float32Array) => {
    const out = new Float32Array(rows.length);
    for (let i = 0; i < rows.length; i += 3) out.set([rows[i]!, -rows[i + 2]!, rows[i + 1]!], i);
    return out;
  };
  return { ...part, positions: turn(part.positions), ...(part.normals && { normals: turn(part.normals) }) };
}

/** The same for a point. */
export const stood = ([x, y, z]: Vec3, up: string | null): Vec3 => (up === "y" || up === "+y" ? [x, -z, y] : [x, y, z]);

/** The box of all. */
export function boxOf(all: readonly Part[]): readonly [Vec3, Vec3] | undefined {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { positions } of all) {
    for (let i = 0; i < positions.length; i++) {
      const value = positions[i]!;
      if (value < low[i % 3]!) low[i % 3] = value;
      if (value > high[i % 3]!) high[i % 3] = value;
    }
  }
  return low[0]! <= high[0]! ? [low as unknown as Vec3, high as unknown as Vec3] : undefined;
}
